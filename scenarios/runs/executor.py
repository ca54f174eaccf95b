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
    """Play runs through an executor, at most `at_once` at a time; yield run, result and CPU time (s).

    If the executor breaks, the result of each unfinished submitted run is None. Other runs stay in `waiting`.
    """
    ended: SimpleQueue[Future[Any]] = SimpleQueue()
    playing: dict[Future[Any], Run] = {}
    broken = False
    while True:
        while waiting and len(playing) < at_once and not broken:
            try:
                future = executor.submit(attempt, waiting[0], record, code_version())
            except BrokenExecutor:
                broken = True
            else:
                playing[future] = waiting.popleft()
                future.add_done_callback(ended.put)
        if not playing:
            return
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
