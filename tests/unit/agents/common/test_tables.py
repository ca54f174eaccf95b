"""Damaged and doctored tables are refused with the column, the value and the rule."""

import math
import os
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from kswarms.agents.common.columns import ARM, LONGEST_TEXT, TABLES, Column
from kswarms.agents.common.errors import InputError
from kswarms.agents.common.tables import arrow_schema, arrow_table, check_table, read_table

VALUES: dict[str, Any] = {"text": "a", "integer": 1, "real": 0.5, "boolean": True}
PARAMETERS = [(table, column) for table, columns in TABLES.items() for column in columns]
NUMBERS = [each for each in PARAMETERS if each[1].kind in ("integer", "real")]
TEXTS = [each for each in PARAMETERS if each[1].kind == "text"]


def valid_value(column: Column) -> Any:
    if column.kind.startswith("list of "):
        return [valid_value(column._replace(kind=column.kind.removeprefix("list of ")))]
    if column.kind == "arm":
        return {each.name: valid_value(each) for each in ARM}
    return column.choices[0] if column.choices else VALUES[column.kind]


def a_table(table: str, rows: int = 2, **columns: Any) -> pa.Table:
    """Return a valid table whose rows differ in the last column of the key; `columns` replace some."""
    content = {column.name: [valid_value(column)] * rows for column in TABLES[table]}
    key = {"runs": "seed", "policies": "seed", "contribution": "robot"}.get(table, "robot")
    return pa.table(content | {key: list(range(1, rows + 1))} | columns)


def name_of(parameter: Any) -> str:
    return parameter.name if isinstance(parameter, Column) else str(parameter)


@pytest.mark.parametrize("table", TABLES)
def test_a_valid_table_has_the_types_of_the_schema(table: str, tmp_path: Path) -> None:
    found = a_table(table, extra=["kept", "too"])
    checked = check_table(found, table)
    assert checked.select(arrow_schema(TABLES[table]).names).schema.equals(arrow_schema(TABLES[table]))
    assert checked["extra"].to_pylist() == ["kept", "too"]
    assert len(check_table(found.slice(0, 0), table)) == 0
    pq.write_table(found, tmp_path / "x.parquet")
    assert read_table(tmp_path / "x.parquet", table).equals(checked)


@pytest.mark.parametrize(("table", "column"), NUMBERS, ids=name_of)
def test_a_number_that_is_not_allowed_is_refused(table: str, column: Column) -> None:
    low, high = column.bounds
    wrong = [math.inf, -math.inf, low * 1.1 - 1, high * 1.1 + 1]
    wrong += [0.5] if column.kind == "integer" else []
    wrong += [] if column.may_be_missing else [math.nan]
    for value in wrong:
        found = a_table(table, **{column.name: [1.0, value]})
        with pytest.raises(InputError, match=f"{table}.parquet column {column.name}=.*: must be a") as error:
            check_table(found, table)
        assert str(error.value.value) == str(value)


@pytest.mark.parametrize(("table", "column"), PARAMETERS, ids=name_of)
def test_a_missing_value_or_another_type_is_refused(table: str, column: Column) -> None:
    field = f"{table}.parquet column {column.name}"
    index = a_table(table).column_names.index(column.name)

    def refuse(values: pa.Array, message: str) -> None:
        with pytest.raises(InputError, match=f"{field}.*{message}"):
            check_table(a_table(table).set_column(index, column.name, values), table)

    if not column.may_be_missing:
        refuse(pa.array([None, valid_value(column)]), "must be given in every row")
        refuse(pa.nulls(2), "must be given in every row")
    times = pa.array([datetime(2026, 1, 1, tzinfo=UTC)] * 2)
    for values in (times, pa.array([b"a", b"b"]), pa.array([{"x": 1}] * 2), pa.array([[["a"]], [["b"]]])):
        refuse(values, "must be a column of")
    if column.kind != "boolean":
        refuse(pa.array([True, False]), "must be a column of")
    if column.kind not in ("text", "boolean"):
        refuse(pa.array(["1", "2"]).dictionary_encode(), "must be a column of")
    with pytest.raises(InputError, match=rf"\['{column.name}'\]: must have these columns too"):
        check_table(a_table(table).drop_columns(column.name), table)
    twice = a_table(table).append_column(column.name, pa.array([valid_value(column)] * 2))
    with pytest.raises(InputError, match=f"='{column.name}': must have one column of this name"):
        check_table(twice, table)


@pytest.mark.parametrize(("table", "column"), TEXTS, ids=name_of)
def test_a_text_that_is_not_one_line_is_refused(table: str, column: Column) -> None:
    good = valid_value(column)
    for text in ("a\n", "\x1b[2J", "a\x00", "\u202ex", "\x9b", "x" * (LONGEST_TEXT + 1)):
        for values in (pa.array([good, text]), pa.array([good, text]).dictionary_encode()):
            with pytest.raises(InputError, match=f"column {column.name}="):
                check_table(a_table(table, **{column.name: values}), table)
    if column.choices:
        with pytest.raises(InputError, match=f"='other': must be one of {', '.join(column.choices)}"):
            check_table(a_table(table, **{column.name: [good, "other"]}), table)


