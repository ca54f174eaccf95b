"""Tables of a study: their columns, their order and their rows."""

import json
import math
import random
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest

from kswarms.agents.common.columns import SCHEMA_VERSION, TABLES, column_names
from kswarms.agents.common.tables import arrow_schema
from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.runs.outcome import Failure, Outcome
from kswarms.scenarios.runs.run import Run, expand
from kswarms.scenarios.study import parquet
from kswarms.scenarios.study.database import LEDGER_FILE
from kswarms.scenarios.study.ledger import Curve, Ledger
from kswarms.scenarios.study.parquet import export, pack

ARM = {"opponent": 1, "action": "flight", "reward": 2.5, "time": 10.0, "count": 4.0, "q": 0.25}
VALUES: dict[str, Any] = {"integer": 1, "real": 0.5, "text": "x"}
KINDS = {column.name: column.kind for table in TABLES.values() for column in table}


def make_runs(*scenarios: str, densities: tuple[int, ...] = (6, 10), seeds: int = 3) -> list[Run]:
    return expand([CATALOGUE[name].replace(densities=densities, seeds=seeds) for name in scenarios])


def make_row(table: str, **values: object) -> dict[str, object]:
    """Return a row without the columns of its point: the given values, and one for each other column."""
    return {name: VALUES[KINDS[name]] for name in column_names(table)[5:]} | values


def make_outcome(run: Run) -> Outcome:
    """Return a synthetic outcome. Each learner learned about S1; actions are not in alphabetical order."""
    swarms = [
        make_row("runs", swarm=k, policy=swarm.policy, pucks=5 + k)
        for k, swarm in enumerate(run.game.swarms, 1)
    ]
    policies = [
        make_row("policies", swarm=k, opponent=1, action=action, share=share)
        for k, swarm in enumerate(run.game.swarms, 1)
        if "learner" in swarm.policy
        for action, share in (("flight", 0.75), ("fight", 0.25))
    ]
    return Outcome(swarms, policies, {})


def with_robots(run: Run, **columns: list[object]) -> Outcome:
    outcome = make_outcome(run)
    robots = {"robot": [0, 1], "swarm": [1, 2], "policy": ["avoid", "attack"], "pucks": [3, 4]}
    robots |= {"t_a": [1.0, 2.0], "t_p": [5.0, 6.0], "arms": [[], [ARM, ARM | {"action": "fight"}]]}
    outcome.records["robots"] = robots | columns
    return outcome


def write(
    directory: Path,
    runs: Iterable[Run],
    result: Callable[[Run], Outcome | Failure] = make_outcome,
    curves: dict[Curve, str] | None = None,
) -> list[str]:
    """Store results in the ledger of a directory and export it; return the names of the files."""
    directory.mkdir(exist_ok=True)
    with Ledger(directory / LEDGER_FILE, create=True) as ledger:
        ledger.plan({}, curves or {}, list(runs))
        for run in runs:
            added = result(run)
            ledger.add(run, added, 0.1, pack(added.records) if isinstance(added, Outcome) else {})
        return [path.name for path in export(ledger, directory)]


def read(directory: Path, *columns: str, table: str = "runs") -> list[tuple[Any, ...]]:
    rows = pq.read_table(directory / f"{table}.parquet").to_pylist()
    return [tuple(row[column] for column in columns) for row in rows]


def test_tables_have_the_columns_of_the_schema_and_its_version(tmp_path: Path) -> None:
    assert write(tmp_path, make_runs("fig-7.10"), with_robots) == [
        f"{table}.parquet" for table in ("runs", "policies", "robots")
    ]
    for table in ("runs", "policies", "robots"):
        schema = pq.read_schema(tmp_path / f"{table}.parquet")
        assert schema.equals(arrow_schema(TABLES[table]))
        assert schema.metadata[b"kswarms_schema"] == str(SCHEMA_VERSION).encode()
    types = {"integer": "int64", "real": "double", "text": "string"}
    assert [str(arrow_schema(TABLES["runs"]).field(name).type) for name in column_names("runs")] == [
        types[column.kind] for column in TABLES["runs"]
    ]


def test_a_shared_run_has_rows_under_each_of_its_curves(tmp_path: Path) -> None:
    write(tmp_path, make_runs("fig-6.4b", "fig-6.10a", seeds=1, densities=(6,)))
    labels = ("scenario", "condition")
    curves = [("fig-6.10a", "individual"), ("fig-6.10a", "wlu"), ("fig-6.4b", "")]
    assert read(tmp_path, *labels, "swarm") == [(*curve, swarm) for curve in curves for swarm in (1, 2)]
    assert read(tmp_path, *labels, "action", table="policies") == [
        (*curve, action) for curve in curves for action in ("flight", "fight")
    ]
    assert len({run for run, scenario, curve in read(tmp_path, "run", *labels) if curve != "individual"}) == 1


def test_policies_are_written_only_if_a_swarm_learns(tmp_path: Path) -> None:
    assert write(tmp_path, make_runs("fig-6.1c")) == ["runs.parquet"]


@pytest.mark.parametrize(("rows", "column"), [("swarms", "ended"), ("policies", "share")])
def test_a_result_without_a_column_is_reported_as_damage(rows: str, column: str, tmp_path: Path) -> None:
    (run,) = make_runs("fig-6.4b", seeds=1, densities=(6,))
    outcome = make_outcome(run)
    del getattr(outcome, rows)[0][column]
    with pytest.raises(OSError, match=rf"ledger.sqlite: is damaged \(KeyError\('{column}'"):
        write(tmp_path, [run], lambda _: outcome)


