"""How far long work is: a bar for people, of a sweep also lines of JSON for programs, or nothing."""

import json
import sys
import time
from collections.abc import Iterable, Iterator, Sequence
from typing import Final, TypeVar

import typer

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.runs.outcome import Failure, Result
from kswarms.scenarios.runs.run import Run

KINDS: Final = ("bar", "json", "none")

_Step = TypeVar("_Step")

_LINE_EVERY: Final = 1.0
"""Time between two lines of JSON at least (s)."""


class Count:
    """What is done of a sweep. Long runs come first, so time left is told by CPU time, not by runs.

    Parameters
    ----------
    runs : sequence of Run
        All that is to be played.
    """

    def __init__(self, runs: Sequence[Run]) -> None:
        self.total = len(runs)
        self.work = sum(run.effort for run in runs)
        self.done = self.failed = 0
        self.worked = 0.0
        self._started = time.monotonic()

    def add(self, run: Run, failed: bool) -> None:
        """Count a run that ended."""
        self.done += 1
        self.failed += failed
        self.worked += run.effort

    @property
    def rate(self) -> float:
        """Runs per second."""
        return self.done / (time.monotonic() - self._started)

    @property
    def left(self) -> float:
        """Time left, if what is left goes as fast as what is done (s)."""
        passed = time.monotonic() - self._started
        # No less than none: the parts of a sum, added in another order, may exceed it by a rounding error.
        rest = max(0.0, self.work - self.worked)
        return passed * rest / self.worked if self.worked > 0 else float("inf")


def told(played: Iterable[Result], runs: Sequence[Run], kind: str) -> Iterator[Count]:
    """Tell on standard error how far a sweep is, and yield the count after each run.

    Parameters
    ----------
    played : iterable of Result
        The runs as they end.
    runs : sequence of Run
        All that is to be played.
    kind : str
        One of `KINDS`.
    """
    count = Count(runs)
    if not runs:
        kind = "none"  # a bar of nothing says nothing
    tell = {"bar": _bar, "json": _lines, "none": _nothing}[kind]
    return tell(_counted(played, count), count)


def check_kind(kind: str) -> str:
    """Return the kind of progress asked for.

    Raises
    ------
    InputError
        If there is no such kind.
    """
    if kind not in KINDS:
        raise InputError("progress", kind, f"must be one of {', '.join(KINDS)}")
    return kind


def _counted(played: Iterable[Result], count: Count) -> Iterator[Run]:
    for run, result, _ in played:
        count.add(run, isinstance(result, Failure))
        yield run


def _nothing(ended: Iterator[Run], count: Count) -> Iterator[Count]:
    for _ in ended:
        yield count


def _lines(ended: Iterator[Run], count: Count) -> Iterator[Count]:
    told_at = -_LINE_EVERY
    for run in ended:
        if time.monotonic() >= told_at + _LINE_EVERY or count.done == count.total:
            told_at = time.monotonic()
            line = {
                "done": count.done,
                "failed": count.failed,
                "total": count.total,
                "runs_per_second": round(count.rate, 3),
                "seconds_left": round(count.left, 1),
                "scenario": run.labels[0][0],
            }
            typer.echo(json.dumps(line), err=True)
        yield count


def _bar(ended: Iterator[Run], count: Count) -> Iterator[Count]:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.fields[runs]} runs, {task.fields[rate]}/s, {task.fields[left]} left"),
    )
    with Progress(*columns, console=Console(file=sys.stderr)) as progress:
        task = progress.add_task("starting", total=count.work, runs=f"0/{count.total}", rate="–", left="–")
        for run in ended:
            progress.update(
                task,
                completed=count.worked,
                description=run.labels[0][0],
                runs=f"{count.done}/{count.total}" + (f" ({count.failed} failed)" if count.failed else ""),
                rate=f"{count.rate:.3g}",
                left=clock(count.left),
            )
            yield count


def tracked(steps: Iterable[_Step], doing: str, total: int) -> Iterable[_Step]:
    """Yield steps, and show a bar of them on standard error meanwhile, if that is a terminal.

    Parameters
    ----------
    steps : iterable
        What is done, step by step.
    doing : str
        What that is, in a word.
    total : int
        How many there are.
    """
    from rich.console import Console
    from rich.progress import track

    console = Console(stderr=True)
    return track(steps, doing, total=total, console=console, transient=True, disable=not console.is_terminal)


def clock(seconds: float) -> str:
    """Return a time as people say it.

    Examples
    --------
    >>> clock(0.24), clock(75), clock(8337)
    ('0.2 s', '1:15 min', '2:19 h')
    """
    if seconds < 59.95:
        return f"{seconds:.1f} s"
    if seconds < 3599.5:
        return "{}:{:02} min".format(*divmod(round(seconds), 60))
    return "{}:{:02} h".format(*divmod(round(seconds / 60), 60))
