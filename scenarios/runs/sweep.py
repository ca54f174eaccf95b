"""Play many runs in this process, in worker processes or through an executor. The results are equal."""

from collections import deque
from collections.abc import Generator, Sequence
from concurrent.futures import Executor
from contextlib import closing

from kswarms.scenarios.runs.errors import RunError
from kswarms.scenarios.runs.executor import play_through
from kswarms.scenarios.runs.outcome import Failure, Outcome, Result
from kswarms.scenarios.runs.play import attempt
from kswarms.scenarios.runs.processes import play_in_processes
from kswarms.scenarios.runs.run import Run, code_version


def sweep(
    runs: Sequence[Run], jobs: int = 1, record: str = "", executor: Executor | None = None
) -> Generator[Result, None, None]:
    """Play runs like `play_all`, but yield failures instead of raising them, and the CPU time (s)."""
    waiting = deque(sorted(runs, key=lambda run: run.effort, reverse=True))
    if executor is not None:
        no_workers = RunError("all workers exited before the sweep finished")
        for run, result, seconds in play_through(executor, waiting, 2 * jobs, record):
            if result is None:
                raise no_workers
            yield run, result, seconds
        if waiting:
            raise no_workers
    elif min(jobs, len(runs)) > 1:
        yield from play_in_processes(waiting, jobs, record)
    else:
        for run in waiting:
            yield run, *attempt(run, record, code_version())


def play_all(
    runs: Sequence[Run], jobs: int = 1, record: str = "", executor: Executor | None = None
) -> Generator[tuple[Run, Outcome], None, None]:
    """Play runs, the longest first, and yield each with its outcome as it ends; stop at the first failure.

    Outcomes are not kept, so memory does not grow with the number of runs.

    Parameters
    ----------
    jobs : int
        Number of worker processes; with 1, this process plays. An executor gets 2 × `jobs` runs at a time.
    record : str
        Names of the tables to record (`RECORDED_TABLES`), separated by commas.
    executor : concurrent.futures.Executor, optional
        Plays the runs in place of worker processes of this machine.

    Raises
    ------
    RunError
        If a run fails, or the executor breaks.
    """
    with closing(sweep(runs, jobs, record, executor)) as results:
        for run, result, _ in results:
            if isinstance(result, Failure):
                raise RunError(f"{run} failed: {result.error}", result.trace)
            yield run, result
