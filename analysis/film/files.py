"""Films (MP4, GIF) and contact sheets (PNG)."""

import math
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from errno import EIO
from importlib.util import find_spec
from itertools import chain
from pathlib import Path
from typing import Final

from PIL import Image

from kswarms.agents.common.atomic_files import output_path
from kswarms.agents.common.errors import InputError
from kswarms.analysis.film.painter import palette

FORMATS: Final = (".mp4", ".gif")
_MAX_COLUMNS: Final = 4
_GAP: Final = 0.02
"""Gap between the images of a sheet, relative to the width of an image."""
_DOTS_PER_INCH: Final = 300


def check_film(path: Path) -> None:
    """Raise `InputError` if the suffix of `path` is unknown or its encoder is not installed."""
    if path.suffix not in FORMATS:
        raise InputError("out", str(path), f"must end with {' or '.join(FORMATS)}")
    if path.suffix == ".mp4" and find_spec("imageio_ffmpeg") is None:
        raise InputError("out", str(path), "needs pip install 'kswarms[explore]'; a .gif does not")


def write_film(path: Path, images: Iterable[Image.Image], fps: int) -> None:
    """Write images as a film with `fps` images per second.

    `images` has at least one image; all have the same size, with even width and height. `InputError` as in
    `check_film` and `check_output`. After an error, an existing file is unchanged.
    """
    check_film(path)
    with output_path(path, "out") as file:
        (_write_mp4 if path.suffix == ".mp4" else _write_gif)(file, iter(images), fps)


def write_sheet(path: Path, images: Sequence[Image.Image]) -> None:
    """Write images side by side as one PNG.

    `images` has at least one image; all have the same size. `InputError` as in `check_output`. After an
    error, an existing file is unchanged.
    """
    width, height = images[0].size
    columns = min(_MAX_COLUMNS, math.ceil(math.sqrt(len(images))))
    rows = math.ceil(len(images) / columns)
    gap = round(_GAP * width)
    sheet = Image.new("RGB", (columns * (width + gap) - gap, rows * (height + gap) - gap), "white")
    for k, image in enumerate(images):
        row, column = divmod(k, columns)
        sheet.paste(image, (column * (width + gap), row * (height + gap)))
    with output_path(path, "out") as file:
        sheet.save(file, dpi=(_DOTS_PER_INCH, _DOTS_PER_INCH))


def _write_mp4(path: Path, images: Iterator[Image.Image], fps: int) -> None:
    import imageio_ffmpeg

    first = next(images)
    settings = {"fps": fps, "macro_block_size": 2, "ffmpeg_log_level": "error"}
    name = f"file:{path}"  # otherwise a colon in the path ends the name of a protocol
    encoder = imageio_ffmpeg.write_frames(name, first.size, **settings)
    encoder.send(None)
    sent = written = 0
    try:
        for image in chain([first], images):
            encoder.send(image.tobytes())
            sent += 1
    finally:
        encoder.close()
    with suppress(RuntimeError):  # the encoder reports no errors, not even a full disk
        written, _ = imageio_ffmpeg.count_frames_and_secs(name)
    if written != sent:
        raise OSError(EIO, f"The encoder wrote {written} of {sent} frames")


def _write_gif(path: Path, images: Iterator[Image.Image], fps: int) -> None:
    colours = palette()
    frames = (image.quantize(palette=colours, dither=Image.Dither.NONE) for image in images)
    # GIF stores durations in hundredths of a second.
    next(frames).save(path, save_all=True, append_images=frames, duration=10 * round(100 / fps), loop=0)
