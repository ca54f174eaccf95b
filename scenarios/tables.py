"""The tables of results: Parquet files by the contract of section 3.5, written whole or not at all."""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory, TemporaryFile
from typing import Final

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from agents.errors import InputError
from scenarios.runner import Outcome
from scenarios.runs import Run

_TEXT, _WHOLE, _REAL, _YES_NO = pa.string(), pa.int64(), pa.float64(), pa.bool_()

RUNS: Final = pa.schema(
    {
        "run": _TEXT,
        "scenario": _TEXT,
        "condition": _TEXT,
        "n": _WHOLE,
        "seed": _WHOLE,
        "swarm": _WHOLE,
        "size": _WHOLE,
        "policy": _TEXT,
        "pucks": _WHOLE,
        "sud": _WHOLE,
        "t_a_intra": _REAL,
        "t_a_inter": _REAL,
        "t_p": _REAL,
        "conflicts_intra": _WHOLE,
        "conflicts_inter": _WHOLE,
        "duration": _REAL,
        "ended": _TEXT,
    }
)
"""Columns of ``runs.parquet``: one row for each (run, swarm) and each curve the run belongs to."""

POLICIES: Final = pa.schema(
    {
        "run": _TEXT,
        "scenario": _TEXT,
        "condition": _TEXT,
        "n": _WHOLE,
        "seed": _WHOLE,
        "swarm": _WHOLE,
        "opponent": _WHOLE,
        "action": _TEXT,
        "share": _REAL,
        "attack_share": _REAL,
    }
)
"""Columns of ``policies.parquet``: one row for each (run, learning swarm, swarm learned about, action), and
each curve the run belongs to."""

CONFLICTS: Final = pa.schema(
    {
        "run": _TEXT,
        "phase": _TEXT,
        "robot": _WHOLE,
        "swarm": _WHOLE,
        "opponent": _WHOLE,
        "opponent_swarm": _WHOLE,
        "start": _REAL,
        "x": _REAL,
        "y": _REAL,
        "action": _TEXT,
        "t_a": _REAL,
        "t_p": _REAL,
        "active": _WHOLE,
        "seen": pa.list_(pa.list_(_WHOLE)),
        "reward": _REAL,
        "q": _REAL,
    }
)
"""Columns of ``conflicts.parquet``: one row for each conflict that a robot began."""

_ARM: Final = pa.struct(
    {"opponent": _WHOLE, "action": _TEXT, "reward": _REAL, "time": _REAL, "count": _REAL, "q": _REAL}
)

ROBOTS: Final = pa.schema(
    {
        "run": _TEXT,
        "robot": _WHOLE,
        "swarm": _WHOLE,
        "policy": _TEXT,
        "pucks": _WHOLE,
        "t_a": _REAL,
        "t_p": _REAL,
        "arms": pa.list_(_ARM),
    }
)
"""Columns of ``robots.parquet``: one row for each robot at the end of its game, with what it learned."""

TRAJECTORY: Final = pa.schema(
    {
        "run": _TEXT,
        "time": _REAL,
        "robot": _WHOLE,
        "x": _REAL,
        "y": _REAL,
        "heading": _REAL,
        "state": _TEXT,
        "puck": _YES_NO,
    }
)
"""Columns of ``trajectory.parquet``: one row for each robot and sample."""

SCHEMAS: Final = {
    "runs": RUNS,
    "policies": POLICIES,
    "conflicts": CONFLICTS,
    "robots": ROBOTS,
    "trajectory": TRAJECTORY,
}
"""Columns of every table by its name, which is the name of its file."""

Row = Mapping[str, object]

_CURVE_POINT: Final = ("scenario", "condition", "n", "seed")
_ORDER: Final = {"runs": (*_CURVE_POINT, "swarm"), "policies": (*_CURVE_POINT, "swarm", "opponent")}


