"""Text tables in Markdown and HTML."""

from kswarms.analysis.text_tables import TextTable

TABLE = TextTable(
    ["N", "S1\npucks", "fits", "a|b"],
    [["6", "1.0 (0.5 … 1.5)", "yes", "<b>"], ["10", "–", "no", "x|y"]],
    "two\nlines & more",
    {"yes": "holds"},
)


def test_a_table_is_converted_to_markdown() -> None:
    assert TABLE.to_markdown().splitlines() == [
        "| N | S1 pucks | fits | a\\|b |",
        "|--:|--:|---|---|",
        "| 6 | 1.0 (0.5 … 1.5) | yes | \\<b> |",
        "| 10 | – | no | x\\|y |",
        "",
        "two lines & more",
    ]


def test_html_has_headings_of_columns_and_rows_and_escapes_all_text() -> None:
    lines = TABLE.to_html().splitlines()
    assert lines[:3] == [
        "<table>",
        "<caption><span>two<br>lines &amp; more</span></caption>",
        '<thead><tr><th scope="col" class="number">N</th><th scope="col" class="number">S1<br>pucks</th>'
        '<th scope="col">fits</th><th scope="col">a|b</th></tr></thead>',
    ]
    assert lines[4] == (
        '<tr><th scope="row" class="number">6</th><td class="number">1.0 (0.5 … 1.5)</td>'
        '<td class="holds">yes</td><td>&lt;b&gt;</td></tr>'
    )
    assert "<td>no</td>" in lines[5]


def test_a_table_without_rows_or_caption() -> None:
    empty = TextTable(["a", "b"], [], "")
    assert empty.to_markdown() == "| a | b |\n|---|---|\n"
    assert "<caption>" not in empty.to_html()


def test_words_and_dates_are_not_numbers() -> None:
    rows = [["-1.5", "+3 %", "6.1a-alike", "5 of 6"], ["−2", "–", "6.1b", "7 of 8"]]
    assert TextTable(list("abcd"), rows, "").classes() == ["number", "number", "", "number"]
