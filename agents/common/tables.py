"""Arrow tables of results: validation against the schema of columns, and reading of Parquet files."""

import os
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from kswarms.agents.common.columns import (
    ARM,
    KEYS,
    LONGEST_TEXT,
    SCHEMA_VERSION,
    TABLES,
    Column,
    column_names,
)
from kswarms.agents.common.errors import InputError
from kswarms.agents.common.input_files import require_regular_file
from kswarms.agents.common.limits import ONE_LINE

_KINDS: Final = {"text": pa.string(), "integer": pa.int64(), "real": pa.float64(), "boolean": pa.bool_()}
_PLURALS: Final = {"text": "texts", "integer": "integers", "real": "numbers", "boolean": "truth values"}
_ERRORS: Final = (
    pa.ArrowException, OSError, ValueError, LookupError, TypeError, ArithmeticError, RuntimeError, MemoryError
)  # fmt: skip
"""Errors of Arrow for damaged files and values."""
_BYTES_PER_VALUE: Final = 16
"""Estimated memory of a value that is read; files can be compressed ten thousandfold."""


def arrow_schema(columns: Iterable[Column]) -> pa.Schema:
    """Return columns as an Arrow schema, with the version of the columns in its metadata."""
    fields = {column.name: _arrow_type(column.kind) for column in columns}
    return pa.schema(fields, metadata={"kswarms_schema": str(SCHEMA_VERSION)})


def _arrow_type(kind: str) -> pa.DataType:
    if kind.startswith("list of "):
        return pa.list_(_arrow_type(kind.removeprefix("list of ")))
    if kind == "arm":
        return pa.struct({column.name: _arrow_type(column.kind) for column in ARM})
    return _KINDS[kind]


def arrow_table(columns: Mapping[str, Any], source: str) -> pa.Table:
    """Return columns of Python values, arrays or series as an Arrow table; NaN becomes null.

    `InputError` about a column of `source` whose values are not of one kind.
    """
    arrays = {}
    for name, values in columns.items():
        try:
            arrays[name] = pa.array(values, from_pandas=True)
        except _ERRORS as error:
            raise InputError(f"{source} column {name}", type(values).__name__, str(error)) from error
    return pa.table(arrays)


def check_table(
    found: pa.Table, table: str, source: str = "", required: Collection[str] | None = None
) -> pa.Table:
    """Check a table against the schema of columns; return it with the types of the schema.

    Integers may be reals, texts may be categories. Further columns are kept.

    Parameters
    ----------
    found : pyarrow.Table
        It may be from an untrusted file.
    table : str
        Name of the table in `kswarms.agents.common.columns.TABLES`.
    source : str
        Name of the table in errors, by default its file.
    required : collection of str, optional
        Names of the columns that must be present, by default all of the schema. Others may be.

    Raises
    ------
    InputError
        A column is missing or occurs twice, has another type, or has a value that is missing or not allowed;
        or two rows have the same key.
    """
    source = source or f"{table}.parquet"
    try:
        found.validate(full=True)
        return _check_columns(found, table, source, required)
    except InputError:
        raise
    except _ERRORS as error:
        raise InputError(source, str(error), "must be a valid table") from error


def _check_columns(found: pa.Table, table: str, source: str, required: Collection[str] | None) -> pa.Table:
    absent = [name for name in required or column_names(table) if name not in found.column_names]
    if absent:
        raise InputError(source, absent, "must have these columns too")
    present = [column for column in TABLES[table] if column.name in found.column_names]
    for column in present:
        if found.column_names.count(column.name) > 1:
            raise InputError(source, column.name, "must have one column of this name")
        index = found.column_names.index(column.name)
        checked = _check_values(found.column(index), column, f"{source} column {column.name}")
        found = found.set_column(index, column.name, checked)
    if {column.name for column in present}.issuperset(KEYS[table]):
        _check_key(found, KEYS[table], source)
    return found


def _check_key(found: pa.Table, key: Sequence[str], source: str) -> None:
    counts = found.group_by(list(key)).aggregate([([], "count_all")])
    if len(counts) < len(found):
        twice = counts.filter(pc.greater(counts["count_all"], 1)).select(list(key)).slice(0, 1).to_pylist()[0]
        values = ", ".join(f"{name}={value}" for name, value in twice.items())
        raise InputError(f"{source} key", values, "must be of one row only")


def _check_values(values: pa.ChunkedArray, column: Column, field: str) -> pa.ChunkedArray:
    """Return checked values with the type of a column."""
    if not column.may_be_missing and values.null_count:
        raise InputError(field, None, "must be given in every row")
    if pa.types.is_null(values.type):
        return values.cast(_arrow_type(column.kind))
    if column.kind.startswith("list of "):
        return _check_lists(values, column, field)
    if column.kind == "arm":
        return _check_arms(values, field)
    if column.kind == "text":
        return _check_texts(values, column, field)
    if column.kind == "boolean":
        _check_type(pa.types.is_boolean(values.type), values, column, field)
        return values
    return _check_numbers(values, column, field)


def _check_type(fits: bool, values: pa.ChunkedArray, column: Column, field: str) -> None:
    if not fits:
        plural = _PLURALS.get(column.kind, f"{column.kind}s")
        raise InputError(field, str(values.type), f"must be a column of {plural}")


