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

from kswarms.agents.common.atomic_files import whole
from kswarms.agents.common.errors import InputError
from kswarms.analysis.figures.files import Picture, drawn
from kswarms.analysis.text_tables import PrintedTable

_MIME: Final = {"png": "image/png", "svg": "image/svg+xml"}


@dataclass(frozen=True)
class Shown:
    """A picture on the page.

    Attributes
    ----------
    name : str
        Of its files, without suffix.
    picture : Picture
        What is shown.
    alt : str
        What it shows, in words, for those who do not see it.
    caption : str
        What stands below.
    """

    name: str
    picture: Picture
    alt: str
    caption: str

    @property
    def uri(self) -> str:
        """The picture as a data URI, in the smallest of its formats."""
        kind = self.picture.smallest
        return f"data:{_MIME[kind]};base64,{base64.b64encode(self.picture.files[kind]).decode()}"

    @property
    def files(self) -> dict[str, bytes]:
        """The picture in every format by the name of its file."""
        return {f"{self.name}.{kind}": content for kind, content in self.picture.files.items()}


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
    def files(self) -> dict[str, bytes]:
        """The table as CSV, Markdown and HTML by the name of its file."""
        texts = {
            "csv": self.frame.to_csv(index=False),
            "md": self.printed.to_markdown(),
            "html": self.printed.to_html(),
        }
        return {f"{self.name}.{kind}": text.encode() for kind, text in texts.items()}

    @property
    def downloads(self) -> dict[str, str]:
        """Data URIs of CSV and Markdown by the name of the file that each becomes."""
        kinds = {f"{self.name}.csv": "text/csv", f"{self.name}.md": "text/markdown"}
        return {name: f"data:{kind};charset=utf-8,{quote(self.files[name])}" for name, kind in kinds.items()}


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

    def show(self, name: str, figure: Figure, alt: str, caption: str) -> None:
        """Draw a figure and add it, as in `Shown`."""
        self.pictures.append(Shown(name, drawn(figure), alt, caption))


@dataclass
class Chapter:
    """A chapter of the report: its own text, then its parts."""

    id: str
    title: str
    parts: Sequence[Part]
    text: Sequence[str] = ()


@dataclass(frozen=True)
class Report:
    """All that is reported.

    Attributes
    ----------
    title : str
        Heading of the page.
    summary : sequence of str
        Paragraphs below it.
    chapters : sequence of Chapter
        What follows the table of contents.
    """

    title: str
    summary: Sequence[str]
    chapters: Sequence[Chapter]

    def to_html(self) -> str:
        """Return the page."""
        environment = Environment(
            loader=PackageLoader("kswarms.analysis.report", "templates"),
            autoescape=select_autoescape(["html"]),
            undefined=StrictUndefined,
            trim_blocks=True,
            lstrip_blocks=True,
        )
        return environment.get_template("report.html").render(
            title=self.title, summary=self.summary, chapters=self.chapters
        )

    def write_page(self, path: Path) -> None:
        """Write the page to a file, whole or not at all.

        Raises
        ------
        InputError
            The file cannot be written; then it is as it was.
        """
        _write("out", path, self.to_html().encode())

    def write_files(self, folder: Path) -> int:
        """Write each picture as PNG and SVG, each table as CSV, Markdown and HTML, and return how many files.

        Raises
        ------
        InputError
            The folder cannot be made or a file cannot be written.
        """
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError("files", str(folder), f"must be a folder ({error.strerror})") from error
        items: list[Shown | Tabled] = []
        for chapter in self.chapters:
            for part in chapter.parts:
                items += [*part.pictures, *part.tables]
        contents = {name: content for item in items for name, content in item.files.items()}
        for name, content in contents.items():
            _write("files", folder / name, content)
        return len(contents)


def _write(field: str, path: Path, content: bytes) -> None:
    try:
        with whole(path) as file:
            file.write_bytes(content)
    except OSError as error:
        raise InputError(
            field, str(path), f"must be a place that can be written ({error.strerror})"
        ) from error
