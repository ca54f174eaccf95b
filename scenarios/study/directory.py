"""Results directories and JSON files in them."""

import json
from pathlib import Path
from tempfile import TemporaryFile

from kswarms.agents.common.atomic_files import atomic_path
from kswarms.agents.common.errors import InputError


def make_directory(directory: Path) -> None:
    """Create a results directory unless it exists, and check that it is writable.

    Raises
    ------
    InputError
        If it cannot be created or written to.
    """
    try:
        directory.mkdir(parents=True, exist_ok=True)
        with TemporaryFile(dir=directory):
            pass
    except OSError as error:
        raise InputError("out", str(directory), f"must be a writable directory ({error.strerror})") from error


def write_json(path: Path, content: object) -> None:
    """Write a JSON file atomically.

    Raises
    ------
    OSError
        If writing fails; an existing file is then unchanged.
    """
    with atomic_path(path) as file:
        file.write_text(json.dumps(content, indent=1) + "\n")
