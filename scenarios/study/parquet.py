"""The tables of a study as Parquet files; `kswarms.agents.common.columns` describes their columns."""

import re
from collections.abc import Iterator, Mapping
from itertools import islice
from pathlib import Path
from typing import Any, Final

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from kswarms.agents.common.columns import RECORDED_TABLES, TABLES, Column, column_names
from kswarms.agents.common.errors import InputError
from kswarms.agents.common.tables import arrow_schema, check_table
from kswarms.scenarios.description.scenario import ID_PATTERN
from kswarms.scenarios.study.database import damage_errors
from kswarms.scenarios.study.ledger import Ledger, Point
from kswarms.scenarios.study.mixtures import Curve

STUDY_TABLES: Final = ("runs", "policies", *RECORDED_TABLES)
"""Names of the tables of a study."""
_POINTS_PER_PART: Final = 1000
_ROWS_PER_GROUP: Final = 100_000
"""Minimum number of rows of a row group, which limits the memory of an export."""

_PATTERNS: Final = {"run": "[0-9a-f]{16}", "scenario": ID_PATTERN}
"""Patterns of columns of text whose values may become names of files."""
_TYPES: Final[dict[str, set[type]]] = {
    "boolean": {bool}, "integer": {int}, "real": {int, float}, "text": {str}
}  # fmt: skip
"""Python types of values that fit each kind of column; in a column of text of a grid, any value fits."""


def pack(records: Mapping[str, Mapping[str, Any]]) -> dict[str, bytes]:
    """Return the recorded tables of a run as Arrow streams, for the ledger."""
    packed = {}
    for name, columns in records.items():
        table = pa.table(columns, schema=arrow_schema(TABLES[name][1:]))  # without the column `run`
        sink = pa.BufferOutputStream()
        options = pa.ipc.IpcWriteOptions(compression="zstd")
        with pa.ipc.new_stream(sink, table.schema, options=options) as writer:
            writer.write_table(table, max_chunksize=_ROWS_PER_GROUP)
        packed[name] = sink.getvalue().to_pybytes()
    return packed


def export(ledger: Ledger, directory: Path) -> list[Path]:
    """Write the tables of all finished runs to a directory; skip tables that no run has. Return the paths.

    The bytes do not depend on the order in which runs end. A damaged ledger raises an `OSError`.
    """
    paths = []
    with damage_errors(ledger.path, pa.ArrowException, InputError):
        for name, schema, parts in _tables(ledger):
            path = directory / f"{name}.parquet"
            if _write(path, schema, parts):
                paths.append(path)
    return paths


def check_tables(ledger: Ledger) -> None:
    """Raise an `OSError` if `export` would report a damaged ledger; nothing is written."""
    with damage_errors(ledger.path, pa.ArrowException, InputError):
        for _, _, parts in _tables(ledger):
            for _ in parts:
                pass


def _tables(ledger: Ledger) -> Iterator[tuple[str, pa.Schema, Iterator[pa.Table]]]:
    """Yield name, schema and parts of each table."""
    grid_columns, grid_points = _grid(ledger)
    for name in STUDY_TABLES:
        if name in RECORDED_TABLES:
            schema, parts = arrow_schema(TABLES[name]), _recorded_parts(ledger, name)
        else:
            labels, rest = TABLES[name][: len(Point._fields)], TABLES[name][len(Point._fields) :]
            schema = arrow_schema((*labels, *grid_columns, *rest))
            parts = _result_parts(ledger, name, schema, grid_points)
        yield name, schema, (_check(part, name, schema) for part in parts)


def _check(part: pa.Table, name: str, schema: pa.Schema) -> pa.Table:
    """Return a part of a table; raise a `ValueError` if it does not fit the schema."""
    if not part.schema.equals(schema):
        raise ValueError(f"wrong columns in {name}")
    check_table(part, name)
    for column, pattern in _PATTERNS.items():
        if column in part.column_names:
            for text in pc.unique(part[column]).to_pylist():
                if not re.fullmatch(pattern, text):
                    raise InputError(f"{name}.parquet column {column}", text, f"must match {pattern}")
    return part


def _grid(ledger: Ledger) -> tuple[list[Column], dict[Curve, dict[str, Any]]]:
    """Return a column for each field of the grids (``grid.n`` if a column ``n`` exists), and the values."""
    taken = {*column_names("runs"), *column_names("policies")}
    points = {
        curve: {f"grid.{field}" if field in taken else field: value for field, value in point.items()}
        for curve, point in ledger.grid_points().items()
    }
    columns = []
    for name in dict.fromkeys(name for point in points.values() for name in point):
        if not name.replace(".", "_").isidentifier():
            raise ValueError(f"wrong name of a field of a grid: {name!r:.50}")
        with_field = [point for point in points.values() if name in point]
        types = {type(point[name]) for point in with_field}
        kind = next((kind for kind, accepted in _TYPES.items() if types <= accepted), "text")
        if kind == "text":
            for point in with_field:
                point[name] = str(point[name])
        columns.append(Column(name, kind, "", "value in the grid of the scenario"))
    return columns, points


def _recorded_parts(ledger: Ledger, name: str) -> Iterator[pa.Table]:
    for run, rows in ledger.records(name):
        part = pa.ipc.open_stream(pa.py_buffer(rows)).read_all()
        yield part.add_column(0, "run", pa.array([run] * len(part), pa.string()))


def _result_parts(
    ledger: Ledger, name: str, schema: pa.Schema, grid_points: Mapping[Curve, dict[str, Any]]
) -> Iterator[pa.Table]:
    no_grid: dict[str, Any] = dict.fromkeys(column for point in grid_points.values() for column in point)
    field = "swarms" if name == "runs" else name
    points = (_point_rows(point, rows, field) for point, rows in ledger.results(field))
    while batch := list(islice(points, _POINTS_PER_PART)):
        rows = [
            no_grid | grid_points.get((point.scenario, point.condition), {}) | point._asdict() | row
            for point, rows in batch
            for row in rows
        ]
        if not rows:
            continue
        columns = {column: [row[column] for row in rows] for column in schema.names}
        for column in TABLES[name]:  # Arrow would convert some wrong types, such as 1.5 for an integer
            if not set(map(type, columns[column.name])) <= _TYPES[column.kind]:
                raise TypeError(f"wrong type of {column.name} in {name}")
        yield pa.table(columns, schema=schema)


def _point_rows(point: Point, rows: list[dict[str, Any]], field: str) -> tuple[Point, list[dict[str, Any]]]:
    """Return a point with its rows; raise a `ValueError` unless a run has a row for each swarm."""
    if field == "swarms" and (not rows or [row["swarm"] for row in rows] != list(range(1, len(rows) + 1))):
        raise ValueError(f"wrong swarms of run {point.run}")
    return point, rows


def _write(path: Path, schema: pa.Schema, parts: Iterator[pa.Table]) -> bool:
    """Write the parts of a table in row groups; without parts, write nothing and return False."""
    first = next(parts, None)
    if first is None:
        return False
    # Arrow opens no path that is not UTF-8.
    with path.open("wb") as file, pq.ParquetWriter(file, schema) as writer:
        group = [first]
        for part in parts:
            if sum(map(len, group)) >= _ROWS_PER_GROUP:
                writer.write_table(pa.concat_tables(group).combine_chunks())
                group = []
            group.append(part)
        writer.write_table(pa.concat_tables(group).combine_chunks())
    return True
