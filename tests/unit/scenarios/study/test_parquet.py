"""Tables of results: their columns, their order, and that they hold the runs of the ledger and no others."""

import json
import math
import random
from collections.abc import Callable, Iterable
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from kswarms.agents.common.columns import TABLES
from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.runs.outcome import Failure, Outcome
from kswarms.scenarios.runs.run import Run, expand
from kswarms.scenarios.study import parquet as tables
from kswarms.scenarios.study.database import LEDGER_FILE
from kswarms.scenarios.study.ledger import Ledger
from kswarms.scenarios.study.parquet import arrow_schema, export, pack

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


def write(
    directory: Path, runs: Iterable[Run], outcome: Callable[[Run], Outcome | Failure] | None = None
) -> list[Path]:
    """Enter what came out of runs into the directory's ledger, and export it."""
    with Ledger(directory / LEDGER_FILE, new=True) as ledger:
        ledger.plan({}, {}, list(runs))
        for run in runs:
            result = (outcome or outcome_of)(run)
            ledger.add(run, result, 0.1, pack(result.records) if isinstance(result, Outcome) else {})
        return export(ledger, directory)


def rows(directory: Path, name: str = "runs") -> list[dict[str, object]]:
    return pq.read_table(directory / f"{name}.parquet").to_pylist()


def test_runs_have_the_columns_of_the_contract(tmp_path: Path) -> None:
    (path,) = write(tmp_path, runs_of("fig-6.1c", seeds=1, densities=(6,)))
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
    write(tmp_path, runs_of("fig-6.2", "fig-6.3", seeds=1, densities=(6,)))
    assert [(row["scenario"], row["swarm"]) for row in rows(tmp_path)] == [
        ("fig-6.2", 1),
        ("fig-6.2", 2),
        ("fig-6.3", 1),
        ("fig-6.3", 2),
    ]
    assert len({row["run"] for row in rows(tmp_path)}) == 1


def test_policies_have_the_columns_of_the_contract(tmp_path: Path) -> None:
    paths = write(tmp_path, runs_of("fig-7.10", seeds=1, densities=(6,)))
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
    write(tmp_path, runs_of("fig-6.4b", "fig-6.10a", seeds=1, densities=(6,)))
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
    assert write(tmp_path, runs_of("fig-6.1c")) == [tmp_path / "runs.parquet"]


def test_the_bytes_do_not_depend_on_the_order_in_which_runs_end(tmp_path: Path) -> None:
    runs = runs_of("fig-6.1c", "fig-7.10", "fig-6.15")
    written = set()
    for turn in range(4):
        directory = tmp_path / str(turn)
        directory.mkdir()
        random.Random(turn).shuffle(runs)
        written.add(tuple(path.read_bytes() for path in write(directory, runs, with_robots)))
    assert len(written) == 1
    columns = ("scenario", "condition", "n", "seed", "swarm")
    points = [tuple(row[column] for column in columns) for row in rows(tmp_path / "0")]
    assert points == sorted(points)


def test_later_runs_join_the_earlier_ones_as_if_written_together(tmp_path: Path) -> None:
    earlier, later = runs_of("fig-6.3", "fig-6.4a"), runs_of("fig-6.1c", "fig-6.10b")
    (tmp_path / "two").mkdir()
    (tmp_path / "one").mkdir()
    write(tmp_path / "two", earlier)
    write(tmp_path / "two", later)
    write(tmp_path / "two", later)
    write(tmp_path / "one", earlier + later)
    for name in ("runs.parquet", "policies.parquet"):
        assert (tmp_path / "two" / name).read_bytes() == (tmp_path / "one" / name).read_bytes()


def test_large_tables_are_written_a_group_at_a_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    runs = runs_of("fig-6.1c")
    (whole,) = write(tmp_path, runs)
    before = rows(tmp_path)
    monkeypatch.setattr(tables, "_POINTS_PER_PART", 2)
    monkeypatch.setattr(tables, "_ROWS_PER_GROUP", 5)
    write(tmp_path, runs)
    assert pq.ParquetFile(whole).num_row_groups == 2
    assert rows(tmp_path) == before


def test_runs_that_failed_or_are_missing_have_no_rows(tmp_path: Path) -> None:
    runs = runs_of("fig-6.1c", densities=(6,))
    fails = runs[1].digest
    write(tmp_path, runs, lambda run: Failure("it broke") if run.digest == fails else outcome_of(run))
    assert [row["seed"] for row in rows(tmp_path)] == [0, 0, 2, 2]
    (tmp_path / "none").mkdir()
    assert write(tmp_path / "none", runs, lambda _: Failure("it broke")) == []