@pytest.mark.parametrize("table", TABLES)
def test_doubled_rows_are_refused(table: str) -> None:
    found = a_table(table)
    with pytest.raises(InputError, match=f"{table}.parquet key='.*: must be of one row only"):
        check_table(pa.concat_tables([found, found.slice(1)]), table)


def test_values_within_lists_are_checked() -> None:
    for seen in ([[-1]], [[0.5]], [[None]], [None]):
        with pytest.raises(InputError, match=r"conflicts\.parquet column seen="):
            check_table(a_table("conflicts", seen=pa.array([[[1]], seen])), "conflicts")
    arm = valid_value(Column("arms", "arm", "", ""))
    for changes in ({"opponent": 0}, {"count": -1.0}, {"action": "a\nb"}, {"reward": math.inf}):
        arms = pa.array([[], [arm, arm | changes]])
        with pytest.raises(InputError, match=rf"robots\.parquet column arms\.{next(iter(changes))}="):
            check_table(a_table("robots", arms=arms), "robots")
    check_table(a_table("robots", arms=pa.array([[], [arm | {"q": None}]])), "robots")


def test_other_storage_types_of_the_same_values_are_read() -> None:
    found = a_table(
        "runs",
        scenario=pa.array(["a", "a"]).dictionary_encode(),
        condition=pa.array(["", "b"], pa.large_string()),
        pucks=pa.array([1.0, 2.0]),
        n=pa.array([4, 6], pa.uint8()),
        t_p=pa.array([1, 2]),
        duration=pa.array([1, 2], pa.float32()),
    )
    checked = check_table(found, "runs")
    assert checked["pucks"].to_pylist() == [1, 2]
    assert [str(checked.schema.field(name).type) for name in ("scenario", "n", "t_p", "duration")] == [
        "string",
        "int64",
        "double",
        "double",
    ]


def test_invalid_utf_8_and_invalid_offsets_are_refused() -> None:
    text = pa.Array.from_buffers(pa.string(), 2, [None, *pa.array([b"\xff", b"a"]).buffers()[1:]])
    offsets = pa.py_buffer(b"".join(each.to_bytes(4, "little") for each in (0, 2, 1)))
    outside = pa.Array.from_buffers(pa.string(), 2, [None, offsets, pa.py_buffer(b"ab")])
    for values in (text, outside):
        with pytest.raises(InputError, match=r"runs\.parquet=.*: must be a valid table"):
            check_table(a_table("runs", policy=values), "runs")


def test_python_values_of_several_kinds_are_refused() -> None:
    for values in ([1, "a"], [{}, []], [object()], ["\ud800"], [10**400]):
        with pytest.raises(InputError, match="runs column pucks="):
            arrow_table({"pucks": values}, "runs")
    assert arrow_table({"q": [1.0, math.nan]}, "x")["q"].to_pylist() == [1.0, None]


def test_damaged_files_and_other_kinds_of_files_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "runs.parquet"
    pq.write_table(a_table("runs", 500), path)
    whole = path.read_bytes()
    read_table(path, "runs")
    for content in (b"", b"PAR1", whole[:-20], whole[:2000], b"\0" * 4 + whole[4:-9] + b"\xff" * 9):
        path.write_bytes(content)
        with pytest.raises(InputError, match=r"runs\.parquet': must be a readable Parquet file"):
            read_table(path, "runs")
    path.unlink()
    os.mkfifo(path)
    with pytest.raises(InputError, match="must be a regular file"):
        read_table(path, "runs")


def test_each_damaged_byte_is_refused_or_harmless(tmp_path: Path) -> None:
    path = tmp_path / "robots.parquet"
    pq.write_table(a_table("robots"), path)
    whole = path.read_bytes()
    for position in range(0, len(whole), 41):
        path.write_bytes(whole[:position] + bytes([whole[position] ^ 0xFF]) + whole[position + 1 :])
        with suppress(InputError):
            read_table(path, "robots")


def test_a_table_that_needs_more_than_the_memory_is_refused_before_it_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "runs.parquet"
    pq.write_table(a_table("runs", 100_000), path)
    assert path.stat().st_size < 1_000_000
    monkeypatch.setattr(os, "sysconf", lambda _name: 1000)
    monkeypatch.setattr(pq, "read_table", lambda *_, **__: pytest.fail("was read"))
    for runs in (None, ["a"]):
        with pytest.raises(InputError, match=r"runs\.parquet': needs .* GB of memory"):
            read_table(path, "runs", runs=runs)


def test_a_file_in_a_directory_that_is_not_utf_8_is_read(tmp_path: Path) -> None:
    directory = Path(os.fsdecode(os.fsencode(tmp_path) + b"/caf\xe9 x=1"))
    directory.mkdir()
    with (directory / "runs.parquet").open("wb") as file:
        pq.write_table(a_table("runs"), file)
    assert "x" not in read_table(directory / "runs.parquet", "runs").column_names
    assert len(read_table(directory / "runs.parquet", "runs", ["run", "seed"], ["a"])) == 2
