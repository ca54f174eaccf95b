"""Processes on this machine that play runs, replaced by new ones now and then, and when one dies."""

import os
import signal
import threading
from collections import Counter, deque
from collections.abc import Generator, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import active_children, get_context, parent_process
from multiprocessing.synchronize import Event
from typing import Any, Final

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.runs.run import Run
from kswarms.scenarios.runs.sweep import Failure, Outcome, Result, play_through

GAMES_A_WORKER: Final = 2500
"""Games after which worker processes are replaced by new ones."""

TRIES: Final = 3
"""A run during which a worker process died is tried so often in all."""


def in_processes(waiting: deque[Run], jobs: int, record: str) -> Generator[Result, None, None]:
    """Play runs in processes of this machine.

    A process that is killed breaks the executor, and which of the runs then played killed it (that took
    too much memory, say) cannot be told. So these are tried again, one at a time.

    Parameters
    ----------
    waiting : deque of Run
        What is played, in order.
    jobs : int
        Number of processes.
    record : str
        Names of the tables to record, separated by commas.

    Raises
    ------
    InputError
        If no process comes up, since each would run the calling script anew.
    """
    # Fresh workers for each portion bound what Mesa leaves behind in a process. The executor's own
    # `max_tasks_per_child` hangs in Python 3.11 (CPython issue 115634).
    while waiting:
        portion = deque(waiting.popleft() for _ in range(min(len(waiting), jobs * GAMES_A_WORKER)))
        suspects: deque[Run] = deque()
        for run, result, seconds in _in_fresh_processes(portion, jobs, 2 * jobs, record):
            if result is None:
                suspects.append(run)
            else:
                yield run, result, seconds
        waiting.extendleft(reversed(portion))
        yield from _one_at_a_time(suspects, record)


def _one_at_a_time(suspects: deque[Run], record: str) -> Generator[Result, None, None]:
    tries = Counter(run.digest for run in suspects)
    while suspects:
        for run, result, seconds in _in_fresh_processes(suspects, 1, 1, record):
            tries[run.digest] += 1
            if result is not None:
                yield run, result, seconds
            elif tries[run.digest] < TRIES:
                suspects.appendleft(run)
            else:
                yield (
                    run,
                    Failure(f"a worker process died during it, {TRIES} times: killed, or short of memory?"),
                    0.0,
                )


def _in_fresh_processes(
    waiting: deque[Run], jobs: int, at_once: int, record: str
) -> Generator[tuple[Run, Outcome | Failure | None, float], None, None]:
    others = set(active_children())
    context = get_context("spawn")
    started = context.Event()
    executor = _Processes(jobs, context, _begin, (started,))
    try:
        for run, result, seconds in play_through(executor, waiting, at_once, record):
            if result is None and not started.is_set():
                guard = 'if __name__ == "__main__"'
                raise InputError("jobs", jobs, f"needs processes, and none came up: is there no {guard}?")
            yield run, result, seconds
    except BaseException:
        # Ctrl-C, or nobody wants the rest: do not wait for games that may take minutes.
        for worker in set(active_children()) - others:
            worker.terminate()
        raise
    finally:
        executor.shutdown(cancel_futures=True)


class _Processes(ProcessPoolExecutor):
    def submit(self, *arguments: Any, **options: Any) -> Future[Any]:
        # Submitting starts the workers, and they inherit the mask: Ctrl-C, which a terminal sends to them
        # too, is left to this process from their first moment on.
        with _interrupts_held():
            return super().submit(*arguments, **options)


@contextmanager
def _interrupts_held() -> Iterator[None]:
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)


def _begin(started: Event) -> None:
    """Say that this worker came up, and let it end when its parent does, even if that is killed."""
    started.set()
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
