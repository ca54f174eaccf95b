"""Play runs in worker processes of this machine, replaced at intervals and when one dies."""

import logging
from collections import Counter, deque
from collections.abc import Generator, Sequence
from functools import partial
from time import monotonic
from typing import Final

from kswarms.scenarios.runs.executor import play_through
from kswarms.scenarios.runs.outcome import Failure, Result
from kswarms.scenarios.runs.play import attempt_in_worker, compile_kernel
from kswarms.scenarios.runs.run import Run, code_version
from kswarms.scenarios.runs.workers import BLOCKED_AFTER, EXIT_TIMEOUT, Workers, new_workers

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
    compile_kernel()
    task = partial(attempt_in_worker, record, code_version(), run_limit)
    watch = Watch(run_limit)
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
            for run, result, seconds in play_through(
                executor, batch, partial(int, at_once), task, partial(watch, executor)
            ):
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


class Watch:
    """Reaction to long runs: suggest a time limit once; if there is one, kill workers that are blocked."""

    def __init__(self, run_limit: float | None) -> None:
        self._run_limit = run_limit
        self._began: dict[str, float] = {}
        self._suggested = False

    def __call__(self, executor: Workers, running: Sequence[Run]) -> None:
        """Look at the running runs; one more than there are workers may still wait for a worker."""
        self._began = {run.digest: self._began.get(run.digest, monotonic()) for run in running}
        for run in running:
            seconds = monotonic() - self._began[run.digest]
            if self._run_limit is None:
                self._suggest_limit(run, seconds)
            elif seconds > 2 * self._run_limit + BLOCKED_AFTER:
                executor.kill()
                return

    def _suggest_limit(self, run: Run, seconds: float) -> None:
        if not self._suggested and seconds > max(HINT_AFTER, _HINT_FACTOR * run.effort):
            self._suggested = True
            times = f"{seconds:.0f} s, over {_HINT_FACTOR} times its estimate"
            logging.getLogger(__name__).warning(
                "kswarms: %s takes %s; --run-limit SECONDS ends such runs", run, times
            )
