"""Files are there whole or not at all."""

import os
from pathlib import Path

import pytest

from kswarms.agents.common.atomic_files import atomic_path, remove_temporary_files


def test_a_file_takes_the_place_of_another_once_it_is_whole(tmp_path: Path) -> None:
    path = tmp_path / "film.gif"
    path.write_text("before")
    with atomic_path(path) as file:
        assert (file.parent, file.suffix) == (tmp_path, ".gif")
        file.write_text("after")
        assert path.read_text() == "before"
    assert path.read_text() == "after"
    assert list(tmp_path.iterdir()) == [path]


def test_what_is_not_finished_leaves_all_as_it_was(tmp_path: Path) -> None:
    path = tmp_path / "film.gif"
    path.write_text("before")

    def write() -> None:
        with atomic_path(path) as file:
            file.write_text("aft")
            raise OSError("disk full")

    with pytest.raises(OSError, match="disk full"):
        write()
    assert path.read_text() == "before"
    assert list(tmp_path.iterdir()) == [path]


def test_what_killed_processes_left_is_removed_and_nothing_else(tmp_path: Path) -> None:
    left = [f".unfinished-{process}-film.gif" for process in (99_999_999, 10**30)]  # which no process has
    living = [f".unfinished-{process}-film.gif" for process in (1, os.getpid())]
    of_others = [*living, ".unfinished-tables-1", "1-film.gif"]
    for name in (*left, *of_others):
        (tmp_path / name).write_text("half a f")
    remove_temporary_files(tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(of_others)


def test_what_a_process_of_another_user_writes_is_left_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(_process: int, _signal: int) -> None:
        raise PermissionError

    monkeypatch.setattr(os, "kill", refuse)
    unfinished = tmp_path / ".unfinished-5-film.gif"
    unfinished.touch()
    remove_temporary_files(tmp_path)
    assert unfinished.exists()
