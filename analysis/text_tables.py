"""Tables as text: what a reader sees, in a terminal, in Markdown and in HTML.

The numbers themselves are the data frame that a table was printed from: `frame.to_csv(index=False)`.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from math import isnan
from typing import Final

NONE: Final = "–"
"""What stands for a number that is not there."""

# A number, or a mark that stands for one that is not there, with whatever follows: an interval, a unit.
_NUMBER = re.compile(r"^(–$|[+−-]?[\d.]+(\s|$))")


@dataclass(frozen=True)
class PrintedTable:
    """A table ready to be printed.

    Attributes
    ----------
    header : list of str
        Names of the columns; a line break stands between the parts of a long one.
    rows : list of list of str
        As many cells each as there are names. The first cell names the row.
    caption : str
        What stands below: units, seeds, intervals.
    marks : mapping of str to str
        HTML class of cells with a certain text.
    """

    header: list[str]
    rows: list[list[str]]
    caption: str
    marks: Mapping[str, str] = field(default_factory=dict)

    def numeric(self) -> list[bool]:
        """Tell for each column whether all its cells are numbers, which are aligned to the right."""
        columns = [list(column) for column in zip(*self.rows, strict=True)]
        return [all(_NUMBER.match(cell) for cell in column) for column in columns] or [False] * len(
            self.header
        )

    def to_markdown(self) -> str:
        """Return the table in Markdown, its caption in a paragraph below."""
        rule = ["--:" if number else "---" for number in self.numeric()]
        lines = [_line(self.header), f"|{'|'.join(rule)}|", *map(_line, self.rows)]
        caption = " ".join(self.caption.splitlines())
        return "\n".join([*lines, *(["", caption] if caption else [])]) + "\n"

    def to_html(self) -> str:
        """Return the table in HTML, its caption in it, with headings for columns and rows."""
        kinds = ["number" if number else "" for number in self.numeric()]
        heading = "".join(map(_heading, self.header, kinds))
        body = "\n".join(self._row(cells, kinds) for cells in self.rows)
        caption = f"<caption><span>{_html(self.caption)}</span></caption>\n" if self.caption else ""
        return f"<table>\n{caption}<thead><tr>{heading}</tr></thead>\n<tbody>\n{body}\n</tbody>\n</table>\n"

    def _row(self, cells: Sequence[str], kinds: Sequence[str]) -> str:
        first = f'<th scope="row"{_class(kinds[0])}>{_html(cells[0])}</th>'
        rest = (
            f"<td{_class(self.marks.get(cell, kind))}>{_html(cell)}</td>"
            for cell, kind in zip(cells[1:], kinds[1:], strict=True)
        )
        return f"<tr>{first}{''.join(rest)}</tr>"


def number(value: float, form: str) -> str:
    """Return a number in a form as ``.1f``, a dash for NaN."""
    return NONE if isnan(value) else format(value, form)


def with_interval(value: float, low: float, high: float, form: str) -> str:
    """Return a number and the interval that it lies in, which is left out where it is NaN."""
    interval = "" if isnan(value) or isnan(low) else f" ({low:{form}} … {high:{form}})"
    return number(value, form) + interval


def span(few: int, many: int) -> str:
    """Return from how many to how many: ``3 to 20``, or ``20`` where both are the same."""
    return str(few) if few == many else f"{few} to {many}"


def _heading(name: str, kind: str) -> str:
    return f'<th scope="col"{_class(kind)}>{_html(name)}</th>'


def _class(kind: str) -> str:
    return f' class="{kind}"' if kind else ""


def _html(text: str) -> str:
    return escape(text).replace("\n", "<br>")


def _line(cells: Sequence[str]) -> str:
    # A bar would end the cell, a line break the table.
    safe = [cell.replace("|", "\\|").replace("\n", " ") for cell in cells]
    return f"| {' | '.join(safe)} |"
