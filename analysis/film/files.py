"""Films and contact sheets: pictures as an MP4, a GIF or a PNG, written whole or not at all."""

import math
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Final

from PIL import Image

from kswarms.agents.common.atomic_files import whole
from kswarms.agents.common.errors import InputError
from kswarms.analysis.film.painter import palette

FORMATS: Final = (".mp4", ".gif")
_MOST_COLUMNS: Final = 4
_GAP: Final = 0.02
"""Between the pictures of a sheet, as a part of a picture's width."""
_DOTS_PER_INCH: Final = 300


def write_film(path: Path, pictures: Iterable[Image.Image], fps: int) -> int:
    """Write pictures as a film.

    Parameters
    ----------
    path : Path
        Its suffix says the format, one of `FORMATS`.
    pictures : iterable of Image
        At least one; all of the same size, even in both directions.
    fps : int
        Pictures a second.

    Returns
    -------
    int
        Pictures written.

    Raises
    ------
    InputError
        If the format is unknown, what writes it is not installed, or the path cannot be written; then
        nothing is.
    """
    check_film(path)
    with _written(path) as part:
        return (_write_mp4 if path.suffix == ".mp4" else _write_gif)(part, iter(pictures), fps)


def check_film(path: Path) -> None:
    """Make sure that a film can be written, before it is drawn.

    Raises
    ------
    InputError
        As `write_film`.
    """
    if path.suffix not in FORMATS:
        raise InputError("out", str(path), f"must end with {' or '.join(FORMATS)}")
    if path.suffix == ".mp4" and find_spec("imageio_ffmpeg") is None:
        raise InputError("out", str(path), "needs pip install 'kswarms[explore]'; a .gif does not")


def write_sheet(path: Path, pictures: Sequence[Image.Image]) -> None:
    """Write pictures side by side as one PNG.

    Parameters
    ----------
    path : Path
        Where to.
    pictures : sequence of Image
        At least one; all of the same size.

    Raises
    ------
    InputError
        If the path cannot be written; then nothing is.
    """
    width, height = pictures[0].size
    columns = min(_MOST_COLUMNS, math.ceil(math.sqrt(len(pictures))))
    rows = math.ceil(len(pictures) / columns)
    gap = round(_GAP * width)
    sheet = Image.new("RGB", (columns * (width + gap) - gap, rows * (height + gap) - gap), "white")
    for k, picture in enumerate(pictures):
        row, column = divmod(k, columns)
        sheet.paste(picture, (column * (width + gap), row * (height + gap)))
    with _written(path) as part:
        sheet.save(part, dpi=(_DOTS_PER_INCH, _DOTS_PER_INCH))


def _write_mp4(path: Path, pictures: Iterator[Image.Image], fps: int) -> int:
    import imageio_ffmpeg

    first = next(pictures)
    sink = imageio_ffmpeg.write_frames(
        str(path),
        first.size,
        fps=fps,
        macro_block_size=2,
        ffmpeg_log_level="error",
    )
    sink.send(None)
    try:
        count = 1
        sink.send(first.tobytes())
        for picture in pictures:
            sink.send(picture.tobytes())
            count += 1
    finally:
        sink.close()
    return count


def _write_gif(path: Path, pictures: Iterator[Image.Image], fps: int) -> int:
    colours = palette()
    count = 0

    def reduced() -> Iterator[Image.Image]:
        nonlocal count
        for picture in pictures:
            count += 1
            yield picture.quantize(palette=colours, dither=Image.Dither.NONE)

    frames = reduced()
    # A GIF counts in hundredths of a second.
    next(frames).save(path, save_all=True, append_images=frames, duration=10 * round(100 / fps), loop=0)
    return count


@contextmanager
def _written(path: Path) -> Iterator[Path]:
    """Give a file to write to in place of `path`, as `kswarms.agents.common.atomic_files.whole` does."""
    try:
        with whole(path) as part:
            yield part
    except OSError as error:
        raise InputError("out", str(path), "must be a place that can be written") from error
