"""Tables of results: their columns, what is kept of earlier ones, and that they are whole or absent."""

import math
import random
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from agents.errors import InputError
from scenarios import tables
from scenarios.catalogue import CATALOGUE
from scenarios.runner import RECORDS, Outcome
from scenarios.runs import Run, expand
from scenarios.tables import prepare, tabulate, write

ARM = {"opponent": 1, "action": "flight", "reward": 2.5, "time": 10.0, "count": 4.0, "q": 0.25}


def runs_of(*names: str, densities: tuple[int, ...] = (6, 10), seeds: int = 3) -> list[Run]:
    return expand([CATALOGUE[name].replace(densities=densities, seeds=seeds) for name in names])


def outcome_of(run: Run, pucks: int = 5) -> Outcome:
    def row(number: int, size: int, policy: str) -> dict[str, object]:
        return {
            "swarm": number,
            "size": size,
            "policy": policy,
            "pucks": pucks + number,
            "sud": 3 - 2 * number,
            "t_a_intra": 0.5 * run.seed,
            "t_a_inter": 1.0,
            "t_p": 10.0,
            "conflicts_intra": 1,
            "conflicts_inter": 2,
            "duration": 600.0,
            "ended": "time",
        }

    swarms = [row(k, swarm.size, swarm.policy) for k, swarm in enumerate(run.game.swarms, 1)]
    return Outcome(swarms, policies_of(run), {})


def policies_of(run: Run, attack: float = 0.25) -> list[dict[str, object]]:
    """Return what a learning swarm learned of every other; actions not in alphabetical order."""
    return [
        {
            "swarm": number,
            "opponent": opponent,
            "action": action,
            "share": share,
            "attack_share": attack,
        }
        for number, swarm in enumerate(run.game.swarms, 1)
        if "learner" in swarm.policy
        for opponent in range(1, len(run.game.swarms) + 1)
        if opponent != number
        for action, share in (("flight", 1 - attack), ("fight", attack))
    ]


def parts_of(runs: list[Run], **rest: int) -> list[dict[str, pa.Table]]:
    return [tabulate(run, outcome_of(run, **rest)) for run in runs]


def rows(directory: Path, name: str = "runs") -> list[dict[str, object]]:
    return pq.read_table(directory / f"{name}.parquet").to_pylist()


def test_runs_have_the_columns_of_the_contract(tmp_path: Path) -> None:
    (path,) = write(tmp_path, parts_of(runs_of("fig-6.1c", seeds=1, densities=(6,))))
    assert path == tmp_path / "runs.parquet"
    schema = pq.read_schema(path)
    assert [(field.name, str(field.type)) for field in schema] == [
        ("run", "string"),
        ("scenario", "string"),
        ("condition", "string"),
        ("n", "int64"),
        ("seed", "int64"),
        ("swarm", "int64"),
        ("size", "int64"),
        ("policy", "string"),
        ("pucks", "int64"),
        ("sud", "int64"),
        ("t_a_intra", "double"),
        ("t_a_inter", "double"),
        ("t_p", "double"),
        ("conflicts_intra", "int64"),
        ("conflicts_inter", "int64"),
        ("duration", "double"),
        ("ended", "string"),
    ]
    first, second = rows(tmp_path)
    assert (first["scenario"], first["condition"], first["n"], first["seed"]) == ("fig-6.1c", "", 6, 0)
    assert (first["swarm"], first["policy"], first["pucks"], first["sud"]) == (1, "avoid", 6, 1)
    assert (second["swarm"], second["policy"], second["pucks"], second["sud"]) == (2, "attack", 7, -1)
    assert first["run"] == second["run"]


def test_a_shared_run_has_its_rows_under_every_id(tmp_path: Path) -> None:
    write(tmp_path, parts_of(runs_of("fig-6.2", "fig-6.3", seeds=1, densities=(6,))))
    assert [(row["scenario"], row["swarm"]) for row in rows(tmp_path)] == [
        ("fig-6.2", 1),
        ("fig-6.2", 2),
        ("fig-6.3", 1),
        ("fig-6.3", 2),
    ]
    assert len({row["run"] for row in rows(tmp_path)}) == 1


