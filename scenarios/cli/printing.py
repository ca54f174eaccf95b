"""Tables and durations on the terminal."""

from collections.abc import Iterable, Sequence
from typing import Final

import typer

from kswarms.agents.common.quoting import for_terminal

_ANY_WIDTH: Final = 1000
"""Width of the console (characters). In a pipe, rich would wrap cells at 80 columns."""


def print_line(text: str, err: bool = False) -> None:
    """Print a text as one line, on standard error if `err`; control characters in names are escaped."""
    typer.echo(for_terminal(text), err=err)


def print_lines(text: str, err: bool = False) -> None:
    """Print a text of several lines as `print_line` prints each of them."""
    typer.echo(_quote_lines(text), err=err)


def warn(message: str) -> None:
    """Print a message on standard error."""
    print_line(f"kswarms: {message}", err=True)


def print_table(title: str, header: Sequence[str], rows: Iterable[Sequence[str]], caption: str = "") -> None:
    """Print a table with lines around its cells, its title above and its caption below."""
    from rich.console import Console
    from rich.table import Table

    table = Table()
    for heading in header:
        table.add_column(_quote_lines(heading), justify="right")
    for cells in rows:
        table.add_row(*map(for_terminal, cells))
    below = [_quote_lines(caption)] if caption else []
    # Without markup, "[red]" in a name is text.
    console = Console(width=_ANY_WIDTH, highlight=False, markup=False, emoji=False)
    console.print(f"\n{for_terminal(title)}", table, *below, sep="\n")


def _quote_lines(text: str) -> str:
    return "\n".join(map(for_terminal, text.split("\n")))


def print_columns(rows: Sequence[Sequence[str]], left: Iterable[int]) -> None:
    """Print rows of equal length in columns; the columns in `left` are left-aligned, others right-aligned."""
    lefts = set(left)
    rows = [[for_terminal(cell) for cell in row] for row in rows]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        cells = (
            cell.ljust(width) if k in lefts else cell.rjust(width)
            for k, (cell, width) in enumerate(zip(row, widths, strict=True))
        )
        typer.echo("  ".join(cells).rstrip())


def format_duration(seconds: float) -> str:
    """Return a duration in seconds, minutes or hours.

    Examples
    --------
    >>> format_duration(0.24), format_duration(75), format_duration(8337)
    ('0.2 s', '1:15 min', '2:19 h')
    """
    if seconds < 59.95:
        return f"{seconds:.1f} s"
    if seconds < 3599.5:
        return "{}:{:02} min".format(*divmod(round(seconds), 60))
    return "{}:{:02} h".format(*divmod(round(seconds / 60), 60))


def format_size(size: float) -> str:
    """Return a number of bytes in kB, MB, GB or TB.

    Examples
    --------
    >>> format_size(2_400), format_size(7_340_000), format_size(81e9), format_size(5e13)
    ('2.4 kB', '7.3 MB', '81.0 GB', '50.0 TB')
    """
    power = next((k for k, unit in enumerate("kMG", 1) if size < 0.99995 * 1000 ** (k + 1)), 4)
    return f"{size / 1000**power:,.1f} {'kMGT'[power - 1]}B"
