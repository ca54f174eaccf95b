"""Tables on the terminal: those of results with lines around their cells, others as columns of words."""

from collections.abc import Iterable, Sequence
from typing import Final

import typer

# As wide as the table is, for rich would break the cells in a pipe's 80 columns.
_ANY_WIDTH: Final = 1000


def print_table(title: str, header: Sequence[str], rows: Iterable[Sequence[str]], caption: str = "") -> None:
    """Print a table of results below its title, its caption below it."""
    from rich.console import Console
    from rich.table import Table

    table = Table()
    for heading in header:
        table.add_column(heading, justify="right")
    for cells in rows:
        table.add_row(*cells)
    below = [caption] if caption else []
    Console(width=_ANY_WIDTH, highlight=False).print(f"\n{title}", table, *below, sep="\n")


def print_columns(rows: Sequence[Sequence[str]], left: Iterable[int]) -> None:
    """Print rows of as many cells each, the columns of these numbers to the left, the others to the right."""
    lefts = set(left)
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        cells = (
            cell.ljust(width) if k in lefts else cell.rjust(width)
            for k, (cell, width) in enumerate(zip(row, widths, strict=True))
        )
        typer.echo("  ".join(cells).rstrip())