def test_the_bytes_do_not_depend_on_the_order_in_which_runs_end(tmp_path: Path) -> None:
    runs = make_runs("fig-6.1c", "fig-7.10", "fig-6.15")
    written = set()
    for turn in range(4):
        directory = tmp_path / str(turn)
        random.Random(turn).shuffle(runs)
        files = write(directory, runs, with_robots)
        written.add(tuple((directory / file).read_bytes() for file in files))
    assert len(written) == 1
    points = read(tmp_path / "0", "scenario", "condition", "n", "seed", "swarm")
    assert points == sorted(points)


def test_runs_added_later_give_the_same_files(tmp_path: Path) -> None:
    earlier, later = make_runs("fig-6.3", "fig-6.4a"), make_runs("fig-6.1c", "fig-6.10b")
    for runs in (earlier, later, later):
        write(tmp_path / "two", runs)
    for name in write(tmp_path / "one", earlier + later):
        assert (tmp_path / "two" / name).read_bytes() == (tmp_path / "one" / name).read_bytes()


def test_large_tables_are_written_in_row_groups(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    runs = make_runs("fig-6.1c")
    write(tmp_path / "one", runs)
    monkeypatch.setattr(parquet, "_POINTS_PER_PART", 2)
    monkeypatch.setattr(parquet, "_ROWS_PER_GROUP", 5)
    write(tmp_path / "two", runs)
    assert pq.ParquetFile(tmp_path / "two/runs.parquet").num_row_groups == 2
    assert pq.read_table(tmp_path / "two/runs.parquet").equals(pq.read_table(tmp_path / "one/runs.parquet"))


def test_failed_and_missing_runs_have_no_rows(tmp_path: Path) -> None:
    runs = make_runs("fig-6.1c", densities=(6,))
    write(tmp_path, runs, lambda run: Failure("it broke") if run.seed == 1 else make_outcome(run))
    assert read(tmp_path, "seed") == [(0,), (0,), (2,), (2,)]
    assert write(tmp_path / "none", runs, lambda _: Failure("it broke")) == []


def test_records_of_a_shared_run_are_written_once_and_sorted_by_run(tmp_path: Path) -> None:
    runs = make_runs("fig-6.2", "fig-6.3")
    write(tmp_path, runs, with_robots)
    assert read(tmp_path, "run", "robot", table="robots") == [
        (name, robot) for name in sorted(run.digest for run in runs) for robot in (0, 1)
    ]


def test_learned_arms_are_written(tmp_path: Path) -> None:
    (run,) = make_runs("fig-6.1c", densities=(6,), seeds=1)
    write(tmp_path, [run], lambda run: with_robots(run, arms=[[], [ARM, ARM | {"q": math.nan}]]))
    (nothing,), ((arm, untried),) = read(tmp_path, "arms", table="robots")
    assert (nothing, arm) == ([], ARM)
    assert math.isnan(untried["q"])


def test_a_replay_replaces_records_but_does_not_remove_them(tmp_path: Path) -> None:
    first, second = make_runs("fig-6.1c", densities=(6,), seeds=2)
    write(tmp_path, [first, second], with_robots)
    write(tmp_path, [first])
    write(tmp_path, [second], lambda run: with_robots(run, pucks=[8, 9]))
    assert set(read(tmp_path, "run", "pucks", table="robots")) == {
        *((first.digest, pucks) for pucks in (3, 4)),
        *((second.digest, pucks) for pucks in (8, 9)),
    }


def test_a_game_without_conflicts_gives_an_empty_table(tmp_path: Path) -> None:
    (run,) = make_runs("fig-6.1c", seeds=1, densities=(6,))
    outcome = make_outcome(run)
    outcome.records["conflicts"] = {name: [] for name in column_names("conflicts")[1:]}
    write(tmp_path, [run], lambda _: outcome)
    assert pq.read_table(tmp_path / "conflicts.parquet").equals(
        arrow_schema(TABLES["conflicts"]).empty_table()
    )


def test_fields_of_a_grid_are_columns_typed_by_their_values(tmp_path: Path) -> None:
    def curve(*point: tuple[str, object]) -> str:
        return json.dumps({"condition": {"grid_point": point}})

    curves = {
        ("fig-6.1c", ""): curve(("side", 2), ("duration", 5.0), ("layout", "symmetric")),
        ("fig-6.2", ""): curve(("side", 2.5), ("duration", 6.0), ("preempt", True), ("layout", False)),
        ("fig-6.1a", ""): json.dumps({"condition": {}}),  # a curve of version 0.1.0
    }
    write(tmp_path, make_runs("fig-6.1c", "fig-6.2", "fig-6.1a", seeds=1, densities=(6,)), curves=curves)
    schema = pq.read_schema(tmp_path / "runs.parquet")
    columns = ("side", "grid.duration", "layout", "preempt")
    assert schema.names[3:10] == ["n", "seed", *columns, "swarm"]
    assert [str(schema.field(name).type) for name in columns] == ["double", "double", "string", "bool"]
    assert read(tmp_path, *columns, "duration")[::2] == [
        (None, None, None, None, 0.5),
        (2.0, 5.0, "symmetric", None, 0.5),
        (2.5, 6.0, "False", True, 0.5),
    ]
