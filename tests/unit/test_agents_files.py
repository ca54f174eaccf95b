"""Files are there whole or not at all."""

from pathlib import Path

import pytest

from agents.files import whole


def test_a_file_takes_the_place_of_another_once_it_is_whole(tmp_path: Path) -> None:
    path = tmp_path / "film.gif"
    path.write_text("before")
    with whole(path) as file:
        assert (file.parent, file.suffix) == (tmp_path, ".gif")
        file.write_text("after")
        assert path.read_text() == "before"
    assert path.read_text() == "after"
    assert list(tmp_path.iterdir()) == [path]


def test_what_is_not_finished_leaves_all_as_it_was(tmp_path: Path) -> None:
    path = tmp_path / "film.gif"
    path.write_text("before")

    def write() -> None:
        with whole(path) as file:
            file.write_text("aft")
            raise OSError("disk full")

    with pytest.raises(OSError, match="disk full"):
        write()
    assert path.read_text() == "before"
    assert list(tmp_path.iterdir()) == [path]
