"""The lock of a results directory on unusual files and file systems."""

import fcntl
import os
from errno import ENOSPC, ENOSYS
from pathlib import Path

import pytest

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.study.lock import LOCK_FILE, brief_lock, directory_lock, lock_holder


def test_the_holder_is_known_while_the_lock_is_held(tmp_path: Path) -> None:
    with directory_lock(tmp_path, "kswarms run x"):
        assert lock_holder(tmp_path).endswith("(kswarms run x)")
    assert lock_holder(tmp_path) == ""
    assert (tmp_path / LOCK_FILE).read_bytes() == b""


def test_the_description_of_a_holder_is_shown_in_one_short_line(tmp_path: Path) -> None:
    with directory_lock(tmp_path, ""):
        (tmp_path / LOCK_FILE).write_bytes(b"process 1\x1b[2J\n\xff" + b"x" * 10**6)
        holder = lock_holder(tmp_path)
    assert holder.startswith(r"process 1\x1b[2J\n")
    assert holder.isprintable()
    assert len(holder) < 1100


@pytest.mark.parametrize("kind", ["pipe", "link", "directory"])
def test_no_other_file_is_opened_as_a_lock(kind: str, tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    if kind == "pipe":
        os.mkfifo(out / LOCK_FILE)
    elif kind == "link":
        (tmp_path / "key").write_text("precious")
        (out / LOCK_FILE).symlink_to("../key")
    else:
        (out / LOCK_FILE).mkdir()
    assert lock_holder(out) == ""
    with pytest.raises(OSError, match=r"lock|Invalid argument"), directory_lock(out, ""):
        pass
    assert kind != "link" or (tmp_path / "key").read_text() == "precious"


def test_a_file_system_without_locks_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(_file: int, _kind: int) -> None:
        raise OSError(ENOSYS, "Function not implemented")

    monkeypatch.setattr(fcntl, "flock", refuse)
    with pytest.raises(InputError, match=r"cannot be locked .Function not implemented.; use a dir"):
        directory_lock(tmp_path, "").__enter__()
    assert lock_holder(tmp_path) == ""


def test_a_brief_lock_waits_for_another_process(tmp_path: Path) -> None:
    reading, writing = os.pipe()
    with brief_lock(tmp_path):
        child = os.fork()
        if child == 0:
            os.write(writing, b"start ")
            with brief_lock(tmp_path):
                os.write(writing, b"second ")
                os._exit(0)
        assert os.read(reading, 6) == b"start "
        os.write(writing, b"first ")
    os.waitpid(child, 0)
    os.close(writing)
    assert os.read(reading, 100) == b"first second "
    assert not list(tmp_path.iterdir())


def test_a_full_disk_does_not_prevent_the_lock(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "pwrite", full)
    with directory_lock(tmp_path, "kswarms run x"):
        assert lock_holder(tmp_path) == "another process"
