"""Play runs through an executor (`concurrent.futures.Executor`)."""

from collections import deque
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future
from queue import Empty, SimpleQueue
from time import monotonic
from typing import Any, Final

from kswarms.scenarios.runs.outcome import Failure, Outcome
from kswarms.scenarios.runs.run import Run

WATCH_EVERY: Final = 5.0
"""Time between two calls of `watch` (s)."""


def count_workers(executor: Executor) -> int:
    """Return the present number of workers of an executor, by an attribute of it; 0 if it has none."""
    # The executors of Python and loky have the second attribute, that of mpi4py has the first.
    counts = (getattr(executor, name, None) for name in ("num_workers", "_max_workers"))
    return next((count for count in counts if isinstance(count, int)), 0)


def play_through(
    executor: Executor,
    waiting: deque[Run],
    at_once: Callable[[], int],
    task: Callable[[Run], tuple[Outcome | Failure, float]],
    watch: Callable[[Sequence[Run]], None] | None = None,
) -> Generator[tuple[Run, Outcome | Failure | None, float], None, None]:
    """Play runs through an executor, at most `at_once` at a time; yield run, result and CPU time (s).

    If the executor breaks, the result of each unfinished submitted run is None. Other runs stay in `waiting`.

    Parameters
    ----------
    task : callable
        Plays a run in a worker.
    watch : callable, optional
        Is called with the running runs at intervals.
    """
    ended: SimpleQueue[Future[Any]] = SimpleQueue()
    playing: dict[Future[Any], Run] = {}
    broken = False
    watched = monotonic()
    while True:
        while waiting and not broken and len(playing) < at_once():
            try:
                future = executor.submit(task, waiting[0])
            except BrokenExecutor:
                broken = True
            else:
                playing[future] = waiting.popleft()
                future.add_done_callback(ended.put)
        if not playing:
            return
        if watch is not None and monotonic() >= watched + WATCH_EVERY:
            watched = monotonic()
            watch([run for future, run in playing.items() if future.running()])
        try:
            future = ended.get(timeout=WATCH_EVERY)
        except Empty:
            continue
        run = playing.pop(future)
        error = CancelledError() if future.cancelled() else future.exception()
        if isinstance(error, BrokenExecutor | CancelledError):
            broken = True
            yield run, None, 0.0
        elif error is not None:  # the run or its result could not be pickled, for example
            yield run, Failure.of(error), 0.0
        else:
            yield run, *future.result()
