"""One input of the fuzz test: how it is given, and what it must come to."""

import contextlib
import hashlib
import io
import os
import shutil
import signal
import sqlite3
import tempfile
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from types import FrameType
from typing import Any, Final

import matplotlib.pyplot as plt

from kswarms import InputError
from kswarms.scenarios.cli import invoke

LIMIT: Final = 300
"""Time limit of one input (s)."""


@dataclass
class Input:
    """Words of the command line, or a function to call."""

    description: str
    words: list[str] = field(default_factory=list)
    call: Callable[[], Any] | None = None
    prepare: Callable[[], None] = lambda: None


class Hang(BaseException):
    """An input that does not end."""


@dataclass(frozen=True)
class Failure:
    """An input that ends in a way that it must not."""

    name: str
    description: str
    problem: str


def try_input(name: str, generate: Callable[[Random, Path], Input], study: Path) -> Failure | None:
    """Give one input in a directory of its own; return what is wrong, or None.

    `name` is the seed of the input. `study` is a results directory, of which the input gets a copy.
    """
    with tempfile.TemporaryDirectory(prefix="fuzz-") as text, _place(Path(text)) as root:
        shutil.copytree(study, root / "work", dirs_exist_ok=True)
        given = generate(Random(name), root / "work")
        given.prepare()
        before = _snapshot(root)
        problem = _call(given.call) if given.call else _invoke(given.words, before, root)
        after = _snapshot(root)
        left = sorted(path for path in after.keys() - before.keys() if _is_foreign(path))
        if not problem and left:
            problem = f"left {left}"
        return Failure(name, given.description, problem) if problem else None


@contextlib.contextmanager
def _place(root: Path) -> Iterator[Path]:
    """Work in ``root/work``, with a home and a directory of temporary files in `root`."""
    here, environment = Path.cwd(), dict(os.environ)
    for name in ("work", "home", "tmp"):
        (root / name).mkdir()
    (root / "home" / "letter.txt").write_text("mine")  # a home is not an empty directory
    os.environ |= {"HOME": str(root / "home"), "TMPDIR": str(root / "tmp"), "NO_COLOR": "1"}
    tempfile.tempdir = None
    os.chdir(root / "work")
    try:
        yield root
    finally:
        os.chdir(here)
        os.environ.clear()
        os.environ.update(environment)
        tempfile.tempdir = None
        plt.close("all")


@contextlib.contextmanager
def _limit() -> Iterator[None]:
    def stop(_signal: int, _frame: FrameType | None) -> None:
        raise Hang

    previous = signal.signal(signal.SIGALRM, stop)
    signal.alarm(LIMIT)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, previous)


def _call(call: Callable[[], Any]) -> str:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            with _limit():
                call()
        except InputError as error:
            return "" if str(error).isprintable() else f"the message is not one line: {str(error)!r}"
        except BaseException as error:  # noqa: BLE001  # all that is no `InputError` is a failure
            return _describe(error)
    return ""


def _invoke(words: list[str], before: dict[str, str], root: Path) -> str:
    output, errors = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(output), contextlib.redirect_stderr(errors), warnings.catch_warnings():
        warnings.simplefilter("always")
        try:
            with _limit():
                status = invoke(words)
        except BaseException as error:  # noqa: BLE001  # nothing may escape
            return _describe(error)
    text = errors.getvalue()
    if status not in (0, 1, 2):
        return f"status {status}"
    if "Traceback" in text or "Warning" in text:
        return f"status {status}, printed {text[-300:]!r}"
    if status == 2:
        if not text.startswith("kswarms: ") or text.count("\n") != 1 or not text[:-1].isprintable():
            return f"the refusal is not one line: {text[-300:]!r}"
        after = _snapshot(root)
        changed = sorted(name for name in after.keys() | before.keys() if after.get(name) != before.get(name))
        if changed:
            return f"refused, but changed {changed}: {text!r}"
    return ""


def _describe(error: BaseException) -> str:
    trace = error.__traceback__
    places = []
    while trace:
        places.append(f"{Path(trace.tb_frame.f_code.co_filename).name}:{trace.tb_lineno}")
        trace = trace.tb_next
    return f"{type(error).__name__}: {str(error)[:200]!r} at {' '.join(places[-5:])}"


def _snapshot(root: Path) -> dict[str, str]:
    """Return the files below a directory with digests of their content."""
    return {
        str(path.relative_to(root)): hashlib.sha256(_content(path)).hexdigest() if path.is_file() else ""
        for path in root.rglob("*")
    }


def _content(path: Path) -> bytes:
    """Return the content of a file; SQLite may write the same rows with other bytes."""
    if path.suffix == ".sqlite":
        connection = sqlite3.connect(f"{path.as_uri()}?immutable=1", uri=True)
        with contextlib.suppress(sqlite3.Error, UnicodeError), contextlib.closing(connection):
            return "\n".join(connection.iterdump()).encode("utf-8", "surrogateescape")
    return path.read_bytes()


def _is_foreign(path: str) -> bool:
    """Return whether a new path is outside the working directory, or a temporary file."""
    top, *rest = Path(path).parts
    if rest[-1:] == [".kswarms-report"]:  # marks a folder of `report --files`
        return False
    return top != "work" or any(part.startswith(".") or ".tmp" in part for part in rest)
