"""Play many runs in this process, in worker processes or through an executor. The results are equal."""

from collections import deque
from collections.abc import Generator, Sequence
from concurrent.futures import Executor
from contextlib import closing
from functools import partial

from kswarms.scenarios.runs.errors import RunError
from kswarms.scenarios.runs.executor import count_workers, play_through
from kswarms.scenarios.runs.outcome import Failure, Outcome, Result
from kswarms.scenarios.runs.play import attempt, attempt_in_worker
from kswarms.scenarios.runs.processes import play_in_processes
from kswarms.scenarios.runs.run import Order, Run, code_version, sort_runs
from kswarms.scenarios.runs.trial import failed_trials


def sweep(
    runs: Sequence[Run],
    jobs: int = 1,
    record: str = "",
    executor: Executor | None = None,
    run_limit: float | None = None,
    order: Order = "longest",
) -> Generator[Result, None, None]:
    """Play runs like `play_all`, but yield failures instead of raising them, and the CPU time (s)."""
    with_user_code = [run for run in runs if run.game.runs_user_code]
    failed = failed_trials({run.game: None for run in with_user_code}, run_limit)
    for run in with_user_code:
        if run.game in failed:
            yield run, failed[run.game], 0.0
    playable = runs if not failed else [run for run in runs if run.game not in failed]
    waiting = deque(sort_runs(playable, order))
    if executor is not None:
        no_workers = RunError("all workers exited before the sweep finished")
        task = partial(attempt_in_worker, record, code_version(), None)

        def at_once() -> int:
            return 2 * max(jobs, count_workers(executor))

        for run, result, seconds in play_through(executor, waiting, at_once, task):
            if result is None:
                raise no_workers
            yield run, result, seconds
        if waiting:
            raise no_workers
    elif min(jobs, len(runs)) > 1 or with_user_code or run_limit is not None:
        yield from play_in_processes(waiting, jobs, record, run_limit)
    else:
        for run in waiting:
            yield run, *attempt(run, record, code_version())


def play_all(
    runs: Sequence[Run],
    jobs: int = 1,
    record: str = "",
    executor: Executor | None = None,
    run_limit: float | None = None,
) -> Generator[tuple[Run, Outcome], None, None]:
    """Play runs, the longest first, and yield each with its outcome as it ends; stop at the first failure.

    Outcomes are not kept, so memory does not grow with the number of runs. User-defined code is tried first.

    Parameters
    ----------
    jobs : int
        Number of worker processes. With 1, this process plays, except games with user-defined code. An
        executor gets two runs at a time for each of its workers, or 2 × `jobs` runs if this is more or its
        number of workers is unknown.
    record : str
        Names of the tables to record (`RECORDED_TABLES`), separated by commas.
    executor : concurrent.futures.Executor, optional
        Plays the runs in place of worker processes of this machine.
    run_limit : float, optional
        Time limit of each run by the clock (s); not with an executor. A longer run fails.

    Raises
    ------
    RunError
        If a run fails, or the executor breaks.
    """
    with closing(sweep(runs, jobs, record, executor, run_limit)) as results:
        for run, result, _ in results:
            if isinstance(result, Failure):
                raise RunError(f"{run} failed: {result.error}", result.trace)
            yield run, result
