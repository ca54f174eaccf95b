"""Files of others: only regular files of bounded size are read."""

import os
import socket
from collections.abc import Callable
from pathlib import Path

import pytest

from kswarms.agents.common import input_files
from kswarms.agents.common.errors import InputError
from kswarms.agents.common.input_files import read_input_file, require_regular_file


def test_a_regular_file_is_read(tmp_path: Path) -> None:
    (tmp_path / "mine").write_bytes(b"12345")
    (tmp_path / "link").symlink_to("mine")
    assert read_input_file("file", tmp_path / "mine", 5) == b"12345"
    assert read_input_file("file", tmp_path / "link", 5) == b"12345"


def test_a_file_that_is_too_large_is_refused(tmp_path: Path) -> None:
    (tmp_path / "mine").write_bytes(b"123456")
    with pytest.raises(InputError, match=r"^file='.*/mine': must be a file of at most 5 bytes$"):
        read_input_file("file", tmp_path / "mine", 5)
    with (tmp_path / "sparse").open("wb") as file:
        file.truncate(10**12)
    with pytest.raises(InputError, match="at most 1,000 bytes"):
        read_input_file("file", tmp_path / "sparse", 1000)
    with pytest.raises(InputError, match="at most 10 bytes"):  # its size is said to be 0
        read_input_file("file", Path("/proc/self/status"), 10)


def read_nine(path: Path) -> None:
    read_input_file("file", path, 9)


def check(path: Path) -> None:
    require_regular_file("file", path)


@pytest.mark.parametrize("read", [read_nine, check])
def test_other_kinds_of_files_are_refused(read: Callable[[Path], None], tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "link").symlink_to("/dev/zero")
    (tmp_path / "loop").symlink_to("loop")
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(os.path.relpath(tmp_path / "socket"))
        for name, rule in (
            ("pipe", "a regular file, not a device, pipe or socket"),
            ("link", "a regular file, not a device"),
            ("socket", "a regular file, not a device"),
            ("loop", "a readable file"),
            (".", "a regular file, not a directory"),
            ("absent", "a readable file .No such file"),
            ("a\0b", "a readable file .*null"),
            ("a" * 5000, "a readable file .File name too long"),
        ):
            with pytest.raises(InputError, match=f"^file='[^']*': must be {rule}"):
                read(tmp_path / name)


def test_a_pipe_that_replaces_the_file_after_the_check_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    os.mkfifo(tmp_path / "pipe")
    monkeypatch.setattr(input_files, "require_regular_file", lambda *_: None)
    with pytest.raises(InputError, match="must be a regular file"):
        read_input_file("file", tmp_path / "pipe", 9)