def _check_lists(values: pa.ChunkedArray, column: Column, field: str) -> pa.ChunkedArray:
    kinds = (pa.types.is_list, pa.types.is_large_list, pa.types.is_fixed_size_list)
    _check_type(any(fits(values.type) for fits in kinds), values, column, field)
    _check_values(pc.list_flatten(values), column._replace(kind=column.kind.removeprefix("list of ")), field)
    return values


def _check_arms(values: pa.ChunkedArray, field: str) -> pa.ChunkedArray:
    names = [each.name for each in values.type] if pa.types.is_struct(values.type) else []
    for column in ARM:
        _check_type(names.count(column.name) == 1, values, column._replace(kind="arm"), field)
        _check_values(pc.struct_field(values, [column.name]), column, f"{field}.{column.name}")
    return values


def _check_texts(values: pa.ChunkedArray, column: Column, field: str) -> pa.ChunkedArray:
    categories = pa.types.is_dictionary(values.type)
    kind = values.type.value_type if categories else values.type
    _check_type(pa.types.is_string(kind) or pa.types.is_large_string(kind), values, column, field)
    for chunk in values.chunks:
        # Categories are not expanded before they are checked.
        distinct = chunk.dictionary if categories else pc.unique(chunk)
        longest = pc.max(pc.utf8_length(distinct)).as_py() or 0
        if longest > LONGEST_TEXT:
            raise InputError(field, f"{longest:,} characters", f"must have at most {LONGEST_TEXT:,}")
        for text in distinct.to_pylist():
            if text is None or not re.fullmatch(ONE_LINE, text):
                raise InputError(field, text, "must be one line without control characters")
            if column.choices and text not in column.choices:
                raise InputError(field, text, f"must be one of {', '.join(column.choices)}")
    return values.cast(kind) if categories else values


def _check_numbers(values: pa.ChunkedArray, column: Column, field: str) -> pa.ChunkedArray:
    fits = pa.types.is_integer(values.type) or pa.types.is_floating(values.type)
    _check_type(fits, values, column, field)
    low, high = column.bounds
    numbers = values.cast(pa.float64(), safe=False)
    allowed = pc.and_(pc.greater_equal(numbers, low), pc.less_equal(numbers, high))
    if column.kind == "integer":
        allowed = pc.and_(allowed, pc.equal(pc.floor(numbers), numbers))
    if column.may_be_missing:
        allowed = pc.or_(allowed, pc.is_nan(numbers))
    allowed = pc.fill_null(allowed, column.may_be_missing)
    index = pc.index(allowed, False).as_py()
    if index >= 0:
        kind = "an integer" if column.kind == "integer" else "a finite number"
        raise InputError(field, values[index].as_py(), f"must be {kind} {column.allowed}".rstrip())
    return values.cast(_KINDS[column.kind], safe=False)


def read_table(
    path: Path,
    table: str,
    columns: Sequence[str] | None = None,
    runs: Collection[str] | None = None,
    field: str = "results",
) -> pa.Table:
    """Read a Parquet file and check it with `check_table`.

    Parameters
    ----------
    path : Path
    table : str
        Name of the table in `kswarms.agents.common.columns.TABLES`.
    columns : sequence of str, optional
        Columns to read, by default all, including columns that the schema lacks.
    runs : collection of str, optional
        Values of the column `run` to read, by default all.
    field : str
        Name of the argument or option in errors about the file.

    Raises
    ------
    InputError
        The file is missing, unreadable, damaged or too large for the memory; or as in `check_table`.
    """
    metadata = read_metadata(path, field)
    required = column_names(table) if columns is None else columns
    with _readable(path, field):
        present = metadata.schema.to_arrow_schema().names
    absent = [name for name in required if name not in present]
    if absent:
        raise InputError(field, str(path), f"must have the missing columns {', '.join(absent)}")
    _check_size(metadata, ["run"] if runs is not None else columns, path, field)
    filters = None if runs is None else [("run", "in", {_require_digest(run) for run in runs})]
    with _readable(path, field), path.open("rb") as file:
        found = pq.read_table(
            file,
            columns=columns and list(columns),
            filters=filters,
            read_dictionary=list(column_names(table, "text")),
        )
    return check_table(found.replace_schema_metadata(None), table, path.name, required)


def _require_digest(run: object) -> str:
    if not isinstance(run, str):
        raise InputError("runs", run, "must be the digest of a run")
    return run


def read_metadata(path: Path, field: str = "results") -> Any:
    """Return the metadata of a Parquet file; `InputError` if it cannot be read."""
    require_regular_file(field, path)
    with _readable(path, field), path.open("rb") as file:
        return pq.read_metadata(file)


def _check_size(metadata: Any, columns: Sequence[str] | None, path: Path, field: str) -> None:
    """Raise an `InputError` if reading some columns takes more than the memory of the machine."""
    parts = [
        group.column(k)
        for group in map(metadata.row_group, range(metadata.num_row_groups))
        for k in range(group.num_columns)
    ]
    size = sum(
        max(_BYTES_PER_VALUE * part.num_values, part.total_uncompressed_size)
        for part in parts
        if columns is None or part.path_in_schema.partition(".")[0] in columns
    )
    memory = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    if size > memory:
        rule = f"needs {size / 1e9:,.0f} GB of memory, of {memory / 1e9:,.0f} GB"
        raise InputError(field, str(path), rule)


@contextmanager
def _readable(path: Path, field: str) -> Iterator[None]:
    """Re-raise the errors of a damaged file as `InputError`."""
    try:
        yield
    except _ERRORS as error:
        raise InputError(field, str(path), "must be a readable Parquet file") from error