def tabulate(run: Run, outcome: Outcome) -> dict[str, pa.Table]:
    """Return what came out of a run as tables: ``runs``, ``policies`` if a swarm learned, and the records."""
    labels = [
        {"run": run.digest, "scenario": scenario, "condition": condition, "n": run.n, "seed": run.seed}
        for scenario, condition in run.labels
    ]
    tables = {"runs": _labelled(RUNS, labels, outcome.swarms)}
    if outcome.policies:
        tables["policies"] = _labelled(POLICIES, labels, outcome.policies)
    for name, columns in outcome.records.items():
        length = len(next(iter(columns.values())))
        tables[name] = {"run": [run.digest] * length} | columns
    return {name: pa.table(columns, schema=SCHEMAS[name]) for name, columns in tables.items()}


def _labelled(schema: pa.Schema, labels: Iterable[Row], rows: Sequence[Row]) -> dict[str, list[object]]:
    named = [{**label, **row} for label in labels for row in rows]
    return {column: [row[column] for row in named] for column in schema.names}


def prepare(directory: Path) -> None:
    """Make the directory for results, if need be, and make sure that tables can be written there.

    Raises
    ------
    InputError
        If it is not a directory, cannot be written to, or holds a file of a table's name that is
        none of ours.
    """
    try:
        directory.mkdir(parents=True, exist_ok=True)
        with TemporaryFile(dir=directory):
            pass
    except OSError as error:
        raise InputError("out", str(directory), f"must be a writable directory ({error.strerror})") from error
    for name, schema in SCHEMAS.items():
        path = _path(directory, name)
        try:
            ours = not path.exists() or pq.read_schema(path).equals(schema)
        except (OSError, pa.ArrowException):
            ours = False
        if not ours:
            raise InputError("out", str(directory), f"holds a {path.name} that is no table of kswarms")


def write(directory: Path, parts: Iterable[Mapping[str, pa.Table]]) -> list[Path]:
    """Write tables, together with the rows that the directory holds already.

    Earlier rows of a (scenario, condition, n, seed) that is written anew are replaced, and the
    recorded tables keep the rows of exactly the runs that ``runs.parquet`` then names. What is
    written depends on the rows alone, not on their order.

    Parameters
    ----------
    directory : Path
        A directory that went through `prepare`.
    parts : iterable of dict of str to pyarrow.Table
        Tables by name, as `tabulate` gives them.

    Returns
    -------
    list of Path
        The files written.

    Raises
    ------
    OSError
        If writing fails; then every file is as it was.
    """
    parts = list(parts)
    replaced = {point for part in parts for point in _curve_points(part["runs"])}
    present = {"runs", *(name for part in parts for name in part)}
    tables: dict[str, pa.Table] = {}
    for name, schema in SCHEMAS.items():
        earlier = _read(directory, name)
        added = pa.concat_tables([schema.empty_table(), *(part[name] for part in parts if name in part)])
        if name in _ORDER:
            again = pa.array([point in replaced for point in _curve_points(earlier)], pa.bool_())
        else:
            again = _of_runs(earlier, added)
        table = pa.concat_tables([earlier.filter(pc.invert(again)), added])
        if name != "runs":
            table = table.filter(_of_runs(table, tables["runs"]))
        if name in present or len(earlier):
            # Stable: rows of one key, as the actions of a policy, keep their order.
            tables[name] = table.sort_by([(column, "ascending") for column in _ORDER.get(name, ("run",))])

    with TemporaryDirectory(dir=directory, prefix=".unfinished-") as unfinished:
        for name, table in tables.items():
            pq.write_table(table.combine_chunks(), _path(Path(unfinished), name))
        for name in tables:
            _path(Path(unfinished), name).replace(_path(directory, name))
    return [_path(directory, name) for name in tables]


def _path(directory: Path, name: str) -> Path:
    return directory / f"{name}.parquet"


def _read(directory: Path, name: str) -> pa.Table:
    path = _path(directory, name)
    return pq.read_table(path, schema=SCHEMAS[name]) if path.exists() else SCHEMAS[name].empty_table()


def _of_runs(table: pa.Table, runs: pa.Table) -> pa.BooleanArray:
    """Tell for each row of a table whether its run is among those of another."""
    return pc.is_in(table["run"], runs["run"].combine_chunks())


def _curve_points(table: pa.Table) -> Iterable[tuple[object, ...]]:
    return zip(*(table[column].to_pylist() for column in _CURVE_POINT), strict=True)
