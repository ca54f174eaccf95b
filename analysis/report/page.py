"""Elements of the report page, and their files.

A report consists of chapters; a chapter consists of parts with text, figures and tables. The page is one HTML
file that needs no network: images and downloads are data URIs, and there is no script.
"""

import base64
import csv
import re
from collections.abc import Container, Sequence
from dataclasses import dataclass, field
from itertools import chain, count
from pathlib import Path
from typing import Final
from urllib.parse import quote

import pandas as pd
from matplotlib.figure import Figure

from kswarms.agents.common.atomic_files import check_directory
from kswarms.agents.common.errors import InputError
from kswarms.agents.common.quoting import for_cell, for_file_name
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
        cells = self.frame.map(lambda value: for_cell(value) if isinstance(value, str) else value)
        # Quotation marks keep a text with a semicolon in one cell: some spreadsheets separate cells there.
        texts = {"csv": cells.to_csv(index=False, quoting=csv.QUOTE_NONNUMERIC)}
        texts |= {"md": self.table.to_markdown(), "html": self.table.to_html()}
        return {f"{self.name}.{kind}": _encode(text) for kind, text in texts.items()}

    @property
    def downloads(self) -> dict[str, str]:
        """Data URIs of the CSV and Markdown files, by file name."""
        kinds = {f"{self.name}.csv": "text/csv", f"{self.name}.md": "text/markdown"}
        return {name: f"data:{kind};charset=utf-8,{quote(self.files[name])}" for name, kind in kinds.items()}


@dataclass
class Part:
    """A section of a chapter: paragraphs, figures, tables and preformatted text, in this order."""

    id: str
    """Anchor in the page; it becomes a valid one."""
    title: str
    text: list[str] = field(default_factory=list)
    figures: list[PageFigure] = field(default_factory=list)
    tables: list[PageTable] = field(default_factory=list)
    preformatted: str = ""

    def __post_init__(self) -> None:
        self.id = re.sub(r"\s", "-", for_file_name(self.id))

    @property
    def files(self) -> dict[str, bytes]:
        """Contents of the files of all figures and tables, by file name."""
        items: list[PageFigure | PageTable] = [*self.figures, *self.tables]
        return {name: content for item in items for name, content in item.files.items()}

    def add_figure(self, name: str, figure: Figure, alt: str, caption: str) -> None:
        """Encode a figure and add it; its files are named after `name`."""
        self.figures.append(PageFigure(for_file_name(name), encode_all(figure), alt, caption))

    def add_table(self, name: str, title: str, table: TextTable, frame: pd.DataFrame) -> None:
        """Add a table; its files are named after `name`."""
        self.tables.append(PageTable(for_file_name(name), title, table, frame))


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
        write_file(path, _encode(self.to_html()), "out")

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
        contents: dict[str, bytes] = {}
        for part in parts:
            for name, content in part.files.items():
                stem, _, kind = name.rpartition(".")
                contents[unused_name(stem, contents, f".{kind}")] = content
        for name, content in {_MARK: b"Files of kswarms\n", **contents}.items():
            write_file(folder / name, content, "files")
        return len(contents)


def check_folder(folder: Path) -> None:
    """Raise an `InputError` unless a folder for files of reports is new, empty or has files of a report."""
    check_directory(folder, "files", [_MARK])


def unused_name(name: str, used: Container[str], suffix: str = "") -> str:
    """Return a name with its suffix; a number is added if it is used."""
    numbered = (f"{name}{number}{suffix}" for number in chain([""], (f"-{k}" for k in count(2))))
    return next(each for each in numbered if each not in used)


def _encode(text: str) -> bytes:
    """Encode as UTF-8; lone surrogates, which stand for other bytes in paths, become escapes."""
    return text.encode("utf-8", "backslashreplace")
