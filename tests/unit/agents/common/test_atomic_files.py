"""Atomic file writing."""

import os
from pathlib import Path

import pytest

from kswarms.agents.common.atomic_files import atomic_path, remove_temporary_files


def test_a_file_is_replaced_on_success(tmp_path: Path) -> None:
    path = tmp_path / "film.gif"
    path.write_text("before")
    with atomic_path(path) as file:
        assert (file.parent, file.suffix) == (tmp_path, ".gif")
        file.write_text("after")
        assert path.read_text() == "before"
    assert path.read_text() == "after"
    assert list(tmp_path.iterdir()) == [path]


def test_a_failed_write_changes_nothing(tmp_path: Path) -> None:
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


def test_only_temporary_files_of_killed_processes_are_removed(tmp_path: Path) -> None:
    left = [f".unfinished-{process}-film.gif" for process in (99_999_999, 10**30)]  # no process IDs
    living = [f".unfinished-{process}-film.gif" for process in (1, os.getpid())]
    of_others = [*living, ".unfinished-tables-1", "1-film.gif"]
    for name in (*left, *of_others):
        (tmp_path / name).write_text("half a f")
    remove_temporary_files(tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(of_others)


def test_temporary_files_of_other_users_processes_stay(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(_process: int, _signal: int) -> None:
        raise PermissionError

    monkeypatch.setattr(os, "kill", refuse)
    unfinished = tmp_path / ".unfinished-5-film.gif"
    unfinished.touch()
    remove_temporary_files(tmp_path)
    assert unfinished.exists()
