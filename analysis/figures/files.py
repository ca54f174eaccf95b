"""Figures as PNG and SVG: the same bytes for the same figure, in files written whole or not at all."""

import warnings
from io import BytesIO
from pathlib import Path
from typing import Final, NamedTuple

import matplotlib as mpl
from matplotlib.figure import Figure

from kswarms.agents.common.atomic_files import whole
from kswarms.agents.common.errors import InputError

DOTS_PER_INCH = 150
FORMATS: Final = ("png", "svg")


class Picture(NamedTuple):
    """A drawn figure.

    Attributes
    ----------
    files : dict of str to bytes
        The figure in each of `FORMATS`.
    width, height : int
        Size for a page (CSS pixels, 96 an inch).
    """

    files: dict[str, bytes]
    width: int
    height: int

    @property
    def smallest(self) -> str:
        """The format with the fewest bytes."""
        return min(self.files, key=lambda kind: len(self.files[kind]))


def encoded(figure: Figure, kind: str) -> bytes:
    """Return a figure as the bytes of a file.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        What is drawn.
    kind : {'png', 'svg'}
        Format.

    Raises
    ------
    InputError
        If there is no such format.
    """
    if kind not in FORMATS:
        raise InputError("format", kind, f"must be one of {', '.join(FORMATS)}")
    content = BytesIO()
    # Without these an SVG has the date in it and identifiers at random.
    with mpl.rc_context({"svg.hashsalt": "kswarms"}), warnings.catch_warnings():
        # A user's title may be in a script that the font lacks: a box in the picture says so.
        warnings.filterwarnings("ignore", "Glyph .* missing from font")
        metadata = {"Date": None} if kind == "svg" else None
        figure.savefig(content, format=kind, dpi=DOTS_PER_INCH, metadata=metadata)
    return content.getvalue()


def drawn(figure: Figure) -> Picture:
    """Draw a figure in every format.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        What is drawn; its layout is fixed by it.
    """
    files = {}
    for kind in FORMATS:
        files[kind] = encoded(figure, kind)
        figure.set_layout_engine("none")  # laid out once is enough
    width, height = (round(96 * inches) for inches in figure.get_size_inches())
    return Picture(files, width, height)


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
        with whole(path) as file:
            file.write_bytes(content)
    except OSError as error:
        raise InputError("figures", str(path), "must be a place that can be written") from error