def test_policies_have_the_columns_of_the_contract(tmp_path: Path) -> None:
    paths = write(tmp_path, parts_of(runs_of("fig-7.10", seeds=1, densities=(6,))))
    assert [path.name for path in paths] == ["runs.parquet", "policies.parquet"]
    schema = pq.read_schema(paths[1])
    assert [(field.name, str(field.type)) for field in schema] == [
        ("run", "string"),
        ("scenario", "string"),
        ("condition", "string"),
        ("n", "int64"),
        ("seed", "int64"),
        ("swarm", "int64"),
        ("opponent", "int64"),
        ("action", "string"),
        ("share", "double"),
        ("attack_share", "double"),
    ]
    of_one = [row for row in rows(tmp_path, "policies") if row["condition"] == "delta=0.02"]
    assert [(row["swarm"], row["opponent"], row["action"], row["share"]) for row in of_one] == [
        (2, 1, "flight", 0.75),
        (2, 1, "fight", 0.25),
        (2, 3, "flight", 0.75),
        (2, 3, "fight", 0.25),
    ]
    assert {row["attack_share"] for row in of_one} == {0.25}
    (run,) = {row["run"] for row in of_one}
    assert run in {row["run"] for row in rows(tmp_path) if row["condition"] == "delta=0.02"}


def test_a_shared_run_has_its_policies_under_every_id(tmp_path: Path) -> None:
    write(tmp_path, parts_of(runs_of("fig-6.4b", "fig-6.10a", seeds=1, densities=(6,))))
    labels = [(row["scenario"], row["condition"], row["action"]) for row in rows(tmp_path, "policies")]
    assert labels == [
        ("fig-6.10a", "individual", "flight"),
        ("fig-6.10a", "individual", "fight"),
        ("fig-6.10a", "wlu", "flight"),
        ("fig-6.10a", "wlu", "fight"),
        ("fig-6.4b", "", "flight"),
        ("fig-6.4b", "", "fight"),
    ]


def test_without_a_learner_there_are_no_policies(tmp_path: Path) -> None:
    assert write(tmp_path, parts_of(runs_of("fig-6.1c"))) == [tmp_path / "runs.parquet"]


def test_policies_keep_to_the_runs_that_the_directory_has(tmp_path: Path) -> None:
    first, second, third = runs_of("fig-6.4b", densities=(6,))
    write(tmp_path, parts_of([first, second]))
    write(tmp_path, parts_of([third, *runs_of("fig-6.1c", densities=(6,))]))
    assert [row["seed"] for row in rows(tmp_path, "policies")] == [0, 0, 1, 1, 2, 2]
    # As another version of the package would name the same point, with another result.
    other = Run("f" * 16, second.game, second.seed, second.labels)
    outcome = outcome_of(other)
    outcome.policies[:] = policies_of(other, attack=0.5)
    write(tmp_path, [tabulate(other, outcome)])
    told = {(row["run"], row["seed"], row["attack_share"]) for row in rows(tmp_path, "policies")}
    assert told == {(first.digest, 0, 0.25), ("f" * 16, 1, 0.5), (third.digest, 2, 0.25)}
    outcome.policies.clear()  # and without learning
    write(tmp_path, [tabulate(other, outcome)])
    assert {row["seed"] for row in rows(tmp_path, "policies")} == {0, 2}
    (tmp_path / "runs.parquet").unlink()
    write(tmp_path, parts_of([third]))
    assert {row["seed"] for row in rows(tmp_path, "policies")} == {2}


def test_a_result_that_lacks_a_column_of_its_policies_is_an_error() -> None:
    (run,) = runs_of("fig-6.4b", seeds=1, densities=(6,))
    outcome = outcome_of(run)
    del outcome.policies[0]["share"]
    with pytest.raises(KeyError):
        tabulate(run, outcome)


def test_the_bytes_do_not_depend_on_the_order_in_which_runs_end(tmp_path: Path) -> None:
    parts = parts_of(runs_of("fig-6.1c", "fig-7.10", "fig-6.15"))
    written = set()
    for turn in range(4):
        directory = tmp_path / str(turn)
        directory.mkdir()
        random.Random(turn).shuffle(parts)
        written.add(tuple(path.read_bytes() for path in write(directory, parts)))
    assert len(written) == 1
    columns = ("scenario", "condition", "n", "seed", "swarm")
    points = [tuple(row[column] for column in columns) for row in rows(tmp_path / "0")]
    assert points == sorted(points)


