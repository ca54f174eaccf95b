"""The table of contributions: ``contribution.parquet`` in a results directory."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from kswarms.agents.common.atomic_files import atomic_path, remove_temporary_files
from kswarms.agents.common.columns import TABLES
from kswarms.agents.common.errors import InputError
from kswarms.agents.common.tables import arrow_schema, read_table
from kswarms.scenarios.study.directory import CONTRIBUTIONS_FILE, make_directory
from kswarms.scenarios.study.lock import brief_lock

FILE: Final = CONTRIBUTIONS_FILE
SCHEMA: Final = arrow_schema(TABLES["contribution"])
"""Columns of the table; each row compares a game with and without a robot."""
_KEY: Final = ("scenario", "condition", "absent_from", "n")


def prepare_table(directory: Path) -> None:
    """Create a directory for the table if necessary, and remove temporary files of killed processes.

    Raise `InputError` as `make_directory` does, or if a file of the same name has other columns.
    """
    make_directory(directory, FILE)
    path = directory / FILE
    if os.path.lexists(path) and _read(path, "out").column_names != SCHEMA.names:
        raise InputError("out", str(path), "must have the columns of a table of contributions only")
    remove_temporary_files(directory)


def write_table(directory: Path, rows: Sequence[dict[str, Any]]) -> Path:
    """Add rows (at least one, as `contributions` returns them) to the table; return its path.

    Earlier rows of the same scenario, condition, N and `absent_from` are replaced.
    """
    path = directory / FILE
    table = pa.Table.from_pylist(list(rows), schema=SCHEMA)
    with brief_lock(directory):
        if path.exists():
            earlier = _read(path, "out")
            replaced = pa.array([True] * len(earlier))
            for name in _KEY:
                replaced = pc.and_(replaced, pc.equal(earlier[name], rows[0][name]))
            table = pa.concat_tables([earlier.filter(pc.invert(replaced)), table])
        table = table.sort_by([(name, "ascending") for name in (*_KEY, "seed", "robot")])
        # Arrow opens no path that is not UTF-8.
        with atomic_path(path) as temporary, temporary.open("wb") as file:
            pq.write_table(table, file)
    return path


def find_row(directory: Path, run: str) -> dict[str, Any] | None:
    """Return a row of the table that compares a run, by its digest; None without such a row or table."""
    path = directory / FILE
    if not path.is_file():
        return None
    rows: list[dict[str, Any]] = _read(path, "results").to_pylist()
    return next((row for row in rows if run in (row["run"], row["run_without"])), None)


def _read(path: Path, field: str) -> pa.Table:
    """Return the table with the types of the schema; `InputError` about `field` if it is damaged."""
    table = read_table(path, "contribution", field=field)
    return table.cast(SCHEMA) if table.column_names == SCHEMA.names else table
