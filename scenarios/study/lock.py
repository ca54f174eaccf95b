"""Lock of a results directory: one process at a time plays into it."""

import os
import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import Final

from kswarms.agents.common.errors import InputError
from kswarms.agents.common.quoting import for_terminal

try:
    import fcntl
except ImportError as error:
    raise ImportError("a study needs locks of files (the module fcntl): use Linux or macOS") from error

LOCK_FILE: Final = "lock"
"""Name of the locked file."""
_TIMEOUT: Final = 0.5
"""Lock timeout (s), longer than `lock_holder` holds the lock."""
_LONGEST_TEXT: Final = 1000
"""Maximum length of the description of a holder that is read (bytes)."""


@contextmanager
def directory_lock(directory: Path, command: str) -> Iterator[None]:
    """Hold the lock of a directory.

    The file names the process and its command. The operating system releases the lock of a killed process.

    Raises
    ------
    InputError
        If another process holds the lock, or the file system has no locks.
    """
    with _open(directory, os.O_RDWR | os.O_CREAT) as file:
        deadline = time.monotonic() + _TIMEOUT
        try:
            while not _try_lock(file, fcntl.LOCK_EX):
                if time.monotonic() >= deadline:
                    reason = f"is in use by {_read_holder(file)}; wait, or use another directory"
                    raise InputError("out", str(directory), reason)
                time.sleep(0.005)
        except OSError as error:
            reason = f"cannot be locked ({error.strerror}); use a directory on a local disk"
            raise InputError("out", str(directory), reason) from error
        started = datetime.now(UTC).isoformat(timespec="seconds")
        holder = f"process {os.getpid()} on {socket.gethostname()} since {started} ({command})\n"
        os.ftruncate(file, 0)
        with suppress(OSError):  # a full disk; a resumed study may need no space
            os.pwrite(file, os.fsencode(holder), 0)
        try:
            yield
        finally:
            os.ftruncate(file, 0)
            fcntl.flock(file, fcntl.LOCK_UN)  # see `brief_lock`


@contextmanager
def brief_lock(directory: Path) -> Iterator[None]:
    """Hold a lock during a short change of a file in a directory; another process waits for it.

    It is independent of `directory_lock`. A file system without locks gives no protection.
    """
    descriptor = os.open(directory, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        with suppress(OSError):
            fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        with suppress(OSError):  # closing keeps the lock if a forked process has the file too
            fcntl.flock(descriptor, fcntl.LOCK_UN)
        os.close(descriptor)


def lock_holder(directory: Path) -> str:
    """Return a description of the process that plays into a directory, empty if none is known."""
    with suppress(OSError), _open(directory, os.O_RDONLY) as file:
        if not _try_lock(file, fcntl.LOCK_SH):
            return _read_holder(file)
    return ""


@contextmanager
def _open(directory: Path, flags: int) -> Iterator[int]:
    """Open the lock's file and yield its descriptor. A symbolic link is an error, a pipe does not block."""
    flags |= os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
    descriptor = os.open(directory / LOCK_FILE, flags, 0o666)
    try:
        yield descriptor
    finally:
        os.close(descriptor)


def _try_lock(file: int, kind: int) -> bool:
    try:
        fcntl.flock(file, kind | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def _read_holder(file: int) -> str:
    text = os.pread(file, _LONGEST_TEXT, 0).decode(errors="replace").strip()
    return for_terminal(text) or "another process"
