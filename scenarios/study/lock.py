"""Lock of a results directory: one process at a time plays into it."""

import fcntl
import os
import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import Final, TextIO

from kswarms.agents.common.errors import InputError

LOCK_FILE: Final = "lock"
"""Name of the locked file."""
_TIMEOUT: Final = 0.5
"""Lock timeout (s), longer than `lock_holder` holds the lock."""


@contextmanager
def directory_lock(directory: Path, command: str) -> Iterator[None]:
    """Hold the lock of a directory; raise an `InputError` if another process holds it.

    The file names the process and its command. The operating system releases the lock of a killed process.
    """
    with (directory / LOCK_FILE).open("a+") as file:
        deadline = time.monotonic() + _TIMEOUT
        while not _try_lock(file, fcntl.LOCK_EX):
            if time.monotonic() >= deadline:
                reason = f"is in use by {_read_holder(file)}; wait, or use another directory"
                raise InputError("out", str(directory), reason)
            time.sleep(0.005)
        started = datetime.now(UTC).isoformat(timespec="seconds")
        file.truncate(0)
        file.write(f"process {os.getpid()} on {socket.gethostname()} since {started} ({command})\n")
        file.flush()
        try:
            yield
        finally:
            file.truncate(0)


def lock_holder(directory: Path) -> str:
    """Return a description of the process that plays into a directory, empty if none does."""
    with suppress(FileNotFoundError), (directory / LOCK_FILE).open() as file:
        if not _try_lock(file, fcntl.LOCK_SH):
            return _read_holder(file)
    return ""


def _try_lock(file: TextIO, kind: int) -> bool:
    try:
        fcntl.flock(file, kind | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def _read_holder(file: TextIO) -> str:
    file.seek(0)
    return file.read().strip() or "another process"
