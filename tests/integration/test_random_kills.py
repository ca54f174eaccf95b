"""Commands that are killed or interrupted at random moments: repeated, they give the same tables."""

import os
import random
import shutil
import signal
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from kswarms.scenarios.cli import invoke
from kswarms.scenarios.study.study import Study
from tests.helpers.tiny_study import RUN, TABLES, TINY, read_sessions, read_tables, uninterrupted_tables

pytestmark = pytest.mark.usefixtures("tiny_file")

SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGHUP, signal.SIGINT)


def end_after(delay: float, number: signal.Signals, words: Sequence[str]) -> int:
    """Send a signal to a command after some seconds; return its exit status, negative if it was killed."""
    reader, writer = os.pipe()
    child = os.fork()  # a new process would spend most of the moments on its imports
    if child == 0:
        status = 1
        try:
            os.write(writer, b"started")
            status = invoke(words)
        except KeyboardInterrupt:  # before or after the command
            status = 130
        finally:
            os._exit(status)
    os.read(reader, 1)  # not within `fork`, where Python would ignore Ctrl-C
    os.close(reader)
    os.close(writer)
    time.sleep(delay)
    os.kill(child, number)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def count_runs(directory: str) -> int:
    """Return the number of runs in the tables of a directory."""
    path = Path(directory, "runs.parquet")
    return len(set(pq.read_table(path)["run"].to_pylist())) if path.exists() else 0


def seconds(words: Sequence[str]) -> float:
    started = time.monotonic()
    assert invoke(words) == 0
    return time.monotonic() - started


def moments(number: int, length: float) -> Iterator[tuple[float, signal.Signals]]:
    """Yield random moments within a duration, with the signals in turn."""
    draws = random.Random(number)
    for k in range(number):
        yield (k + draws.random()) / number * length, SIGNALS[k % len(SIGNALS)]


@pytest.mark.parametrize("number", [4, pytest.param(104, marks=pytest.mark.full)])
def test_a_sweep_ended_at_any_moment_resumes_to_the_same_tables(number: int) -> None:
    whole = uninterrupted_tables()
    length = seconds([*RUN, "--out", "again"])
    finished = []
    for moment, (delay, sent) in enumerate(moments(number, length)):
        directory = f"ended-{moment}"
        words = [*RUN, "--out", directory]
        status = end_after(delay, sent, words)
        assert status in (0, -sent, 128 + sent)
        stored = count_runs(directory)
        assert invoke(words) == 0
        assert read_tables(directory) == whole
        finished.append(read_sessions(directory)[-1]["runs"]["done before"])
        assert stored <= finished[-1] if status == -sent else stored == finished[-1]
        assert read_sessions(directory)[-1]["status"] == "done"
        assert not list(Path(directory).glob(".unfinished*"))
        shutil.rmtree(directory)
    assert number < 100 or len(set(finished)) > 2, "all moments were before the first run or after the last"


@pytest.mark.parametrize("number", [4, pytest.param(40, marks=pytest.mark.full)])
def test_a_merge_ended_at_any_moment_is_repeated_to_the_same_tables(number: int) -> None:
    whole = uninterrupted_tables()
    for part in ("1", "2"):
        assert invoke([*RUN, "--shard", f"{part}/2", "--out", part]) == 0
    words = ["merge", "all", "1", "2"]
    for delay, sent in moments(number, seconds(words)):
        shutil.rmtree("all")
        assert end_after(delay, sent, words) in (0, -sent, 128 + sent)
        assert invoke(words) == 0
        assert read_tables("all") == whole
        assert not list(Path("all").glob(".unfinished*"))


@pytest.mark.parametrize("number", [4, pytest.param(40, marks=pytest.mark.full)])
def test_an_export_ended_at_any_moment_replaces_all_tables_or_none(number: int) -> None:
    assert invoke([*RUN, "--seeds", "5"]) == 0
    old = read_tables("results")
    with Study(Path("results")) as study:
        list(study.play(study.plan([TINY], records=["robots"]), records=["robots"]))
    new = read_tables("results")
    for delay, sent in moments(number, seconds(["export", "results"])):
        for name, content in zip(TABLES, old, strict=True):
            Path("results", name).write_bytes(content)
        assert end_after(delay, sent, ["export", "results"]) in (0, -sent, 128 + sent)
        assert read_tables("results") in (old, new)
        assert invoke(["export", "results"]) == 0
        assert read_tables("results") == new
        assert not list(Path("results").glob(".unfinished*"))
