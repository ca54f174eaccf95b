"""The table of contributions: ``contribution.parquet`` in a results directory."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from kswarms.agents.common.atomic_files import atomic_path, remove_temporary_files
from kswarms.agents.common.columns import TABLES
from kswarms.agents.common.errors import InputError
from kswarms.scenarios.study.directory import CONTRIBUTIONS_FILE, make_directory
from kswarms.scenarios.study.parquet import arrow_schema

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
    try:
        valid = not path.exists() or pq.read_schema(path).equals(SCHEMA)
    except (OSError, pa.ArrowException):
        valid = False
    if not valid:
        raise InputError("out", str(directory), f"has a {FILE} that is no table of kswarms")
    remove_temporary_files(directory)


def write_table(directory: Path, rows: Sequence[dict[str, Any]]) -> Path:
    """Add rows (at least one, as `contributions` returns them) to the table; return its path.

    Earlier rows of the same scenario, condition, N and `absent_from` are replaced.
    """
    path = directory / FILE
    table = pa.Table.from_pylist(list(rows), schema=SCHEMA)
    if path.exists():
        earlier = pq.read_table(path, schema=SCHEMA)
        replaced = pa.array([True] * len(earlier))
        for name in _KEY:
            replaced = pc.and_(replaced, pc.equal(earlier[name], rows[0][name]))
        table = pa.concat_tables([earlier.filter(pc.invert(replaced)), table])
    table = table.sort_by([(name, "ascending") for name in (*_KEY, "seed", "robot")])
    with atomic_path(path) as file:
        pq.write_table(table, file)
    return path


def find_row(directory: Path, run: str) -> dict[str, Any] | None:
    """Return a row of the table that compares a run, by its digest; None without such a row or table."""
    path = directory / FILE
    if not path.is_file():
        return None
    try:
        table = pq.read_table(path, schema=SCHEMA)
    except (OSError, ValueError) as error:  # every error of pyarrow is one of these
        raise InputError("results", str(directory), f"has a {FILE} that cannot be read") from error
    rows: list[dict[str, Any]] = table.to_pylist()
    return next((row for row in rows if run in (row["run"], row["run_without"])), None)
