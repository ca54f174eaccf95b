"""Results directories and JSON files in them."""

import json
from pathlib import Path
from tempfile import TemporaryFile

from kswarms.agents.common.atomic_files import atomic_path
from kswarms.agents.common.errors import InputError


def make_directory(directory: Path) -> None:
    """Create a results directory unless it exists; raise an `InputError` if it is not writable."""
    try:
        directory.mkdir(parents=True, exist_ok=True)
        with TemporaryFile(dir=directory):
            pass
    except OSError as error:
        raise InputError("out", str(directory), f"must be a writable directory ({error.strerror})") from error


def write_json(path: Path, content: object) -> None:
    """Write a JSON file atomically: if writing fails, an existing file is unchanged."""
    with atomic_path(path) as file:
        file.write_text(json.dumps(content, indent=1) + "\n")
