"""Reading of files that others may have made: regular files of bounded size only."""

import errno
import os
import stat
import tomllib
from pathlib import Path
from typing import Any

from pydantic_core import from_json

from kswarms.agents.common.errors import InputError
from kswarms.agents.common.limits import MAX_JSON_FILE, MAX_TEXT_FILE


def to_path(field: str, path: object) -> Path:
    """Return a path that a user gives as text or as a path; raise an `InputError` for anything else."""
    if not isinstance(path, str | os.PathLike) or "\0" in str(path):
        raise InputError(field, path, "must be a path")
    try:
        os.lstat(path)
    except OSError as error:
        if error.errno == errno.ENAMETOOLONG:
            raise InputError(field, path, "must be a shorter path") from error
    return Path(path)


def read_input_file(field: str, path: Path, limit: int) -> bytes:
    """Return the content of a regular file.

    A device, a named pipe or a directory is never opened, so reading neither blocks nor lasts for ever.

    Parameters
    ----------
    field : str
        Name of the argument or option, for the error.
    limit : int
        Maximum size (bytes); `kswarms.agents.common.limits` has the limits.

    Raises
    ------
    InputError
        If the file is missing, unreadable, too large or no regular file.
    """
    require_regular_file(field, path)
    try:
        # Non-blocking, in case a named pipe has replaced the file since the check.
        descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC | os.O_NONBLOCK | os.O_NOCTTY)
        with os.fdopen(descriptor, "rb") as file:
            _require_regular(field, path, os.fstat(descriptor))
            content = file.read(limit + 1)
    except OSError as error:
        raise _unreadable(field, path, error.strerror) from error
    if len(content) > limit:
        raise InputError(field, str(path), f"must be a file of at most {limit:,} bytes")
    return content


def read_toml(field: str, path: Path) -> dict[str, Any]:
    """Return the content of a TOML file, read as `read_input_file` does."""
    source = read_input_file(field, path, MAX_TEXT_FILE)
    try:
        return tomllib.loads(source.decode("utf-8-sig"))
    except (ValueError, RecursionError) as error:
        raise InputError(field, str(path), f"must be a TOML file ({error})") from error


def read_json(field: str, path: Path, kind: str = "a JSON file") -> Any:
    """Return the content of a JSON file, read as `read_input_file` does; `kind` describes it in errors."""
    source = read_input_file(field, path, MAX_JSON_FILE)
    try:
        return from_json(source)  # unlike `json`, it limits the depth of brackets to 200
    except ValueError as error:
        raise InputError(field, str(path), f"must be {kind} ({error})") from error


def require_regular_file(field: str, path: Path) -> None:
    """Raise an `InputError` unless a path leads to a regular file."""
    try:
        found = path.stat()
    except OSError as error:
        raise _unreadable(field, path, error.strerror) from error
    except ValueError as error:  # a NUL character in the name
        raise _unreadable(field, path, error) from error
    _require_regular(field, path, found)


def _require_regular(field: str, path: Path, found: os.stat_result) -> None:
    if not stat.S_ISREG(found.st_mode):
        kind = "a directory" if stat.S_ISDIR(found.st_mode) else "a device, pipe or socket"
        raise InputError(field, str(path), f"must be a regular file, not {kind}")


def _unreadable(field: str, path: Path, reason: object) -> InputError:
    return InputError(field, str(path), f"must be a readable file ({reason})")
