"""Figures as PNG and SVG: the same bytes for the same figure, in files written whole or not at all."""

import os
from io import BytesIO
from pathlib import Path
from typing import Final, NamedTuple

import matplotlib as mpl
from matplotlib.figure import Figure

from agents.errors import InputError

DOTS_PER_INCH = 150
FORMATS: Final = ("png", "svg")


class Picture(NamedTuple):
    """A drawn figure.

    Attributes
    ----------
    kind : {'png', 'svg'}
        Format of the bytes.
    content : bytes
        The file.
    width, height : int
        Size for a page (CSS pixels, 96 an inch).
    """

    kind: str
    content: bytes
    width: int
    height: int


def encoded(figure: Figure, kind: str, dots_per_inch: float = DOTS_PER_INCH) -> bytes:
    """Return a figure as the bytes of a file.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        What is drawn.
    kind : {'png', 'svg'}
        Format.
    dots_per_inch : float
        Of PNG.

    Raises
    ------
    InputError
        If there is no such format.
    """
    if kind not in FORMATS:
        raise InputError("format", kind, f"must be one of {', '.join(FORMATS)}")
    content = BytesIO()
    # Without these an SVG has the date in it and identifiers at random.
    with mpl.rc_context({"svg.hashsalt": "kswarms"}):
        metadata = {"Date": None} if kind == "svg" else None
        figure.savefig(content, format=kind, dpi=dots_per_inch, metadata=metadata)
    return content.getvalue()


def smallest(figure: Figure, dots_per_inch: float = 110) -> Picture:
    """Draw a figure for a page: as PNG or SVG, whichever is smaller.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        What is drawn.
    dots_per_inch : float
        Of PNG.
    """
    contents = {}
    for kind in FORMATS:
        contents[kind] = encoded(figure, kind, dots_per_inch)
        figure.set_layout_engine("none")  # laid out once is enough
    kind = min(contents, key=lambda each: len(contents[each]))
    width, height = (round(96 * inches) for inches in figure.get_size_inches())
    return Picture(kind, contents[kind], width, height)


def save(figure: Figure, path: Path) -> None:
    """Write a figure to a file, PNG or SVG by the file's suffix.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        What is drawn.
    path : Path
        The file; its folder is made if it is missing.

    Raises
    ------
    InputError
        If the suffix is of another format or the file cannot be written; then it is as it was.
    """
    content = encoded(figure, path.suffix.removeprefix(".").lower())
    try:
        path.parent.mkdir(exist_ok=True)
        write_whole(path, content)
    except OSError as error:
        raise InputError("figures", str(path), "must be a place that can be written") from error


def write_whole(path: Path, content: bytes) -> None:
    """Write a file whole or not at all.

    Raises
    ------
    OSError
        If it cannot be written; then it is as it was.
    """
    part = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        part.write_bytes(content)
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)
