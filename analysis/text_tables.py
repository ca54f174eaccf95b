"""Text tables: tables of strings for terminals, Markdown and HTML.

To export the numbers of a table, write the data frame it was made from: `frame.to_csv(index=False)`.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import isnan
from typing import Final

from jinja2 import Environment, PackageLoader, StrictUndefined

from kswarms.agents.common.quoting import for_markdown

MISSING: Final = "–"
"""Text of a missing number."""

TEMPLATES: Final = Environment(
    loader=PackageLoader("kswarms.analysis", "templates"),
    autoescape=True,
    undefined=StrictUndefined,
    trim_blocks=True,
    lstrip_blocks=True,
)

# A number or `MISSING`; an interval or a unit may follow.
_NUMBER: Final = re.compile(r"^(–$|[+−-]?[\d.]+(\s|$))")


@dataclass(frozen=True)
class TextTable:
    """A table of strings; the first cell of each row is its name.

    `header` has the column names, which may contain line breaks. `caption` is the text below the table:
    units, seeds, intervals. `marks` maps the text of a cell to its HTML class.
    """

    header: list[str]
    rows: list[list[str]]
    caption: str
    marks: Mapping[str, str] = field(default_factory=dict)

    def classes(self) -> list[str]:
        """Return the HTML class of each column: ``number`` if all its cells are numbers, else ``""``."""
        if not self.rows:
            return [""] * len(self.header)
        columns = zip(*self.rows, strict=True)
        return ["number" if all(map(_NUMBER.match, column)) else "" for column in columns]

    def to_markdown(self) -> str:
        """Return the table in Markdown; numbers are aligned right, and the caption is a paragraph below."""
        rule = ["--:" if number else "---" for number in self.classes()]
        lines = [_markdown_row(self.header), f"|{'|'.join(rule)}|", *map(_markdown_row, self.rows)]
        if self.caption:
            lines += ["", for_markdown(self.caption)]
        return "\n".join(lines) + "\n"

    def to_html(self) -> str:
        """Return the table in HTML, with its caption and with headings of columns and rows."""
        return TEMPLATES.get_template("table.html").render(content=self)


def number(value: float, form: str) -> str:
    """Format a number with a format such as ``.1f``; NaN becomes `MISSING`."""
    return MISSING if isnan(value) else format(value, form)


def with_interval(value: float, low: float, high: float, form: str) -> str:
    """Format a number and its interval; an interval of NaN is omitted."""
    interval = "" if isnan(value) or isnan(low) else f" ({low:{form}} … {high:{form}})"
    return number(value, form) + interval


def span(low: int, high: int) -> str:
    """Format a range of integers: ``3 to 20``, or ``20`` if both ends are equal."""
    return str(low) if low == high else f"{low} to {high}"


def _markdown_row(cells: Sequence[str]) -> str:
    return f"| {' | '.join(map(for_markdown, cells))} |"
