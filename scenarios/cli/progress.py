"""Progress of long work on standard error: a bar, lines of JSON, or nothing."""

import json
import sys
import time
from collections.abc import Iterable, Iterator, Sequence
from typing import Final, Literal, TypeVar

import typer

from kswarms.scenarios.cli.printing import format_duration
from kswarms.scenarios.runs.outcome import Failure, Result
from kswarms.scenarios.runs.run import Run

Kind = Literal["bar", "json", "none"]

_Step = TypeVar("_Step")

_LINE_EVERY: Final = 1.0
"""Minimum time between two lines of JSON (s)."""


class Count:
    """Progress of a sweep. Long runs come first, so the time left is estimated from CPU time, not from runs.

    Parameters
    ----------
    runs : sequence of Run
        All runs of the sweep.
    """

    def __init__(self, runs: Sequence[Run]) -> None:
        self.total = len(runs)
        self.work = sum(run.effort for run in runs)
        self.done = self.failed = 0
        self.worked = 0.0
        self._started = time.monotonic()

    def add(self, run: Run, failed: bool) -> None:
        """Count a finished run."""
        self.done += 1
        self.failed += failed
        self.worked += run.effort

    @property
    def rate(self) -> float:
        """Runs per second."""
        return self.done / (time.monotonic() - self._started)

    @property
    def left(self) -> float:
        """Estimated time left (s)."""
        passed = time.monotonic() - self._started
        rest = max(0.0, self.work - self.worked)  # rounding errors can make it negative
        return passed * rest / self.worked if self.worked > 0 else float("inf")


def show_progress(played: Iterable[Result], runs: Sequence[Run], kind: Kind) -> Iterator[Count]:
    """Show the progress of a sweep on standard error; yield the count after each run.

    Parameters
    ----------
    played : iterable of Result
        Runs as they finish.
    runs : sequence of Run
        All runs of the sweep.
    kind : {'bar', 'json', 'none'}
        How; nothing is shown without runs.
    """
    count = Count(runs)
    show = {"bar": _bar, "json": _lines, "none": _nothing}[kind if runs else "none"]
    return show(_counted(played, count), count)


def _counted(played: Iterable[Result], count: Count) -> Iterator[Run]:
    for run, result, _ in played:
        count.add(run, isinstance(result, Failure))
        yield run


def _nothing(ended: Iterator[Run], count: Count) -> Iterator[Count]:
    for _ in ended:
        yield count


def _lines(ended: Iterator[Run], count: Count) -> Iterator[Count]:
    printed_at = -_LINE_EVERY
    for run in ended:
        if time.monotonic() >= printed_at + _LINE_EVERY or count.done == count.total:
            printed_at = time.monotonic()
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
                left=format_duration(count.left),
            )
            yield count


def track(steps: Iterable[_Step], doing: str, total: int) -> Iterable[_Step]:
    """Yield steps and show a progress bar on standard error if that is a terminal.

    Parameters
    ----------
    steps : iterable
        The steps.
    doing : str
        Label of the bar.
    total : int
        Number of steps.
    """
    from rich import progress
    from rich.console import Console

    console = Console(stderr=True)
    return progress.track(
        steps, doing, total=total, console=console, transient=True, disable=not console.is_terminal
    )
