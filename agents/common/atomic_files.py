"""Files that are there whole or not at all, whoever writes them and whatever stops it."""

import os
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

UNFINISHED: Final = ".unfinished-"
"""How the name of what is not whole yet begins."""


@contextmanager
def whole(path: Path) -> Generator[Path, None, None]:
    """Give a file to write to, which takes the place of another once it is whole.

    Parameters
    ----------
    path : Path
        What is to be written. The file given lies beside it and has its suffix; processes that write the
        same are given files of their own.

    Raises
    ------
    OSError
        If it cannot be written; then it is as it was.
    """
    unfinished = path.with_name(f"{UNFINISHED}{os.getpid()}-{path.name}")
    try:
        yield unfinished
        unfinished.replace(path)
    finally:
        unfinished.unlink(missing_ok=True)


def remove_unfinished(directory: Path) -> None:
    """Remove what `whole` has left in a directory of processes that were killed.

    Files of processes that live are kept, for they may be finishing them.

    Parameters
    ----------
    directory : Path
        Where they lie, not below.

    Raises
    ------
    OSError
        If one cannot be removed.
    """
    for left in directory.glob(f"{UNFINISHED}*-*"):
        process = left.name.removeprefix(UNFINISHED).partition("-")[0]
        if process.isdecimal() and not _lives(int(process)):
            left.unlink(missing_ok=True)


def _lives(process: int) -> bool:
    try:
        os.kill(process, 0)  # which does nothing to it
    except PermissionError:
        return True
    except (ProcessLookupError, OverflowError):
        return False
    return True
