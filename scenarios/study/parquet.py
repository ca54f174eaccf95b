"""The tables of results: Parquet files by the contract of section 3.5, written whole or not at all."""

from collections.abc import Iterable, Iterator, Mapping
from itertools import islice
from pathlib import Path
from typing import Any, Final

import pyarrow as pa
import pyarrow.parquet as pq

from kswarms.agents.common.columns import ARM, RECORDED_TABLES, SCHEMA_VERSION, TABLES, Column
from kswarms.scenarios.runs.outcome import Outcome
from kswarms.scenarios.runs.run import Run
from kswarms.scenarios.study.ledger import Ledger, Point

_KINDS: Final = {"text": pa.string(), "integer": pa.int64(), "real": pa.float64(), "boolean": pa.bool_()}


def _arrow_type(kind: str) -> pa.DataType:
    """Return the Arrow type of a kind of column."""
    if kind.startswith("list of "):
        return pa.list_(_arrow_type(kind.removeprefix("list of ")))
    if kind == "arm":
        return pa.struct({column.name: _arrow_type(column.kind) for column in ARM})
    return _KINDS[kind]


def arrow_schema(columns: Iterable[Column]) -> pa.Schema:
    """Return columns as an Arrow schema, with the version of all columns in its metadata."""
    fields = {column.name: _arrow_type(column.kind) for column in columns}
    return pa.schema(fields, metadata={"kswarms_schema": str(SCHEMA_VERSION)})


SCHEMAS: Final = {name: arrow_schema(TABLES[name]) for name in ("runs", "policies", *RECORDED_TABLES)}
"""Schemas of the tables of a study, by name."""

_RESULTS: Final = {"runs": "swarms", "policies": "policies"}
"""What the ledger calls the rows of the tables that have labels."""

_POINTS_AT_ONCE: Final = 1000
_ROWS_AT_ONCE: Final = 100_000
"""Rows of a group in a file; more are not held in memory."""

Row = Mapping[str, Any]


def tabulate(run: Run, outcome: Outcome) -> dict[str, pa.Table]:
    """Return what came out of a run as tables: ``runs``, ``policies`` if a swarm learned, and the records."""
    points = [Point(run.digest, *label, run.n, run.seed) for label in run.labels]
    tables = {"runs": _labelled("runs", ((point, outcome.swarms) for point in points))}
    if outcome.policies:
        tables["policies"] = _labelled("policies", ((point, outcome.policies) for point in points))
    for name, columns in outcome.records.items():
        tables[name] = _of_run(run.digest, name, _record(name, columns))
    return tables


def pack(outcome: Outcome) -> dict[str, bytes]:
    """Return the recorded tables of a run, each packed into bytes for the ledger."""
    packed = {}
    for name, columns in outcome.records.items():
        table = _record(name, columns)
        sink = pa.BufferOutputStream()
        options = pa.ipc.IpcWriteOptions(compression="zstd")
        with pa.ipc.new_stream(sink, table.schema, options=options) as writer:
            writer.write_table(table)
        packed[name] = sink.getvalue().to_pybytes()
    return packed


def export(ledger: Ledger, directory: Path) -> list[Path]:
    """Write the tables of all runs that are done; what they hold does not depend on who played them when.

    Parameters
    ----------
    ledger : Ledger
        What is done.
    directory : Path
        Where the files go.

    Returns
    -------
    list of Path
        The files: of each table with a row, and of each record that some run has.

    Raises
    ------
    OSError
        If writing fails, or the ledger is damaged.
    """
    try:
        names = [name for name in SCHEMAS if _write(name, _rows(ledger, name), directory)]
    except (pa.ArrowException, LookupError) as error:
        raise OSError(f"{ledger.path}: is damaged ({error!r})") from error
    return [_path(directory, name) for name in names]


def _rows(ledger: Ledger, name: str) -> Iterator[pa.Table]:
    """Yield the rows of a table, in order, some at a time."""
    if name in RECORDED_TABLES:
        for run, rows in ledger.records(name):
            yield _of_run(run, name, pa.ipc.open_stream(rows).read_all())
    else:
        points = ledger.results(_RESULTS[name])
        while some := list(islice(points, _POINTS_AT_ONCE)):
            yield _labelled(name, some)


def _write(name: str, parts: Iterable[pa.Table], directory: Path) -> bool:
    """Write a table, a group of rows at a time, and tell whether there was anything to write."""
    parts = iter(parts)
    first = next(parts, None)
    if first is None:
        return False
    with pq.ParquetWriter(_path(directory, name), SCHEMAS[name]) as writer:
        group = [first]
        for part in parts:
            if sum(map(len, group)) >= _ROWS_AT_ONCE:
                writer.write_table(pa.concat_tables(group).combine_chunks())
                group = []
            group.append(part)
        writer.write_table(pa.concat_tables(group).combine_chunks())
    return True


def _labelled(name: str, points: Iterable[tuple[Point, Iterable[Row]]]) -> pa.Table:
    schema = SCHEMAS[name]
    rows = [{**point._asdict(), **row} for point, rows in points for row in rows]
    return pa.table({column: [row[column] for row in rows] for column in schema.names}, schema=schema)


def _record(name: str, columns: Mapping[str, list[Any]]) -> pa.Table:
    return pa.table(columns, schema=SCHEMAS[name].remove(0))  # the run comes in when it is exported


def _of_run(run: str, name: str, record: pa.Table) -> pa.Table:
    return record.add_column(0, SCHEMAS[name].field(0), pa.array([run] * len(record), pa.string()))


def _path(directory: Path, name: str) -> Path:
    return directory / f"{name}.parquet"
