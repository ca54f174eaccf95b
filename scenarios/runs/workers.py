"""Worker processes of this machine, and a time limit for their work."""

import faulthandler
import os
import signal
import threading
from collections.abc import Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import active_children, get_context, parent_process
from multiprocessing.synchronize import Event
from typing import Any, Final

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.signals import deferred_signals

EXIT_TIMEOUT: Final = 5.0
"""Time that workers have to exit, and user-defined code to handle its `TimeLimitError`, before a kill (s)."""


BLOCKED_AFTER: Final = 60.0
"""Time beyond a limit after which a worker counts as blocked, for example stopped by a signal (s)."""


class Workers(ProcessPoolExecutor):
    """An executor of `jobs` new worker processes."""

    def __init__(self, jobs: int) -> None:
        context = get_context("spawn")
        self._jobs = jobs
        self._others = set(active_children())
        with _blocked_signals():  # the process that tracks resources starts here
            self._started = context.Event()
        super().__init__(jobs, context, _start_worker, (self._started,))

    def submit(self, *arguments: Any, **options: Any) -> Future[Any]:
        """Submit a call."""
        with _blocked_signals():  # processes start here
            return super().submit(*arguments, **options)

    def require_started(self) -> None:
        """Raise an `InputError` if no process has started, as in a script that starts its workers again."""
        if not self._started.is_set():
            reason = 'none started: is `if __name__ == "__main__"` missing?'
            raise InputError("jobs", self._jobs, f"needs worker processes, and {reason}")

    def kill(self) -> None:
        """Kill the processes, which breaks the executor."""
        for worker in set(active_children()) - self._others:
            worker.kill()


@contextmanager
def new_workers(jobs: int) -> Iterator[Workers]:
    """Yield an executor with new worker processes; they have ended when the context is left."""
    executor = Workers(jobs)
    try:
        yield executor
    except BaseException:
        # After Ctrl-C, or when the caller stops: do not wait for games that may take minutes.
        with deferred_signals():
            executor.kill()
        raise
    finally:
        # Threads or exit handlers of user-defined code may hang.
        killer = threading.Timer(EXIT_TIMEOUT, executor.kill)
        killer.start()
        executor.shutdown(cancel_futures=True)
        killer.cancel()


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


class TimeLimitError(BaseException):
    """A time limit was exceeded. It is no `Exception`, so that user-defined code rarely catches it."""


@contextmanager
def time_limit(seconds: float | None) -> Iterator[None]:
    """Raise a `TimeLimitError` in the context after some time by the clock; without `seconds`, do nothing.

    If the error does not end the work, for example within compiled code, the process is killed soon after.
    Only the main thread of a process can have a limit.
    """
    if seconds is None:
        yield
        return

    def stop(*_: object) -> None:
        raise TimeLimitError(f"took longer than {seconds:g} s")

    previous = signal.signal(signal.SIGALRM, stop)
    with open(os.devnull, "w", encoding="utf-8") as nowhere:  # noqa: PTH123  # of os.devnull
        faulthandler.dump_traceback_later(seconds + EXIT_TIMEOUT, exit=True, file=nowhere)
        signal.setitimer(signal.ITIMER_REAL, seconds)
        try:
            try:
                yield
            finally:
                signal.setitimer(signal.ITIMER_REAL, 0)
        finally:  # also if the signal arrives just before its timer is stopped
            faulthandler.cancel_dump_traceback_later()
            signal.signal(signal.SIGALRM, previous)
