"""Figures as PNG and SVG files."""

from errno import ENOSPC
from io import BytesIO
from pathlib import Path

import pytest
from matplotlib.figure import Figure
from PIL import Image

from kswarms.agents.common.errors import InputError
from kswarms.analysis.figures.files import encode, encode_all, encode_small, save_figure


def figure(height: int = 3) -> Figure:
    drawn = Figure(figsize=(2, 1))
    drawn.subplots().plot([1, 2], [height, 4])
    return drawn


def test_the_same_figure_has_the_same_bytes() -> None:
    for kind in ("svg", "png"):
        assert encode(figure(), kind) == encode(figure(), kind) != encode(figure(2), kind)
    assert b"<svg" in encode(figure(), "svg")


def test_a_small_file_has_a_palette_and_fewer_bytes() -> None:
    small = encode_small(figure())
    assert small == encode_small(figure())
    assert len(small) < 0.6 * len(encode(figure(), "png"))
    with Image.open(BytesIO(small)) as image:
        assert (image.format, image.mode) == ("PNG", "P")


def test_an_unknown_format_is_an_error() -> None:
    with pytest.raises(InputError, match="format='gif': must be one of png, svg"):
        encode(figure(), "gif")


def test_the_smallest_format_has_the_fewest_bytes() -> None:
    encoded = encode_all(figure())
    assert (encoded.width, encoded.height) == (192, 96)
    assert len(encoded.files[encoded.smallest]) == min(map(len, encoded.files.values()))


def test_a_figure_is_saved_in_the_format_of_the_suffix(tmp_path: Path) -> None:
    save_figure(figure(), tmp_path / "figures" / "a.SVG")
    assert (tmp_path / "figures" / "a.SVG").read_bytes() == encode(figure(), "svg")


def test_an_interrupted_write_leaves_the_old_figure(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.png"
    save_figure(figure(), path)
    old = path.read_bytes()

    def full_disk(part: Path, content: bytes) -> None:
        with part.open("wb") as file:
            file.write(content[:100])
        raise OSError(ENOSPC, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full_disk)
    with pytest.raises(OSError, match=r"No space left on device: '.*/a[.]png'"):
        save_figure(figure(2), path)
    assert path.read_bytes() == old
    assert list(tmp_path.iterdir()) == [path]


def test_a_folder_that_cannot_be_created_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "figures").write_text("a file")
    with pytest.raises(InputError, match="must be a writable file"):
        save_figure(figure(), tmp_path / "figures" / "a.png")
