"""Atomic file writing, and checks of outputs before the work that fills them."""

import os
import re
import secrets
import stat
from collections.abc import Collection, Generator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryFile
from typing import Final

from kswarms.agents.common.errors import InputError

try:
    import fcntl
except ImportError:  # a system without these locks
    fcntl = None  # type: ignore[assignment]

TEMPORARY: Final = ".unfinished-"  # prefix of the names of temporary files
_TEMPORARY_NAME: Final = re.compile(re.escape(TEMPORARY) + r"[0-9a-f]{16}(\..*)?", re.DOTALL)
_LONGEST_SUFFIX: Final = 16  # characters of a temporary file's suffix; names have a limit


@contextmanager
def atomic_path(path: Path) -> Generator[Path, None, None]:
    """Yield a temporary path; on success it replaces `path`.

    The temporary file is new, has a random name in the same directory, the same suffix and the usual access
    rights. After an error, `path` is unchanged, and an `OSError` names `path`. A symbolic link is replaced,
    not followed.
    """
    with _name_in_errors(path):
        temporary, descriptor = _create_temporary(path)
        try:
            yield temporary
            temporary.replace(path)
        finally:
            with suppress(OSError):
                temporary.unlink(missing_ok=True)
            os.close(descriptor)


@contextmanager
def output_path(path: Path, field: str) -> Generator[Path, None, None]:
    """Yield a temporary path, as `atomic_path` does, after `check_output` and `remove_temporary_files`."""
    check_output(path, field)
    remove_temporary_files(path.parent)
    with atomic_path(path) as temporary:
        yield temporary


def check_output(path: Path, field: str) -> None:
    """Raise an `InputError` about `field` unless a regular file can be written at `path`."""
    try:
        require_replaceable(path, field)
        with TemporaryFile(dir=path.parent):
            pass
    except InputError:
        raise
    except (OSError, ValueError) as error:
        raise _not_writable("file", path, field, error) from error


def require_replaceable(path: Path, field: str) -> None:
    """Raise an `InputError` about `field` unless a path is free or that of a regular file."""
    with suppress(FileNotFoundError):
        if not stat.S_ISREG(path.lstat().st_mode):
            rule = "must be a file, not a directory, symbolic link, device or pipe"
            raise InputError(field, str(path), rule)


def check_directory(directory: Path, field: str, marks: Collection[str]) -> None:
    """Raise an `InputError` about `field` unless a directory can be written and is ours, empty or missing.

    `marks` are names of files of kswarms; a directory that it wrote has one of them. Hidden files do not
    count.
    """
    try:
        existing = next(path for path in (directory, *directory.absolute().parents) if _exists(path))
        names = sorted(path.name for path in existing.iterdir()) if existing == directory else []
        with TemporaryFile(dir=existing):
            pass
    except (OSError, ValueError) as error:
        raise _not_writable("directory", directory, field, error) from error
    foreign = [name for name in names if not name.startswith(".")]
    if foreign and set(marks).isdisjoint(names):
        rule = f"must be a new or empty directory, or one that kswarms wrote; it has {foreign[0]!r}"
        raise InputError(field, str(directory), rule)


def _exists(path: Path) -> bool:
    with suppress(FileNotFoundError):
        path.lstat()
        return True
    return False


def _not_writable(kind: str, path: Path, field: str, error: OSError | ValueError) -> InputError:
    reason = error.strerror if isinstance(error, OSError) else error  # ValueError: a NUL in the name
    return InputError(field, str(path), f"must be a writable {kind} ({reason})")


def remove_temporary_files(directory: Path) -> None:
    """Remove temporary files of killed processes from a directory; files in use stay.

    A file is in use if it is locked. This holds for processes of other machines too.
    """
    for temporary in directory.glob(f"{TEMPORARY}*"):
        if not _TEMPORARY_NAME.fullmatch(temporary.name):
            continue  # of the user
        with suppress(OSError):  # in use, a directory, a symbolic link, or not ours
            descriptor = os.open(temporary, os.O_RDWR | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
            try:
                _lock(descriptor, wait=False)
                temporary.unlink()
            finally:
                os.close(descriptor)


def _create_temporary(path: Path) -> tuple[Path, int]:
    """Create and lock a temporary file for `path`; return its path and descriptor."""
    while True:
        temporary = path.with_name(f"{TEMPORARY}{secrets.token_hex(8)}{path.suffix[:_LONGEST_SUFFIX]}")
        flags = os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC
        descriptor = os.open(temporary, flags, 0o666)  # the umask applies
        with suppress(OSError):  # a file system without locks; nobody removes the file then
            _lock(descriptor, wait=True)
        if os.path.lexists(temporary):
            return temporary, descriptor
        os.close(descriptor)  # `remove_temporary_files` removed it before it was locked


def _lock(descriptor: int, wait: bool) -> None:
    """Lock a file; `OSError` if that is not possible."""
    if fcntl is None:
        raise OSError("the system has no locks of files")
    fcntl.flock(descriptor, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))


@contextmanager
def _name_in_errors(path: Path) -> Generator[None, None, None]:
    """Make an `OSError` name `path` if it names no file or a temporary file."""
    try:
        yield
    except OSError as error:
        if error.errno is None or not Path(error.filename or TEMPORARY).name.startswith(TEMPORARY):
            raise
        raise OSError(error.errno, error.strerror, str(path)) from error
