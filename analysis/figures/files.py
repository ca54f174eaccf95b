"""Figures as PNG and SVG files; the same figure always has the same bytes."""

import warnings
from contextlib import suppress
from io import BytesIO
from pathlib import Path
from typing import Final, NamedTuple

from matplotlib.figure import Figure
from PIL import Image

from kswarms.agents.common.atomic_files import output_path
from kswarms.agents.common.errors import InputError, require_type
from kswarms.agents.common.input_files import to_path
from kswarms.analysis.figures.style import default_settings

DOTS_PER_INCH: Final = 150
_SMALL_DOTS_PER_INCH: Final = 110
_SMALL_COLOURS: Final = 48
"""Number of colours of a small file."""
FORMATS: Final = ("png", "svg")


class EncodedFigure(NamedTuple):
    """A figure in each of `FORMATS`; its size is in CSS pixels, 96 per inch."""

    files: dict[str, bytes]
    width: int
    height: int

    @property
    def smallest(self) -> str:
        """The format with the fewest bytes."""
        return min(self.files, key=lambda kind: len(self.files[kind]))


def encode(figure: Figure, kind: str, dots_per_inch: float = DOTS_PER_INCH) -> bytes:
    """Encode a figure in one of `FORMATS`; `InputError` for another format."""
    if kind not in FORMATS:
        raise InputError("format", kind, f"must be one of {', '.join(FORMATS)}")
    content = BytesIO()
    # By default an SVG contains the date and random identifiers.
    with default_settings({"svg.hashsalt": "kswarms"}), warnings.catch_warnings():
        # The font may lack the script of a user's title; the figure then shows boxes.
        warnings.filterwarnings("ignore", "Glyph .* missing from font")
        metadata = {"Date": None} if kind == "svg" else None
        figure.savefig(content, format=kind, dpi=dots_per_inch, metadata=metadata)
    return content.getvalue()


def encode_all(figure: Figure) -> EncodedFigure:
    """Encode a figure in all formats. The layout of the figure becomes fixed."""
    files = {}
    for kind in FORMATS:
        files[kind] = encode(figure, kind)
        figure.set_layout_engine("none")  # one layout serves all formats
    width, height = (round(96 * inches) for inches in figure.get_size_inches())
    return EncodedFigure(files, width, height)


def encode_small(figure: Figure) -> bytes:
    """Encode a figure as a PNG file with a palette and fewer dots, which has about a third of the bytes."""
    with Image.open(BytesIO(encode(figure, "png", _SMALL_DOTS_PER_INCH))) as image:
        small = image.convert("RGB").quantize(_SMALL_COLOURS, dither=Image.Dither.NONE)
    content = BytesIO()
    small.save(content, format="PNG", optimize=True)
    return content.getvalue()


def save_figure(figure: Figure, path: str | Path) -> None:
    """Write a figure to a PNG or SVG file.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
    path : Path or str
        The suffix is the format. Missing folders are created.

    Raises
    ------
    InputError
        The format is unknown, or the path is not writable.
    OSError
        Writing fails; an existing file is unchanged.
    """
    require_type("figure", figure, Figure, "must be a matplotlib figure")
    path = to_path("path", path)
    write_file(path, encode(figure, path.suffix.removeprefix(".").lower()), "figures")


def write_file(path: Path, content: bytes, field: str) -> None:
    """Write a file atomically and create missing folders; `InputError` about `field` if that is refused."""
    with suppress(OSError):  # `output_path` reports it
        path.parent.mkdir(parents=True, exist_ok=True)
    with output_path(path, field) as temporary:
        temporary.write_bytes(content)
