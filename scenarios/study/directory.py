"""Results directories and JSON files in them."""

import json
import stat
from collections.abc import Collection
from pathlib import Path
from tempfile import TemporaryFile
from typing import Final

from kswarms.agents.common.atomic_files import atomic_path, check_directory
from kswarms.agents.common.errors import InputError
from kswarms.scenarios.study.database import LEDGER_FILE

CONTRIBUTIONS_FILE: Final = "contribution.parquet"
"""Table of contributions."""
SHARES_FILE: Final = "shares.json"
"""Shares that a fit measured."""
FIGURES: Final = "figures"
"""Folder of figures in a results directory."""
_MARKS: Final = (LEDGER_FILE, CONTRIBUTIONS_FILE, SHARES_FILE)
"""A directory is a results directory of kswarms if it has one of these files."""


def make_directory(directory: Path, mark: str, files: Collection[str] = ()) -> None:
    """Create a results directory, or check an existing one; nothing in it changes.

    Parameters
    ----------
    mark : str
        The main file that the caller writes: of a study, of contributions or of a fit.
    files : collection of str
        Names of the other files that the caller writes.

    Raises
    ------
    InputError
        If the directory is not writable; has files, but no main file of kswarms; has one of `files`, but
        no `mark`; or if a file or figure is a symbolic link or not regular.
    """
    check_directory(directory, "out", _MARKS)
    try:
        directory.mkdir(parents=True, exist_ok=True)
        modes = {path.name: path.lstat().st_mode for path in directory.iterdir()}
        if stat.S_ISDIR(modes.get(FIGURES, 0)):
            with TemporaryFile(dir=directory / FIGURES):
                pass
            for path in (directory / FIGURES).glob("*.png"):
                _require_regular(path, path.lstat().st_mode)
    except OSError as error:
        raise InputError("out", str(directory), f"must be a writable directory ({error.strerror})") from error
    for name in (mark, *files):
        if name in modes and mark not in modes:
            raise InputError("out", str(directory), f"has a {name} but no {mark}; use another directory")
        _require_regular(directory / name, modes.get(name, stat.S_IFREG))
    if not stat.S_ISDIR(modes.get(FIGURES, stat.S_IFDIR)):
        raise InputError("out", str(directory / FIGURES), "must be a directory and no symbolic link")


def _require_regular(path: Path, mode: int) -> None:
    if not stat.S_ISREG(mode):
        raise InputError("out", str(path), "must be a regular file and no symbolic link")


def write_json(path: Path, content: object) -> None:
    """Write a JSON file atomically: if writing fails, an existing file is unchanged."""
    with atomic_path(path) as file:
        file.write_text(json.dumps(content, indent=1) + "\n")
