"""Elements of the report's page, and the files that are written of them.

A report has chapters, chapters have parts, and parts have text, figures and tables. The page is one HTML file
that needs no network: images and downloads are data URIs, and there is no script.
"""

import base64
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final
from urllib.parse import quote

import pandas as pd
from matplotlib.figure import Figure

from kswarms.agents.common.errors import InputError
from kswarms.analysis.figures.files import EncodedFigure, encode_all, write_file
from kswarms.analysis.text_tables import TEMPLATES, TextTable

_MIME: Final = {"png": "image/png", "svg": "image/svg+xml"}


@dataclass(frozen=True)
class PageFigure:
    """A figure on the page.

    Attributes
    ----------
    name : str
        Name of its files, without suffix.
    image : EncodedFigure
        The figure in all formats.
    alt : str
        Alternative text for readers who do not see it.
    caption : str
        Text below it.
    """

    name: str
    image: EncodedFigure
    alt: str
    caption: str

    @property
    def uri(self) -> str:
        """Data URI of the figure in its smallest format."""
        kind = self.image.smallest
        return f"data:{_MIME[kind]};base64,{base64.b64encode(self.image.files[kind]).decode()}"

    @property
    def files(self) -> dict[str, bytes]:
        """Content of the figure's files by name: PNG and SVG."""
        return {f"{self.name}.{kind}": content for kind, content in self.image.files.items()}


@dataclass(frozen=True)
class PageTable:
    """A table on the page, with downloads of its numbers (CSV) and its text (Markdown).

    Attributes
    ----------
    name : str
        Name of its files, without suffix.
    title : str
        Title.
    table : TextTable
        The table as shown.
    frame : pandas.DataFrame
        The numbers.
    """

    name: str
    title: str
    table: TextTable
    frame: pd.DataFrame

    @property
    def files(self) -> dict[str, bytes]:
        """Content of the table's files by name: CSV, Markdown and HTML."""
        texts = {
            "csv": self.frame.to_csv(index=False),
            "md": self.table.to_markdown(),
            "html": self.table.to_html(),
        }
        return {f"{self.name}.{kind}": text.encode() for kind, text in texts.items()}

    @property
    def downloads(self) -> dict[str, str]:
        """Data URIs of CSV and Markdown by file name."""
        kinds = {f"{self.name}.csv": "text/csv", f"{self.name}.md": "text/markdown"}
        return {name: f"data:{kind};charset=utf-8,{quote(self.files[name])}" for name, kind in kinds.items()}


@dataclass
class Part:
    """A section of a chapter.

    Attributes
    ----------
    id : str
        Anchor.
    title : str
        Heading.
    text : list of str
        Paragraphs.
    figures : list of PageFigure
        Figures, side by side if the page is wide enough.
    tables : list of PageTable
        Tables, one below the other.
    source : str
        Preformatted text; empty for none.
    """

    id: str
    title: str
    text: list[str] = field(default_factory=list)
    figures: list[PageFigure] = field(default_factory=list)
    tables: list[PageTable] = field(default_factory=list)
    source: str = ""

    def add_figure(self, name: str, figure: Figure, alt: str, caption: str) -> None:
        """Add a figure; see `PageFigure`."""
        self.figures.append(PageFigure(name, encode_all(figure), alt, caption))

    def add_table(self, name: str, title: str, table: TextTable, frame: pd.DataFrame) -> None:
        """Add a table; see `PageTable`."""
        self.tables.append(PageTable(name, title, table, frame))


@dataclass(frozen=True)
class Chapter:
    """A chapter of the report: anchor, title and at least one part."""

    id: str
    title: str
    parts: Sequence[Part]


@dataclass(frozen=True)
class Report:
    """A report.

    Attributes
    ----------
    title : str
        Heading of the page.
    summary : sequence of str
        Paragraphs below the heading.
    chapters : sequence of Chapter
        Chapters; the table of contents lists them and their parts.
    """

    title: str
    summary: Sequence[str]
    chapters: Sequence[Chapter]

    def to_html(self) -> str:
        """Return the page."""
        return TEMPLATES.get_template("report.html").render(report=self)

    def write_page(self, path: Path) -> None:
        """Write the page to a file.

        Raises
        ------
        InputError
            The file cannot be written; then an existing file is unchanged.
        """
        write_file(path, self.to_html().encode(), "out")

    def write_files(self, folder: Path) -> int:
        """Write figures as PNG and SVG, tables as CSV, Markdown and HTML; return the number of files.

        Raises
        ------
        InputError
            The folder cannot be created, or a file cannot be written.
        """
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError("files", str(folder), f"must be a folder ({error.strerror})") from error
        contents: dict[str, bytes] = {}
        for chapter in self.chapters:
            for part in chapter.parts:
                items: list[PageFigure | PageTable] = [*part.figures, *part.tables]
                for item in items:
                    contents |= item.files
        for name, content in contents.items():
            write_file(folder / name, content, "files")
        return len(contents)
