"""Play runs in worker processes of this machine, replaced at intervals and when one dies."""

import os
import signal
import threading
from collections import Counter, deque
from collections.abc import Generator, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import active_children, get_context, parent_process
from multiprocessing.synchronize import Event
from typing import Any, Final

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.runs.executor import play_through
from kswarms.scenarios.runs.outcome import Failure, Result
from kswarms.scenarios.runs.run import Run
from kswarms.scenarios.signals import deferred_signals

GAMES_PER_WORKER: Final = 2500
"""Games per worker before it is replaced. Mesa keeps memory of each game, so workers grow."""
MAX_DEATHS: Final = 3
"""A run fails when it was retried alone this many times and its worker died each time."""


def play_in_processes(waiting: deque[Run], jobs: int, record: str) -> Generator[Result, None, None]:
    """Play runs in `jobs` worker processes, and yield each result as its run ends.

    If a worker dies, its executor breaks. Any submitted run may be the cause, by its use of memory for
    example. So all submitted runs are retried one at a time.
    """
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
        with _new_workers(workers) as (executor, started):
            for run, result, seconds in play_through(executor, batch, at_once, record):
                if result is not None:
                    yield run, result, seconds
                    continue
                if not started.is_set():
                    reason = 'none started: is `if __name__ == "__main__"` missing?'
                    raise InputError("jobs", jobs, f"needs worker processes, and {reason}")
                if alone:
                    deaths[run.digest] += 1
                if deaths[run.digest] < MAX_DEATHS:
                    suspects.appendleft(run)
                else:
                    error = f"its worker process died {MAX_DEATHS} times: killed or out of memory?"
                    yield run, Failure(error), 0.0
        if not alone:
            waiting.extendleft(reversed(batch))


@contextmanager
def _new_workers(jobs: int) -> Iterator[tuple[Executor, Event]]:
    """Yield an executor with new processes, and an event that is set when one of them has started."""
    others = set(active_children())
    context = get_context("spawn")
    with _blocked_signals():  # the process that tracks resources starts here
        started = context.Event()
    executor = _Workers(jobs, context, _start_worker, (started,))
    try:
        yield executor, started
    except BaseException:
        # After Ctrl-C, or when the caller stops: do not wait for games that may take minutes.
        with deferred_signals():
            for worker in set(active_children()) - others:
                worker.terminate()
        raise
    finally:
        executor.shutdown(cancel_futures=True)


class _Workers(ProcessPoolExecutor):
    def submit(self, *arguments: Any, **options: Any) -> Future[Any]:
        with _blocked_signals():  # processes start here
            return super().submit(*arguments, **options)


@contextmanager
def _blocked_signals() -> Iterator[None]:
    """Block Ctrl-C and SIGHUP, which a terminal sends to all processes, in processes that start here.

    Processes inherit the signal mask, so only the parent handles these signals.
    """
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT, signal.SIGHUP])
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)


def _start_worker(started: Event) -> None:
    started.set()
    threading.Thread(target=_exit_with_parent, daemon=True).start()


def _exit_with_parent() -> None:
    """End this process when its parent ends, even if the parent is killed."""
    if (parent := parent_process()) is not None:
        parent.join()
        os._exit(1)
