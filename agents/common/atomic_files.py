"""Atomic file writing."""

import os
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from kswarms.agents.common.errors import InputError

TEMPORARY: Final = ".unfinished-"  # prefix of the names of temporary files


@contextmanager
def atomic_path(path: Path) -> Generator[Path, None, None]:
    """Yield a temporary path; on success it replaces `path`.

    The temporary file is in the same directory and has the same suffix. Each process has its own. After an
    error, `path` is unchanged.
    """
    temporary = path.with_name(f"{TEMPORARY}{os.getpid()}-{path.name}")
    try:
        yield temporary
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


@contextmanager
def output_path(path: Path, field: str) -> Generator[Path, None, None]:
    """Yield a temporary path, as `atomic_path` does; an `OSError` becomes an `InputError` about `field`."""
    try:
        with atomic_path(path) as temporary:
            yield temporary
    except OSError as error:
        raise InputError(field, str(path), f"must be a writable file ({error.strerror or error})") from error


def remove_temporary_files(directory: Path) -> None:
    """Remove temporary files of killed processes from a directory; files of running processes stay."""
    for temporary in directory.glob(f"{TEMPORARY}*-*"):
        process = temporary.name.removeprefix(TEMPORARY).partition("-")[0]
        if process.isdecimal() and not _is_running(int(process)):
            temporary.unlink(missing_ok=True)


def _is_running(process: int) -> bool:
    try:
        os.kill(process, 0)  # signal 0 does nothing
    except PermissionError:
        return True
    except (ProcessLookupError, OverflowError):
        return False
    return True
