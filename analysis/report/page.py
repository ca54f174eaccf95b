"""What a page of the report is made of, and the one file that it becomes.

Chapters hold parts, parts hold text, pictures and tables. Everything is in the file: pictures and downloads
are data URIs, there is no script and no address of another machine.
"""

import base64
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final
from urllib.parse import quote

import pandas as pd
from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape
from markupsafe import Markup
from matplotlib.figure import Figure

from agents.errors import InputError
from analysis.pictures import Picture, smallest, write_whole
from analysis.printed import PrintedTable

_MIME: Final = {"png": "image/png", "svg": "image/svg+xml"}


@dataclass(frozen=True)
class Shown:
    """A picture with what it shows in words, for those who do not see it, and a caption for all."""

    picture: Picture
    alt: str
    caption: str

    @property
    def uri(self) -> str:
        """The picture as a data URI."""
        return f"data:{_MIME[self.picture.kind]};base64,{base64.b64encode(self.picture.content).decode()}"


@dataclass(frozen=True)
class Tabled:
    """A table with its numbers, which the page offers as CSV, and its text, which it offers as Markdown.

    Attributes
    ----------
    name : str
        Of the files, without suffix.
    title : str
        What it shows.
    printed : PrintedTable
        What is on the page.
    frame : pandas.DataFrame
        The numbers.
    """

    name: str
    title: str
    printed: PrintedTable
    frame: pd.DataFrame

    @property
    def html(self) -> Markup:
        """The table for the page; its text is escaped."""
        return Markup(self.printed.to_html())

    @property
    def downloads(self) -> dict[str, str]:
        """Data URIs by the name of the file that each becomes."""
        files = {
            f"{self.name}.csv": ("text/csv", self.frame.to_csv(index=False)),
            f"{self.name}.md": ("text/markdown", self.printed.to_markdown()),
        }
        return {name: f"data:{kind};charset=utf-8,{quote(text)}" for name, (kind, text) in files.items()}


@dataclass
class Part:
    """A heading with what stands below it.

    Attributes
    ----------
    id : str
        Its anchor.
    title : str
        Its heading.
    text : list of str
        Paragraphs.
    pictures : list of Shown
        Side by side where there is room.
    tables : list of Tabled
        One below the other.
    source : str
        Text that keeps its lines, as that of a file; empty for none.
    """

    id: str
    title: str
    text: list[str] = field(default_factory=list)
    pictures: list[Shown] = field(default_factory=list)
    tables: list[Tabled] = field(default_factory=list)
    source: str = ""

    def show(self, figure: Figure, alt: str, caption: str) -> None:
        """Add a figure."""
        self.pictures.append(Shown(smallest(figure), alt, caption))


@dataclass
class Chapter:
    """A chapter of the report: its own text, then its parts."""

    id: str
    title: str
    parts: Sequence[Part]
    text: Sequence[str] = ()


def render(title: str, summary: Sequence[str], chapters: Sequence[Chapter]) -> str:
    """Return the page as HTML.

    Parameters
    ----------
    title : str
        Its heading.
    summary : sequence of str
        Paragraphs below the heading.
    chapters : sequence of Chapter
        What follows the table of contents.
    """
    environment = Environment(
        loader=PackageLoader("analysis.report", "templates"),
        autoescape=select_autoescape(["html"]),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    template = environment.get_template("report.html")
    return template.render(title=title, summary=summary, chapters=chapters)


def write(path: Path, html: str) -> None:
    """Write the page to a file, whole or not at all.

    Raises
    ------
    InputError
        The file cannot be written; then it is as it was.
    """
    try:
        write_whole(path, html.encode())
    except OSError as error:
        raise InputError(
            "out", str(path), f"must be a file that can be written ({error.strerror})"
        ) from error
