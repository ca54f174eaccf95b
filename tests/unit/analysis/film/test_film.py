"""Images of the arena, and films and sheets of them."""

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageColor

from kswarms.agents.common.errors import InputError
from kswarms.analysis.colours import SWARM_COLOURS
from kswarms.analysis.film import files as film
from kswarms.analysis.film.files import check_film, write_film, write_sheet
from kswarms.analysis.film.painter import ArenaPainter, palette
from kswarms.model.description.arena import build_arena

PAINTER = ArenaPainter(build_arena("symmetric", 2, 2.0, 0.16, 0.17, 0), 0.085, 401)


def _image(
    x: float = 0.3, y: float = 0, heading: float = 0, swarm: int = 0, acts: bool = False, puck: bool = False
) -> Image.Image:
    states = [np.array([value]) for value in ((x, y), heading, swarm, acts, puck)]
    return PAINTER.paint("t = 0.0 s", (1, 2), *states)


def _at(image: Image.Image, x: float, y: float) -> tuple[int, ...]:
    """Return the colour at a point (m)."""
    scale = PAINTER.width / 2.06
    top = PAINTER.height - PAINTER.width
    colour = image.getpixel((PAINTER.width / 2 + scale * x, top + PAINTER.width / 2 - scale * y))
    assert isinstance(colour, tuple)
    return colour


def test_a_robot_is_drawn_at_its_position_in_the_colour_of_its_swarm() -> None:
    for swarm in (0, 1):
        image = _image(0.3, -0.2, math.pi, swarm)
        assert _at(image, 0.33, -0.2) == ImageColor.getrgb(SWARM_COLOURS[swarm])
    assert _at(image, 0.3, 0.2) == (255, 255, 255)
    assert PAINTER.width % 2 == PAINTER.height % 2 == 0
    assert image.size == (PAINTER.width, PAINTER.height)


def test_puck_state_and_heading_of_a_robot_are_visible() -> None:
    still = _image()
    assert _at(_image(puck=True), 0.3, 0.0) != _at(still, 0.3, 0.0)
    ring = 0.3 + 0.87 * 0.085
    assert _at(_image(acts=True, heading=math.pi), ring, 0.0) != _at(_image(heading=math.pi), ring, 0.0)
    ahead = 0.3 + 0.6 * 0.085
    assert _at(_image(heading=0.0), ahead, 0.0) == (255, 255, 255)
    assert _at(_image(heading=math.pi / 2), 0.3, 0.6 * 0.085) == (255, 255, 255)
    assert _at(_image(heading=math.pi / 2), ahead, 0.0) != (255, 255, 255)


def test_stations_are_dark_and_bases_have_a_tint_of_their_swarm() -> None:
    image = _image()
    assert max(_at(image, 0.0, 0.66)) < 80
    red, green, blue = _at(image, 0.8, 0.12)
    assert red > green > blue


def test_the_palette_has_all_plain_colours() -> None:
    values = palette().getpalette()
    assert values is not None
    colours = set(zip(*[iter(values)] * 3, strict=True))
    for name in (*SWARM_COLOURS, "#ffc107", "#ffffff", "#111111", "#333333", "#2b2b2b"):
        assert ImageColor.getrgb(name) in colours
    assert len(values) <= 3 * 256


def test_a_gif_has_the_given_images(tmp_path: Path) -> None:
    path = tmp_path / "a.gif"
    images = [_image(x, acts=x > 0) for x in (-0.3, 0.0, 0.3)]
    write_film(path, iter(images), 20)
    with Image.open(path) as gif:
        assert (gif.n_frames, gif.size, gif.info["duration"]) == (3, images[0].size, 50)  # type: ignore[attr-defined]
        gif.seek(2)
        shown = gif.convert("RGB")
    assert _at(shown, 0.3, -0.05) == _at(images[2], 0.3, -0.05)
    assert list(tmp_path.iterdir()) == [path]


def test_an_mp4_has_the_given_images(tmp_path: Path) -> None:
    imageio_ffmpeg = pytest.importorskip("imageio_ffmpeg", reason="needs the extra `explore`")
    path = tmp_path / "a.mp4"
    write_film(path, (_image(k / 10) for k in range(5)), 10)
    frames, seconds = imageio_ffmpeg.count_frames_and_secs(str(path))
    assert (frames, seconds) == (5, pytest.approx(0.5, abs=0.11))
    reader = imageio_ffmpeg.read_frames(str(path))
    assert next(reader)["size"] == (PAINTER.width, PAINTER.height)
    first = Image.frombytes("RGB", (PAINTER.width, PAINTER.height), next(reader))
    reader.close()
    assert np.abs(np.subtract(_at(first, 0.0, 0.06), _at(_image(0.0), 0.0, 0.06))).max() < 40
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(("count", "grid"), [(1, (1, 1)), (2, (2, 1)), (6, (3, 2)), (17, (4, 5))])
def test_a_sheet_has_its_images_side_by_side(tmp_path: Path, count: int, grid: tuple[int, int]) -> None:
    path = tmp_path / "a.png"
    write_sheet(path, [_image()] * count)
    gap = round(0.02 * PAINTER.width)
    with Image.open(path) as sheet:
        assert sheet.width == grid[0] * (PAINTER.width + gap) - gap
        assert sheet.height == grid[1] * (PAINTER.height + gap) - gap


def test_a_film_that_cannot_be_written_is_an_error_and_leaves_no_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(InputError, match=r"must end with \.mp4 or \.gif"):
        check_film(tmp_path / "a.avi")
    with pytest.raises(InputError, match="must be a writable file"):
        write_film(tmp_path / "nowhere" / "a.gif", iter([_image()]), 10)
    monkeypatch.setattr(film, "find_spec", lambda _: None)
    with pytest.raises(InputError, match=r"needs pip install 'kswarms\[explore\]'; a \.gif does not"):
        check_film(tmp_path / "a.mp4")
    check_film(tmp_path / "a.gif")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["a.gif", "a.mp4"])
def test_an_interrupted_film_leaves_the_old_file(tmp_path: Path, name: str) -> None:
    if name.endswith("mp4"):
        pytest.importorskip("imageio_ffmpeg", reason="needs the extra `explore`")
    path = tmp_path / name
    path.write_bytes(b"before")

    def broken() -> Iterator[Image.Image]:
        yield _image()
        raise RuntimeError("no more")

    with pytest.raises(RuntimeError, match="no more"):
        write_film(path, broken(), 10)
    assert path.read_bytes() == b"before"
    assert list(tmp_path.iterdir()) == [path]
