"""Results directories and JSON files in them."""

import json
from collections.abc import Collection
from pathlib import Path
from tempfile import TemporaryFile
from typing import Final

from kswarms.agents.common.atomic_files import atomic_path, check_directory, require_replaceable
from kswarms.agents.common.errors import InputError
from kswarms.scenarios.study.database import LEDGER_FILE

CONTRIBUTIONS_FILE: Final = "contribution.parquet"
"""Table of contributions."""
GAMES_FILE: Final = "games.jsonl"
"""Results of the games of a calibration."""
FIGURES: Final = "figures"
"""Folder of figures in a results directory."""
_MARKS: Final = (LEDGER_FILE, CONTRIBUTIONS_FILE, GAMES_FILE)
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
        present = {path.name for path in directory.iterdir()}
        for name in (mark, *files):
            if name in present and mark not in present:
                raise InputError("out", str(directory), f"has a {name} but no {mark}; use another directory")
            require_replaceable(directory / name, "out")
        if FIGURES in present:
            figures = directory / FIGURES
            if figures.is_symlink() or not figures.is_dir():
                raise InputError("out", str(figures), "must be a directory and no symbolic link")
            with TemporaryFile(dir=figures):
                pass
            for path in figures.glob("*.png"):
                require_replaceable(path, "out")
    except OSError as error:
        raise InputError("out", str(directory), f"must be a writable directory ({error.strerror})") from error


def write_json(path: Path, content: object) -> None:
    """Write a JSON file atomically: if writing fails, an existing file is unchanged."""
    with atomic_path(path) as file:
        file.write_text(json.dumps(content, indent=1) + "\n")