def test_later_runs_join_the_earlier_ones_as_if_written_together(tmp_path: Path) -> None:
    earlier, later = parts_of(runs_of("fig-6.3", "fig-6.4a")), parts_of(runs_of("fig-6.1c", "fig-6.10b"))
    (tmp_path / "two").mkdir()
    (tmp_path / "one").mkdir()
    write(tmp_path / "two", earlier)
    write(tmp_path / "two", later)
    write(tmp_path / "two", later)
    write(tmp_path / "one", earlier + later)
    for name in ("runs.parquet", "policies.parquet"):
        assert (tmp_path / "two" / name).read_bytes() == (tmp_path / "one" / name).read_bytes()


def test_a_point_of_a_curve_played_anew_replaces_the_earlier_run(tmp_path: Path) -> None:
    runs = runs_of("fig-6.1c")
    write(tmp_path, parts_of(runs))
    # As another version of the package would name the same point.
    other = [Run("f" * 16, run.game, run.seed, run.labels) for run in runs if (run.n, run.seed) == (10, 1)]
    write(tmp_path, parts_of(other, pucks=40))
    after = rows(tmp_path)
    assert len(after) == 2 * len(runs)
    assert [row["pucks"] for row in after if (row["n"], row["seed"]) == (10, 1)] == [41, 42]
    kept = {run.digest for run in runs if (run.n, run.seed) != (10, 1)}
    assert {row["run"] for row in after} == kept | {"f" * 16}


def test_a_result_that_lacks_a_column_is_an_error() -> None:
    (run,) = runs_of("fig-6.1c", seeds=1, densities=(6,))
    outcome = outcome_of(run)
    del outcome.swarms[0]["ended"]
    with pytest.raises(KeyError):
        tabulate(run, outcome)


@pytest.mark.parametrize("failing", ["write_table", "replace"])
def test_a_failure_while_writing_leaves_everything_as_it_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, failing: str
) -> None:
    write(tmp_path, parts_of(runs_of("fig-6.1c")))
    before = (tmp_path / "runs.parquet").read_bytes()

    def fail(*arguments: object) -> None:
        if failing == "write_table":
            Path(str(arguments[1])).write_bytes(b"PAR1 half a tab")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(tables.pq if failing == "write_table" else Path, failing, fail)
    with pytest.raises(OSError, match="No space left"):
        write(tmp_path, parts_of(runs_of("fig-6.1a")))
    assert [path.name for path in tmp_path.iterdir()] == ["runs.parquet"]
    assert (tmp_path / "runs.parquet").read_bytes() == before


def test_the_first_tables_are_absent_if_writing_them_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_arguments: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(tables.pq, "write_table", fail)
    with pytest.raises(OSError, match="No space left"):
        write(tmp_path, parts_of(runs_of("fig-6.1a")))
    assert list(tmp_path.iterdir()) == []


def test_the_directory_is_made_and_left_empty(tmp_path: Path) -> None:
    prepare(tmp_path / "a" / "b")
    assert list((tmp_path / "a" / "b").iterdir()) == []
    prepare(tmp_path / "a" / "b")


def test_a_directory_with_tables_of_ours_is_accepted(tmp_path: Path) -> None:
    write(tmp_path, parts_of(runs_of("fig-6.1c")))
    prepare(tmp_path)


def test_what_cannot_hold_tables_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine")
    for place in (tmp_path / "file", tmp_path / "file" / "below", Path("/proc")):
        with pytest.raises(InputError, match=r"^out='.*must be a writable directory") as refusal:
            prepare(place)
        assert "\n" not in str(refusal.value)
    assert (tmp_path / "file").read_text() == "mine"


@pytest.mark.parametrize("foreign", ["text", "parquet"])
def test_a_file_of_someone_else_is_not_replaced(tmp_path: Path, foreign: str) -> None:
    path = tmp_path / "runs.parquet"
    if foreign == "text":
        path.write_text("my jogging diary")
    else:
        pq.write_table(pa.table({"km": [5, 7]}), path)
    before = path.read_bytes()
    with pytest.raises(InputError, match=r"holds a runs.parquet that is no table of kswarms"):
        prepare(tmp_path)
    assert path.read_bytes() == before


