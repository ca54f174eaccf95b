"""Reading and checking the Parquet tables of a results directory against the schema of columns."""

from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Final

import pandas as pd
import pyarrow.parquet as pq
from pandas.api.types import is_numeric_dtype

from kswarms.agents.common.columns import TABLES, column_names
from kswarms.agents.common.errors import InputError

# Errors of Arrow and pandas for damaged files.
_FILE_ERRORS: Final = (OSError, ValueError, LookupError, TypeError, RuntimeError)
_NAN_ALLOWED: Final = {"reward", "q", "time_sud", "time_sud_without"}


def read_table(
    directory: Path, table: str, columns: Sequence[str] | None = None, runs: Collection[str] | None = None
) -> pd.DataFrame:
    """Read a table of a results directory and check it against the schema.

    By default all runs and all columns are read, including columns that the schema lacks. Columns of the
    schema have its types: text is str, numbers are numeric.

    Raises
    ------
    InputError
        The directory or the file is missing or unreadable; or a column is missing, has missing values or has
        a wrong type.
    """
    if not directory.is_dir():
        raise InputError("results", str(directory), "must be a directory that `kswarms run` wrote")
    path = directory / f"{table}.parquet"
    if not path.is_file():
        raise InputError("results", str(directory), f"must be a directory that holds {path.name}")
    required = column_names(table) if columns is None else columns
    with _readable(path):
        present = pq.read_schema(path).names
    missing = [name for name in required if name not in present]
    if missing:
        raise InputError("results", str(path), f"must have the missing columns {', '.join(missing)}")
    filters = None if runs is None else [("run", "in", set(runs))]
    with _readable(path):
        found = pq.read_table(path, columns=columns and list(columns), filters=filters)
        rows: pd.DataFrame = found.to_pandas()
    return check_columns(rows, table, required)


def check_columns(rows: pd.DataFrame, table: str, required: Sequence[str]) -> pd.DataFrame:
    """Return rows with the types of the schema; `InputError` for missing values and wrong types."""
    for name, kind, *_ in TABLES[table]:
        if name not in required:
            continue
        field = f"{table}.parquet column {name}"
        if name not in _NAN_ALLOWED and rows[name].isna().any():
            raise InputError(field, None, "must be given in every row")
        if kind in ("integer", "real") and not is_numeric_dtype(rows[name]):
            raise InputError(field, str(rows[name].dtype), "must be a column of numbers")
    return rows.astype({name: str for name in column_names(table, "text") if name in required})


def count_rows(path: Path) -> int:
    """Return the number of rows of a Parquet file; `InputError` if it cannot be read."""
    with _readable(path):
        return int(pq.read_metadata(path).num_rows)


@contextmanager
def _readable(path: Path) -> Iterator[None]:
    """Re-raise the errors of a damaged file as `InputError`."""
    try:
        yield
    except _FILE_ERRORS as error:
        raise InputError("results", str(path), "must be a readable Parquet file") from error
