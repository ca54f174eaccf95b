"""Play runs through an executor (`concurrent.futures.Executor`)."""

from collections import deque
from collections.abc import Generator
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future
from queue import SimpleQueue
from typing import Any

from kswarms.scenarios.runs.outcome import Failure, Outcome
from kswarms.scenarios.runs.play import attempt
from kswarms.scenarios.runs.run import Run, code_version


def play_through(
    executor: Executor, waiting: deque[Run], at_once: int, record: str
) -> Generator[tuple[Run, Outcome | Failure | None, float], None, None]:
    """Play runs through an executor, and yield each as it ends.

    Parameters
    ----------
    executor : concurrent.futures.Executor
        Plays the runs.
    waiting : deque of Run
        The runs, in order. If the executor breaks, those that it had not accepted remain.
    at_once : int
        Maximum number of runs submitted at the same time.
    record : str
        Names of the tables to record, separated by commas.

    Yields
    ------
    run : Run
        A run that ended.
    result : Outcome, Failure or None
        Its result; None if the executor broke during the run.
    seconds : float
        Its CPU time (s).
    """
    ended: SimpleQueue[Future[Any]] = SimpleQueue()
    playing: dict[Future[Any], Run] = {}
    broken = False
    while playing or (waiting and not broken):
        while waiting and len(playing) < at_once and not broken:
            try:
                future = executor.submit(attempt, waiting[0], record, code_version())
            except BrokenExecutor:
                broken = True
            else:
                playing[future] = waiting.popleft()
                future.add_done_callback(ended.put)
        if not playing:
            break
        future = ended.get()
        run = playing.pop(future)
        error = CancelledError() if future.cancelled() else future.exception()
        if isinstance(error, BrokenExecutor | CancelledError):
            broken = True
            yield run, None, 0.0
        elif error is not None:  # the run or its result could not be pickled, for example
            yield run, Failure.of(error), 0.0
        else:
            yield run, *future.result()
