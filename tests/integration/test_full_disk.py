"""Files that cannot grow, as on a full disk or beyond a quota: one line, status 1, nothing stored is lost."""

import resource
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from kswarms.scenarios.cli import invoke
from tests.helpers.tiny_study import RUN, read_tables

pytestmark = pytest.mark.usefixtures("tiny_file")


@contextmanager
def file_size_limit(size: int) -> Iterator[None]:
    """Let each write beyond a size (bytes) of a file fail, also in child processes."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def files() -> dict[Path, bytes]:
    return {path: path.read_bytes() for path in Path().rglob("*") if path.is_file()}


@pytest.mark.parametrize("size", [0, 10_000, 40_000, 60_000])
def test_a_study_that_cannot_grow_is_resumed(size: int, capsys: pytest.CaptureFixture[str]) -> None:
    words = [*RUN, "--seeds", "4"]
    assert invoke([*words, "--out", "whole"]) == 0
    assert Path("whole/ledger.sqlite").stat().st_size > 60_000
    with file_size_limit(size):
        assert invoke(words) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("kswarms: ")
    assert invoke(words) == 0
    assert read_tables("results") == read_tables("whole")
    assert not list(Path("results").glob(".*"))


@pytest.mark.parametrize(
    "command",
    [
        "film fig-6.1c --n 6 --to 2 --size 64 --out old.gif",
        "film fig-6.1c --n 6 --to 2 --size 64 --out old.mp4",
        "film fig-6.1c --n 6 --to 2 --size 64 --sheet 4 --out old.png",
        "report results --out old.html",
    ],
)
def test_an_output_that_cannot_grow_leaves_the_old_file(
    command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    if "mp4" in command:
        pytest.importorskip("imageio_ffmpeg", reason="needs the extra `explore`")
    if command.startswith("report"):
        assert invoke([*RUN, "--seeds", "1"]) == 0
    old = next(Path(word) for word in command.split() if word.startswith("old."))
    old.write_text("before")
    before = files()
    with file_size_limit(700):
        assert invoke(command.split()) == 1
    lines = capsys.readouterr().err.splitlines()
    assert lines[-1].startswith("kswarms: ")
    assert len(lines) == 1
    assert files() == before
    if command.startswith("film"):
        assert invoke(command.split()) == 0
        assert old.read_bytes() != b"before"


def test_contributions_that_cannot_grow_leave_the_old_table(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["contribution", "tiny.toml", "--condition", "", "--n", "4", "--seeds", "2", "--jobs", "1"]
    assert invoke([*words, "--robots", "0"]) == 0
    before = files()
    capsys.readouterr()
    for size in (100, 8_000):  # of the table, of the figure
        with file_size_limit(size):
            assert invoke([*words, "--robots", "1"]) == 1
        (line,) = capsys.readouterr().err.splitlines()
        assert line.startswith("kswarms: ")
        after = files()
        assert after.keys() == before.keys()
        if size == 100:
            assert after == before
