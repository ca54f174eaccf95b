"""Table of the verdicts on findings."""

import math
from collections.abc import Mapping, Sequence
from typing import Any, Final

import pandas as pd

from kswarms.analysis.findings.verdicts import FAILS, HOLDS, NO_DATA, UNDECIDED, Verdict
from kswarms.analysis.text_tables import MISSING, TextTable, number

_UNITS: Final = {"percentage points": "points", "% of robots": "%", "rank correlation with N": "(ρ)"}
"""Short names of units."""
_HEADERS: Final = {
    "finding": "id",
    "statement": "statement",
    "verdict": "verdict",
    "number": "number (95 % interval)",
    "seeds": "seeds",
}
"""Heading of each column."""


def verdict_rows(verdicts: Sequence[Verdict]) -> pd.DataFrame:
    """Return verdicts as a data frame: a row for each, a column for each attribute of `Verdict`."""
    return pd.DataFrame([vars(verdict) for verdict in verdicts])


def count_verdicts(frame: pd.DataFrame) -> str:
    """Return the number of findings per verdict as a sentence without full stop."""
    count = frame["verdict"].tolist().count
    numbers = f"{count(HOLDS)} hold, {count(FAILS)} fail and {count(UNDECIDED)} are undecided"
    absent = f"; {count(NO_DATA)} have no data" if count(NO_DATA) else ""
    return f"Of {len(frame)} statements, {numbers}{absent}"


def findings_table(frame: pd.DataFrame, columns: Sequence[str] = tuple(_HEADERS)) -> TextTable:
    """Return `verdict_rows` as a text table: `columns` of id, statement, verdict, number and seeds."""
    cells = frame.assign(number=[_effect(row) for row in frame.to_dict("records")])
    rows = cells[list(columns)].astype(str).to_numpy().tolist()
    return TextTable([_HEADERS[column] for column in columns], rows, "")


def findings_markdown(frame: pd.DataFrame, columns: Sequence[str] = tuple(_HEADERS)) -> str:
    """Return `findings_table` in Markdown, with verdicts other than ``holds`` in bold."""
    text = findings_table(frame, columns).to_markdown().rstrip()
    for verdict in sorted(set(frame["verdict"]) - {HOLDS}):
        text = text.replace(f"| {verdict} |", f"| **{verdict}** |")
    return text


def _effect(row: Mapping[Any, Any]) -> str:
    numbers = [math.nan if row[name] is None else row[name] for name in ("effect", "low", "high")]
    if math.isnan(numbers[0]):
        return MISSING
    form = ".2f" if abs(numbers[0]) < 1.2 else ".1f"
    effect, low, high = (_signed(value, form) for value in numbers)
    bounds = "" if low == high == MISSING else f" ({low} … {high})"
    return f"{effect} {_UNITS.get(row['unit'], row['unit'])}{bounds}"


def _signed(value: float, form: str) -> str:
    """Format a number with a minus sign (−), and zero without a sign."""
    text = number(value, form)
    return text.lstrip("-") if text != MISSING and float(text) == 0 else text.replace("-", "−")