def test_a_result_that_lacks_a_column_is_reported_as_damage(tmp_path: Path) -> None:
    (run,) = runs_of("fig-6.4b", seeds=1, densities=(6,))
    for table, column in (("swarms", "ended"), ("policies", "share")):
        outcome = outcome_of(run)
        del getattr(outcome, table)[0][column]
        (tmp_path / table).mkdir()
        with pytest.raises(OSError, match=rf"ledger.sqlite: is damaged \(KeyError\('{column}'"):
            write(tmp_path / table, [run], lambda _, outcome=outcome: outcome)


def with_robots(run: Run, **columns: list[object]) -> Outcome:
    outcome = outcome_of(run)
    whole = {"robot": [0, 1], "swarm": [1, 2], "policy": ["avoid", "attack"], "pucks": [3, 4]}
    whole |= {"t_a": [1.0, 2.0], "t_p": [5.0, 6.0], "arms": [[], [ARM, ARM | {"action": "fight"}]]}
    outcome.records["robots"] = whole | columns
    return outcome


def test_records_are_written_once_for_a_shared_run_and_sorted_by_run(tmp_path: Path) -> None:
    runs = runs_of("fig-6.2", "fig-6.3")
    paths = write(tmp_path, runs, with_robots)
    assert [path.name for path in paths] == ["runs.parquet", "robots.parquet"]
    robots = pq.read_table(tmp_path / "robots.parquet").to_pylist()
    assert [(row["run"], row["robot"]) for row in robots] == [
        (name, robot) for name in sorted(run.digest for run in runs) for robot in (0, 1)
    ]


def test_robots_are_written_with_what_they_learned(tmp_path: Path) -> None:
    runs = runs_of("fig-6.1c", densities=(6,))
    write(tmp_path, runs[:2], with_robots)
    untried = ARM | {"count": 0.0, "q": float("nan")}
    write(tmp_path, runs[2:], lambda run: with_robots(run, arms=[[untried], []]))
    arms = {(row["run"], row["robot"]): row["arms"] for row in rows(tmp_path, "robots")}
    assert len(arms) == 6
    assert arms[runs[0].digest, 0] == []
    assert arms[runs[1].digest, 1] == [ARM, ARM | {"action": "fight"}]
    (arm,) = arms[runs[2].digest, 0]
    assert math.isnan(arm["q"])


def test_a_run_played_again_keeps_what_was_recorded_of_it(tmp_path: Path) -> None:
    first, second = runs_of("fig-6.1c", densities=(6,), seeds=2)
    write(tmp_path, [first, second], with_robots)
    write(tmp_path, [first])
    write(tmp_path, [second], lambda run: with_robots(run, pucks=[8, 9]))
    told = {(row["run"], row["pucks"]) for row in rows(tmp_path, "robots")}
    assert told == {(first.digest, 3), (first.digest, 4), (second.digest, 8), (second.digest, 9)}


def test_a_game_without_a_conflict_gives_a_table_without_rows(tmp_path: Path) -> None:
    (run,) = runs_of("fig-6.1c", seeds=1, densities=(6,))
    outcome = outcome_of(run)
    outcome.records["conflicts"] = {
        name: [] for name in arrow_schema(TABLES["conflicts"]).names if name != "run"
    }
    write(tmp_path, [run], lambda _: outcome)
    assert pq.read_table(tmp_path / "conflicts.parquet").schema.equals(arrow_schema(TABLES["conflicts"]))


def test_fields_of_a_grid_are_columns_typed_by_their_values(tmp_path: Path) -> None:
    def curve(*point: tuple[str, object]) -> str:
        return json.dumps({"condition": {"grid_point": point}})

    curves = {
        ("fig-6.1c", ""): curve(("side", 2), ("duration", 5.0), ("layout", "symmetric")),
        ("fig-6.2", ""): curve(("side", 2.5), ("duration", 6.0), ("actions", True), ("layout", False)),
        ("fig-6.1a", ""): json.dumps({"condition": {}}),  # as of version 0.1.0
    }
    runs = runs_of("fig-6.1c", "fig-6.2", "fig-6.1a", seeds=1, densities=(6,))
    with Ledger(tmp_path / LEDGER_FILE, new=True) as ledger:
        ledger.plan({}, curves, runs)
        for run in runs:
            ledger.add(run, outcome_of(run), 0.1)
        export(ledger, tmp_path)
    schema = pq.read_schema(tmp_path / "runs.parquet")
    assert schema.names[3:10] == ["n", "seed", "side", "grid.duration", "layout", "actions", "swarm"]
    assert [str(schema.field(name).type) for name in schema.names[5:9]] == [
        "double",
        "double",
        "string",
        "bool",
    ]
    columns = ("scenario", "side", "grid.duration", "layout", "actions", "duration")
    assert [tuple(row[column] for column in columns) for row in rows(tmp_path) if row["swarm"] == 1] == [
        ("fig-6.1a", None, None, None, None, 600.0),
        ("fig-6.1c", 2.0, 5.0, "symmetric", None, 600.0),
        ("fig-6.2", 2.5, 6.0, "False", True, 600.0),
    ]
