"""The table of verdicts."""

from kswarms.analysis.findings import Verdict
from kswarms.analysis.tables.findings import count_verdicts, findings_markdown, findings_table, verdict_rows

ROWS = verdict_rows(
    [
        Verdict("a", "One is more.", "holds", 0.5, -0.001, 1.25, "pucks", 20),
        Verdict("b", "Two are more.", "fails", -1234.56, -2000.0, None, "percentage points", 8),
        Verdict("c", "It rises.", "undecided", 0.98, None, None, "rank correlation with N", 5),
        Verdict("d", "Nobody played.", "no data"),
    ]
)


def test_numbers_have_their_unit_and_interval() -> None:
    table = findings_table(ROWS)
    assert table.header == ["id", "statement", "verdict", "number (95 % interval)", "seeds"]
    assert [row[3:] for row in table.rows] == [
        ["0.50 pucks (0.00 … 1.25)", "20"],
        ["−1234.6 points (−2000.0 … –)", "8"],
        ["0.98 (ρ)", "5"],
        ["–", "0"],
    ]


def test_columns_can_be_chosen() -> None:
    table = findings_table(ROWS, ("verdict", "statement"))
    assert (table.header, table.rows[0]) == (["verdict", "statement"], ["holds", "One is more."])


def test_in_markdown_verdicts_other_than_holds_are_bold() -> None:
    text = findings_markdown(ROWS)
    for cell in ("| holds |", "| **fails** |", "| **undecided** |", "| **no data** |"):
        assert cell in text


def test_verdicts_are_counted() -> None:
    assert count_verdicts(ROWS) == "Of 4 statements, 1 hold, 1 fail and 1 are undecided; 1 have no data"
    assert count_verdicts(ROWS[:3]) == "Of 3 statements, 1 hold, 1 fail and 1 are undecided"
