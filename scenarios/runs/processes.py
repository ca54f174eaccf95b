"""Play runs in worker processes of this machine, replaced at intervals and when one dies."""

import logging
from collections import Counter, deque
from collections.abc import Callable, Generator, Sequence
from functools import partial
from time import monotonic
from typing import Final

from kswarms.scenarios.runs.executor import play_through
from kswarms.scenarios.runs.outcome import Failure, Result
from kswarms.scenarios.runs.play import attempt_in_worker
from kswarms.scenarios.runs.run import Run, code_version
from kswarms.scenarios.runs.workers import EXIT_TIMEOUT, new_workers

GAMES_PER_WORKER: Final = 2500
"""Games per worker before it is replaced. Mesa keeps memory of each game, so workers grow."""
MAX_DEATHS: Final = 3
"""A run fails when it was retried alone this many times and its worker died each time."""
HINT_AFTER: Final = 60.0
"""Minimum time of a run before a time limit is suggested (s)."""
_HINT_FACTOR: Final = 20
"""Minimum ratio of that time to the estimate."""


def play_in_processes(
    waiting: deque[Run], jobs: int, record: str, run_limit: float | None = None
) -> Generator[Result, None, None]:
    """Play runs in `jobs` worker processes, and yield each result as its run ends.

    If a worker dies, its executor breaks. Any submitted run may be the cause, by its use of memory for
    example. So all submitted runs are retried one at a time. A run fails after `run_limit` seconds.
    """
    task = partial(attempt_in_worker, record, code_version(), run_limit)
    watch = suggest_limit() if run_limit is None else None
    suspects: deque[Run] = deque()  # submitted runs of broken executors
    deaths: Counter[str] = Counter()
    while waiting or suspects:
        alone = bool(suspects)  # retry one run at a time
        if alone:
            batch, workers, at_once = suspects, 1, 1
        else:
            # `max_tasks_per_child` of the executor hangs in Python 3.11, so each batch has a new executor.
            size = min(len(waiting), jobs * GAMES_PER_WORKER)
            batch, workers, at_once = deque(waiting.popleft() for _ in range(size)), jobs, 2 * jobs
        with new_workers(workers) as executor:
            began = monotonic()
            for run, result, seconds in play_through(executor, batch, partial(int, at_once), task, watch):
                if result is not None:
                    yield run, result, seconds
                    began = monotonic()
                    continue
                executor.require_started()
                if alone:
                    deaths[run.digest] += 1
                took = monotonic() - began
                if alone and run_limit is not None and took > run_limit + EXIT_TIMEOUT:
                    yield run, Failure(f"took longer than {run_limit:g} s; its worker was killed"), 0.0
                elif deaths[run.digest] < MAX_DEATHS:
                    suspects.appendleft(run)
                else:
                    error = f"its worker process died {MAX_DEATHS} times: killed or out of memory?"
                    yield run, Failure(error), 0.0
        if not alone:
            waiting.extendleft(reversed(batch))


def suggest_limit() -> Callable[[Sequence[Run]], None]:
    """Return a `watch` of `play_through` that suggests a time limit for the first long run."""
    began: dict[str, float] = {}
    suggested = False

    def watch(running: Sequence[Run]) -> None:
        nonlocal suggested
        for run in running:
            seconds = monotonic() - began.setdefault(run.digest, monotonic())
            if not suggested and seconds > max(HINT_AFTER, _HINT_FACTOR * run.effort):
                suggested = True
                times = f"{seconds:.0f} s, over {_HINT_FACTOR} times its estimate"
                logging.getLogger(__name__).warning(
                    "kswarms: %s takes %s; --run-limit SECONDS ends such runs", run, times
                )

    return watch
