"""Films (MP4, GIF) and contact sheets (PNG)."""

import math
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from importlib.util import find_spec
from itertools import chain
from pathlib import Path
from typing import Final

from PIL import Image

from kswarms.agents.common.atomic_files import atomic_path
from kswarms.agents.common.errors import InputError
from kswarms.analysis.film.painter import palette

FORMATS: Final = (".mp4", ".gif")
_MAX_COLUMNS: Final = 4
_GAP: Final = 0.02
"""Gap between the images of a sheet, relative to the width of an image."""
_DOTS_PER_INCH: Final = 300


def check_film(path: Path) -> None:
    """Check that a film can be written in the format of a path.

    Raises
    ------
    InputError
        The format is unknown, or its encoder is not installed.
    """
    if path.suffix not in FORMATS:
        raise InputError("out", str(path), f"must end with {' or '.join(FORMATS)}")
    if path.suffix == ".mp4" and find_spec("imageio_ffmpeg") is None:
        raise InputError("out", str(path), "needs pip install 'kswarms[explore]'; a .gif does not")


def write_film(path: Path, images: Iterable[Image.Image], fps: int) -> int:
    """Write images as a film.

    Parameters
    ----------
    path : Path
        File with the suffix of one of `FORMATS`. An error leaves an existing file unchanged.
    images : iterable of Image
        At least one image; all have the same size, and both sides are even.
    fps : int
        Images per second.

    Returns
    -------
    int
        Number of images.

    Raises
    ------
    InputError
        As for `check_film`, or the file cannot be written.
    """
    check_film(path)
    with _temporary(path) as file:
        return (_write_mp4 if path.suffix == ".mp4" else _write_gif)(file, iter(images), fps)


def write_sheet(path: Path, images: Sequence[Image.Image]) -> None:
    """Write images side by side as one PNG.

    Parameters
    ----------
    path : Path
        File. An error leaves an existing file unchanged.
    images : sequence of Image
        At least one image; all have the same size.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    width, height = images[0].size
    columns = min(_MAX_COLUMNS, math.ceil(math.sqrt(len(images))))
    rows = math.ceil(len(images) / columns)
    gap = round(_GAP * width)
    sheet = Image.new("RGB", (columns * (width + gap) - gap, rows * (height + gap) - gap), "white")
    for k, image in enumerate(images):
        row, column = divmod(k, columns)
        sheet.paste(image, (column * (width + gap), row * (height + gap)))
    with _temporary(path) as file:
        sheet.save(file, dpi=(_DOTS_PER_INCH, _DOTS_PER_INCH))


def _write_mp4(path: Path, images: Iterator[Image.Image], fps: int) -> int:
    import imageio_ffmpeg

    first = next(images)
    encoder = imageio_ffmpeg.write_frames(
        str(path), first.size, fps=fps, macro_block_size=2, ffmpeg_log_level="error"
    )
    encoder.send(None)
    try:
        count = 0
        for image in chain([first], images):
            encoder.send(image.tobytes())
            count += 1
    finally:
        encoder.close()
    return count


def _write_gif(path: Path, images: Iterator[Image.Image], fps: int) -> int:
    colours = palette()
    count = 0

    def reduced() -> Iterator[Image.Image]:
        nonlocal count
        for image in images:
            count += 1
            yield image.quantize(palette=colours, dither=Image.Dither.NONE)

    frames = reduced()
    # GIF stores durations in hundredths of a second.
    next(frames).save(path, save_all=True, append_images=frames, duration=10 * round(100 / fps), loop=0)
    return count


@contextmanager
def _temporary(path: Path) -> Iterator[Path]:
    """Yield a temporary path; on success it replaces `path`."""
    try:
        with atomic_path(path) as file:
            yield file
    except OSError as error:
        raise InputError("out", str(path), f"must be a writable file ({error.strerror or error})") from error
