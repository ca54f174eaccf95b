"""Atomic file writing, temporary files and checks of outputs."""

import fcntl
import os
import stat
from errno import ENOSPC
from pathlib import Path

import pytest

from kswarms.agents.common import atomic_files
from kswarms.agents.common.atomic_files import (
    atomic_path,
    check_directory,
    check_output,
    output_path,
    remove_temporary_files,
)
from kswarms.agents.common.errors import InputError

LINK = ".unfinished-0123456789abcdef"


def test_a_file_is_replaced_on_success(tmp_path: Path) -> None:
    path = tmp_path / "film.gif"
    path.write_text("before")
    with atomic_path(path) as file:
        assert (file.parent, file.suffix) == (tmp_path, ".gif")
        file.write_text("after")
        assert path.read_text() == "before"
    assert path.read_text() == "after"
    assert list(tmp_path.iterdir()) == [path]


def test_a_failed_write_changes_nothing_and_names_the_file(tmp_path: Path) -> None:
    path = tmp_path / "film.gif"
    path.write_text("before")

    def write() -> None:
        with atomic_path(path) as file:
            file.write_text("aft")
            raise OSError(ENOSPC, "No space left on device")

    with pytest.raises(OSError, match=r"No space left on device: '.*/film[.]gif'"):
        write()
    assert path.read_text() == "before"
    assert list(tmp_path.iterdir()) == [path]
    with pytest.raises(FileNotFoundError, match=r"No such file or directory: '.*/absent/film[.]gif'"):
        atomic_path(tmp_path / "absent" / "film.gif").__enter__()


def test_temporary_files_are_new_and_have_the_usual_rights(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "precious").write_text("mine")
    (tmp_path / ".unfinished-a.csv").symlink_to("precious")
    names = iter(["a", "b"])
    monkeypatch.setattr(atomic_files.secrets, "token_hex", lambda _: next(names))
    with pytest.raises(FileExistsError):
        atomic_path(tmp_path / "out.csv").__enter__()
    before = os.umask(0o027)
    try:
        with atomic_path(tmp_path / "out.csv") as file:
            file.write_text("1")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "out.csv").stat().st_mode) == 0o640
    assert (tmp_path / "precious").read_text() == "mine"


def test_a_symbolic_link_is_replaced_and_not_followed(tmp_path: Path) -> None:
    (tmp_path / "precious").write_text("mine")
    (tmp_path / "link").symlink_to("precious")
    with atomic_path(tmp_path / "link") as file:
        file.write_text("after")
    assert not (tmp_path / "link").is_symlink()
    assert (tmp_path / "precious").read_text() == "mine"


def test_a_long_suffix_is_no_obstacle(tmp_path: Path) -> None:
    path = tmp_path / ("a." + "b" * 250)
    with output_path(path, "out") as file:
        file.write_text("1")
    assert path.read_text() == "1"


def test_only_temporary_files_of_killed_processes_are_removed(tmp_path: Path) -> None:
    (tmp_path / "precious").write_text("mine")
    (tmp_path / ".unfinished-tables-1").mkdir()
    (tmp_path / ".unfinished-novel.tex").touch()
    (tmp_path / LINK).symlink_to("precious")
    (tmp_path / "1-film.gif").touch()
    child = os.fork()
    if child == 0:
        with atomic_path(tmp_path / "film.gif") as file:
            file.write_text("half a f")
            os._exit(0)
    os.waitpid(child, 0)
    (left_over,) = tmp_path.glob(".unfinished-*.gif")
    with atomic_path(tmp_path / "other.gif") as file:
        file.write_text("in use")
        remove_temporary_files(tmp_path)
        assert not left_over.exists()
        assert file.read_text() == "in use"
    kept = {"precious", ".unfinished-tables-1", ".unfinished-novel.tex", LINK, "1-film.gif", "other.gif"}
    assert {path.name for path in tmp_path.iterdir()} == kept
    assert (tmp_path / "precious").read_text() == "mine"


def test_a_temporary_file_that_is_removed_before_it_is_locked_is_made_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real, calls = fcntl.flock, []

    def removing(descriptor: int, kind: int) -> None:
        if not calls:
            next(tmp_path.iterdir()).unlink()
        calls.append(kind)
        real(descriptor, kind)

    monkeypatch.setattr(fcntl, "flock", removing)
    with atomic_path(tmp_path / "a") as file:
        file.write_text("1")
    assert len(calls) == 2
    assert (tmp_path / "a").read_text() == "1"


def test_a_file_system_without_locks_can_be_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(_descriptor: int, _kind: int) -> None:
        raise OSError("Function not implemented")

    monkeypatch.setattr(fcntl, "flock", refuse)
    with atomic_path(tmp_path / "a") as file:
        file.write_text("1")
        remove_temporary_files(tmp_path)
    assert (tmp_path / "a").read_text() == "1"


def test_outputs_are_checked_before_the_work(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "link").symlink_to("file")
    (tmp_path / "file").write_text("mine")
    for name in ("new", "file"):
        check_output(tmp_path / name, "out")
    for name, rule in (
        (".", "a file, not a directory"),
        ("pipe", "a file, not a directory, symbolic link, device or pipe"),
        ("link", "a file, not a directory, symbolic link"),
        ("/dev/null", "a file, not a directory"),
        ("absent/new", "a writable file .No such file"),
        ("file/new", "a writable file .Not a directory"),
        ("/proc/new", "a writable file"),
        ("a\0b", "a writable file .*null"),
        ("a" * 300, "a writable file .File name too long"),
    ):
        with pytest.raises(InputError, match=rf"^out='.*': must be {rule}"):
            check_output(tmp_path / name, "out")
    assert {path.name for path in tmp_path.iterdir()} == {"pipe", "link", "file"}


def test_a_directory_with_files_of_others_is_refused(tmp_path: Path) -> None:
    ours, theirs, hidden = (tmp_path / name for name in ("ours", "theirs", "hidden"))
    for directory, name in ((ours, "mark"), (ours, "notes"), (theirs, "key"), (hidden, ".DS_Store")):
        directory.mkdir(exist_ok=True)
        (directory / name).touch()
    for accepted in (ours, hidden, tmp_path / "new", tmp_path / "new" / "deep"):
        check_directory(accepted, "out", ["mark"])
    for refused, rule in (
        (theirs, "a new or empty directory, or one that kswarms wrote; it has 'key'"),
        (theirs / "key", "a writable directory .Not a directory"),
        (theirs / "key" / "deep", "a writable directory .Not a directory"),
        (Path("/proc/new"), "a writable directory"),
        (tmp_path / "a\0b", "a writable directory .*null"),
        (tmp_path / ("a" * 300), "a writable directory .File name too long"),
    ):
        with pytest.raises(InputError, match=f"^out='.*': must be {rule}"):
            check_directory(refused, "out", ["mark"])
    assert {path.name for path in tmp_path.iterdir()} == {"ours", "theirs", "hidden"}
