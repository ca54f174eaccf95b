"""Progress of long work on standard error: a bar, lines of JSON, or nothing."""

import json
import sys
import time
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from contextlib import closing, contextmanager, suppress
from typing import Any, Final, Literal, TextIO, TypeVar, cast

import typer

from kswarms.scenarios.cli.printing import format_duration
from kswarms.scenarios.runs.outcome import Failure, Outcome, Result
from kswarms.scenarios.runs.run import Run

ProgressStyle = Literal["bar", "json", "none"]

_Step = TypeVar("_Step")

_LINE_EVERY: Final = 1.0
"""Minimum time between two lines of JSON (s)."""


class _Lossy:
    """A text stream without errors, so that work continues if the terminal is closed."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        with suppress(OSError):
            self._stream.write(text)
        return len(text)

    def flush(self) -> None:
        with suppress(OSError):
            self._stream.flush()


def _standard_error() -> TextIO:
    return cast(TextIO, _Lossy(sys.stderr))


class Count:
    """Progress of a sweep. Long runs come first, so the time left is estimated from their CPU time."""

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


def show_progress(played: Iterable[Result], runs: Sequence[Run], style: ProgressStyle) -> Iterator[Count]:
    """Show the progress of a sweep on standard error; yield the count after each played run."""
    count = Count(runs)
    show = {"bar": _bar, "json": _json_lines, "none": _no_progress}[style if runs else "none"]
    with show(count) as report:
        for run, result, _ in played:
            count.add(run, isinstance(result, Failure))
            report(run.labels[0][0])
            yield count


@contextmanager
def _no_progress(_: Count) -> Iterator[Callable[[str], None]]:
    yield lambda _: None


@contextmanager
def _json_lines(count: Count) -> Iterator[Callable[[str], None]]:
    printed_at = -_LINE_EVERY

    def report(scenario: str) -> None:
        nonlocal printed_at
        if time.monotonic() >= printed_at + _LINE_EVERY or count.done == count.total:
            printed_at = time.monotonic()
            line: dict[str, Any] = {"done": count.done, "failed": count.failed, "total": count.total}
            line |= {"runs_per_second": round(count.rate, 3), "seconds_left": round(count.left, 1)}
            typer.echo(json.dumps(line | {"scenario": scenario}), _standard_error())

    yield report


@contextmanager
def _bar(count: Count) -> Iterator[Callable[[str], None]]:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn

    state = TextColumn("{task.fields[state]}", markup=False)
    with Progress(
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        state,
        console=Console(file=_standard_error()),
    ) as progress:
        task = progress.add_task("starting", total=count.work, state=f"0/{count.total} runs")

        def report(scenario: str) -> None:
            failed = f" ({count.failed} failed)" if count.failed else ""
            state = f"{count.done}/{count.total}{failed} runs, {count.rate:.3g}/s, "
            state += f"{format_duration(count.left)} left"
            progress.update(task, completed=count.worked, description=scenario, state=state)

        yield report


def play_tracked(
    runs: Sequence[Run], jobs: int, record: str, label: str, run_limit: float | None = None
) -> Generator[tuple[Run, Outcome], None, None]:
    """Play runs, as `kswarms.scenarios.runs.sweep.play_all` does, and show a progress bar."""
    from kswarms.scenarios.runs.sweep import play_all

    with closing(play_all(runs, jobs, record, run_limit=run_limit)) as played:
        yield from track(played, label, len(runs))


def track(steps: Iterable[_Step], label: str, total: int) -> Iterable[_Step]:
    """Yield `total` steps and show a progress bar on standard error if that is a terminal."""
    from rich import progress
    from rich.console import Console

    console = Console(file=_standard_error())
    hidden = not console.is_terminal
    return progress.track(steps, label, total=total, console=console, transient=True, disable=hidden)
