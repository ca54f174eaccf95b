"""Elements of the report page, and their files.

A report consists of chapters; a chapter consists of parts with text, figures and tables. The page is one HTML
file that needs no network: images and downloads are data URIs, and there is no script.
"""

import base64
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final
from urllib.parse import quote

import pandas as pd
from matplotlib.figure import Figure

from kswarms.agents.common.atomic_files import check_directory
from kswarms.agents.common.errors import InputError
from kswarms.analysis.figures.files import EncodedFigure, encode_all, write_file
from kswarms.analysis.text_tables import TEMPLATES, TextTable

_MARK: Final = ".kswarms-report"
"""Hidden file that marks a folder of files of a report."""
_MIME: Final = {"png": "image/png", "svg": "image/svg+xml"}


@dataclass(frozen=True)
class PageFigure:
    """A figure on the page."""

    name: str
    """Name of its files, without suffix."""
    image: EncodedFigure
    alt: str
    """Alternative text for readers who cannot see the figure."""
    caption: str

    @property
    def uri(self) -> str:
        """Data URI of the figure in its smallest format."""
        kind = self.image.smallest
        return f"data:{_MIME[kind]};base64,{base64.b64encode(self.image.files[kind]).decode()}"

    @property
    def files(self) -> dict[str, bytes]:
        """Contents of the PNG and SVG files, by file name."""
        return {f"{self.name}.{kind}": content for kind, content in self.image.files.items()}


@dataclass(frozen=True)
class PageTable:
    """A table on the page, with downloads of its numbers (CSV) and its text (Markdown)."""

    name: str
    """Name of its files, without suffix."""
    title: str
    table: TextTable
    """The table as text."""
    frame: pd.DataFrame
    """The numbers in full precision."""

    @property
    def files(self) -> dict[str, bytes]:
        """Contents of the CSV, Markdown and HTML files, by file name."""
        csv, markdown, html = self.frame.to_csv(index=False), self.table.to_markdown(), self.table.to_html()
        texts = {"csv": csv, "md": markdown, "html": html}
        return {f"{self.name}.{kind}": text.encode() for kind, text in texts.items()}

    @property
    def downloads(self) -> dict[str, str]:
        """Data URIs of the CSV and Markdown files, by file name."""
        kinds = {f"{self.name}.csv": "text/csv", f"{self.name}.md": "text/markdown"}
        return {name: f"data:{kind};charset=utf-8,{quote(self.files[name])}" for name, kind in kinds.items()}


@dataclass
class Part:
    """A section of a chapter: paragraphs, figures, tables and preformatted text, in this order."""

    id: str
    """Anchor in the page."""
    title: str
    text: list[str] = field(default_factory=list)
    figures: list[PageFigure] = field(default_factory=list)
    tables: list[PageTable] = field(default_factory=list)
    preformatted: str = ""

    @property
    def files(self) -> dict[str, bytes]:
        """Contents of the files of all figures and tables, by file name."""
        items: list[PageFigure | PageTable] = [*self.figures, *self.tables]
        return {name: content for item in items for name, content in item.files.items()}

    def add_figure(self, name: str, figure: Figure, alt: str, caption: str) -> None:
        """Encode a figure and add it."""
        self.figures.append(PageFigure(name, encode_all(figure), alt, caption))

    def add_table(self, name: str, title: str, table: TextTable, frame: pd.DataFrame) -> None:
        """Add a table."""
        self.tables.append(PageTable(name, title, table, frame))


@dataclass(frozen=True)
class Chapter:
    """A chapter of the report: anchor, title and at least one part."""

    id: str
    title: str
    parts: Sequence[Part]


@dataclass(frozen=True)
class Report:
    """A report: title, paragraphs of a summary, and chapters. The page has a table of contents."""

    title: str
    summary: Sequence[str]
    chapters: Sequence[Chapter]

    def to_html(self) -> str:
        """Return the page as HTML."""
        return TEMPLATES.get_template("report.html").render(report=self)

    def write_page(self, path: Path) -> None:
        """Write the page; `InputError` if `path` is not writable. After an error an old file is unchanged."""
        write_file(path, self.to_html().encode(), "out")

    def write_files(self, folder: Path) -> int:
        """Write figures as PNG and SVG, tables as CSV, Markdown and HTML; return the number of files.

        Files of the same names are replaced. `InputError` as in `check_folder`, or if the folder cannot be
        created.
        """
        check_folder(folder)
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError("files", str(folder), f"must be a directory ({error.strerror})") from error
        parts = [part for chapter in self.chapters for part in chapter.parts]
        contents = {name: content for part in parts for name, content in part.files.items()}
        for name, content in {_MARK: b"Files of kswarms\n", **contents}.items():
            write_file(folder / name, content, "files")
        return len(contents)


def check_folder(folder: Path) -> None:
    """Raise an `InputError` unless a folder for files of reports is new, empty or has files of a report."""
    check_directory(folder, "files", [_MARK])
