"""Reading and checking tables of results as data frames, against the schema of columns."""

from collections.abc import Collection, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import pandas as pd

from kswarms.agents.common.columns import TABLES
from kswarms.agents.common.errors import InputError
from kswarms.agents.common.input_files import to_path
from kswarms.agents.common.tables import arrow_table, check_table, read_metadata
from kswarms.agents.common.tables import read_table as read_arrow_table


def read_table(
    directory: str | Path,
    table: str,
    columns: Sequence[str] | None = None,
    runs: Collection[str] | None = None,
) -> pd.DataFrame:
    """Read a table of a results directory and check it against the schema.

    By default all runs and all columns are read, including columns that the schema lacks. Columns of the
    schema have its types: str, int64, float64, bool.

    Raises
    ------
    InputError
        The directory or the file is missing or unreadable; or as in `check_table`.
    """
    directory = to_path("results", directory)
    if not directory.is_dir():
        raise InputError("results", str(directory), "must be a directory that `kswarms run` wrote")
    path = directory / f"{table}.parquet"
    if not path.is_file():
        raise InputError("results", str(directory), f"must be a directory that holds {path.name}")
    return to_frame(read_arrow_table(path, table, columns, runs), table)


def check_frame(rows: Any, table: str, required: Collection[str] | None = None) -> pd.DataFrame:
    """Check a data frame against the schema; return it with the types of the schema.

    `required` are the columns that must be present, by default all of the schema. `InputError` as in
    `kswarms.agents.common.tables.check_table`.
    """
    require_columns(rows, table, [])
    names = [column.name for column in TABLES[table] if column.name in rows.columns]
    for name in names:
        if list(rows.columns).count(name) > 1:
            raise InputError(table, name, "must have one column of this name")
    checked = check_table(arrow_table({name: rows[name] for name in names}, table), table, table, required)
    types = {column.name: column.kind for column in TABLES[table]}
    flat = [name for name in names if types[name] in ("text", "integer", "real", "boolean")]
    frame = to_frame(checked.select(flat), table).set_axis(rows.index)
    checked_rows: pd.DataFrame = rows.assign(**{name: frame[name] for name in flat})
    return checked_rows


def require_columns(rows: Any, table: str, required: Sequence[str]) -> None:
    """Raise an `InputError` unless `rows` is a data frame with the required columns."""
    if not isinstance(rows, pd.DataFrame):
        raise InputError(table, type(rows).__name__, "must be a pandas.DataFrame")
    absent = [name for name in required if name not in rows]
    if absent:
        raise InputError(table, absent, "must have these columns too")


def rows_where(rows: Any, table: str, column: str, values: Collection[str]) -> pd.DataFrame:
    """Return the rows of a data frame with some values in a column, checked by `check_frame`."""
    if isinstance(rows, pd.DataFrame) and list(rows.columns).count(column) == 1:
        with suppress(TypeError):  # values that cannot be compared fail the check
            rows = rows[rows[column].isin(list(values))]
    return check_frame(rows, table)


def to_frame(found: Any, table: str) -> pd.DataFrame:
    """Return a checked Arrow table as a data frame; texts are str."""
    rows: pd.DataFrame = found.to_pandas()
    texts = {column.name: str for column in TABLES[table] if column.kind == "text" and column.name in rows}
    return rows.astype(texts)


def count_rows(path: Path) -> int:
    """Return the number of rows of a Parquet file; `InputError` if it cannot be read."""
    return int(read_metadata(path).num_rows)