def recorded(run: Run, **columns: list[object]) -> dict[str, pa.Table]:
    outcome = outcome_of(run)
    whole = {"robot": [0, 1], "swarm": [1, 2], "policy": ["avoid", "attack"], "pucks": [3, 4]}
    whole |= {"t_a": [1.0, 2.0], "t_p": [5.0, 6.0], "arms": [[], [ARM, ARM | {"action": "fight"}]]}
    outcome.records["robots"] = whole | columns
    return tabulate(run, outcome)


def test_every_table_has_a_name_that_can_be_asked_for() -> None:
    assert tuple(tables.SCHEMAS) == ("runs", "policies", *RECORDS)
    assert all(schema.names[0] == "run" for schema in tables.SCHEMAS.values())


def test_records_are_written_once_for_a_shared_run_and_sorted_by_run(tmp_path: Path) -> None:
    runs = runs_of("fig-6.2", "fig-6.3")
    paths = write(tmp_path, [recorded(run) for run in runs])
    assert [path.name for path in paths] == ["runs.parquet", "robots.parquet"]
    robots = pq.read_table(tmp_path / "robots.parquet").to_pylist()
    assert [(row["run"], row["robot"]) for row in robots] == [
        (name, robot) for name in sorted(run.digest for run in runs) for robot in (0, 1)
    ]


def test_robots_are_written_with_what_they_learned(tmp_path: Path) -> None:
    runs = runs_of("fig-6.1c", densities=(6,))
    write(tmp_path, [recorded(run) for run in runs[:2]])
    prepare(tmp_path)  # knows the nested columns of its own
    write(tmp_path, [recorded(runs[2], arms=[[ARM | {"count": 0.0, "q": float("nan")}], []])])
    arms = {(row["run"], row["robot"]): row["arms"] for row in rows(tmp_path, "robots")}
    assert len(arms) == 6
    assert arms[runs[0].digest, 0] == []
    assert arms[runs[1].digest, 1] == [ARM, ARM | {"action": "fight"}]
    (arm,) = arms[runs[2].digest, 0]
    assert math.isnan(arm["q"])


def test_records_keep_to_the_runs_that_the_directory_has(tmp_path: Path) -> None:
    first, second, third = runs_of("fig-6.1c", densities=(6,))
    write(tmp_path, [recorded(run) for run in (first, second)])
    write(tmp_path, [recorded(second, pucks=[8, 9])])  # again, recorded
    write(tmp_path, parts_of([first, third]))  # again, and a new one: neither recorded
    other = Run("f" * 16, second.game, second.seed, second.labels)
    robots = pq.read_table(tmp_path / "robots.parquet").to_pylist()
    assert {(row["run"], row["pucks"]) for row in robots} == {
        (first.digest, 3),
        (first.digest, 4),
        (second.digest, 8),
        (second.digest, 9),
    }
    write(tmp_path, parts_of([other]))  # in place of the second
    robots = pq.read_table(tmp_path / "robots.parquet").to_pylist()
    assert {row["run"] for row in robots} == {first.digest}


def test_a_game_without_a_conflict_gives_a_table_without_rows(tmp_path: Path) -> None:
    (run,) = runs_of("fig-6.1c", seeds=1, densities=(6,))
    outcome = outcome_of(run)
    outcome.records["conflicts"] = {name: [] for name in tables.CONFLICTS.names if name != "run"}
    write(tmp_path, [tabulate(run, outcome)])
    assert pq.read_table(tmp_path / "conflicts.parquet").schema.equals(tables.CONFLICTS)


def test_a_failure_at_the_second_table_leaves_the_first_as_it_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, second, _ = runs_of("fig-6.1c", densities=(6,))
    write(tmp_path, [recorded(first)])
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    real, calls = tables.pq.write_table, []

    def fail_later(*arguments: object) -> None:
        calls.append(arguments)
        if len(calls) == 2:
            raise OSError(28, "No space left on device")
        real(*arguments)

    monkeypatch.setattr(tables.pq, "write_table", fail_later)
    with pytest.raises(OSError, match="No space left"):
        write(tmp_path, [recorded(second)])
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before
