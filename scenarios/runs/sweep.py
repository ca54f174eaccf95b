"""Plays runs: in this process, in several, or wherever an executor leads; the results are the same."""

import time
import traceback
from collections import deque
from collections.abc import Generator, Iterator, Sequence
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future
from contextlib import closing, contextmanager
from dataclasses import dataclass
from queue import SimpleQueue
from typing import Any, Final

from kswarms.scenarios.runs.run import Run, code_version, require_unchanged

_GONE: Final = "the workers are gone before all was played"


class RunError(RuntimeError):
    """A run, named in the message, could not be played to its end.

    Parameters
    ----------
    message : str
        Which run, and why.
    trace : str
        Where in the program, as Python prints it.
    """

    def __init__(self, message: str, trace: str = "") -> None:
        super().__init__(message)
        self.trace = trace


@dataclass(frozen=True)
class Outcome:
    """What came out of a run.

    Attributes
    ----------
    swarms : list of dict
        One row of results for each swarm.
    policies : list of dict
        What the swarms learned: one row for each swarm that learns, swarm learned about and action.
    records : dict of str to dict of str to list
        The recorded tables asked for: columns by name.
    """

    swarms: list[dict[str, Any]]
    policies: list[dict[str, Any]]
    records: dict[str, dict[str, list[Any]]]


@dataclass(frozen=True)
class Failure:
    """Why there is no outcome.

    Attributes
    ----------
    error : str
        The error, in a line.
    trace : str
        Where in the program, as Python prints it; empty if the program did not get to say so.
    """

    error: str
    trace: str = ""


Result = tuple[Run, Outcome | Failure, float]
"""A run, what came out of it, and the CPU time it took (s)."""


def play(run: Run, record: str = "") -> Outcome:
    """Play one run.

    Parameters
    ----------
    run : Run
        What is played.
    record : str
        Names of the tables to record, separated by commas.

    Raises
    ------
    RunError
        If the game fails; the message says which.
    """
    # Here, since it takes over a second and only what plays needs it.
    from kswarms.model.game_model import GameModel
    from kswarms.model.recorder import policy_rows

    model = None
    try:
        with naming(name_of(run)):
            require_unchanged(run)
            model = GameModel(run.game, seed=run.seed, record=record)
            model.play()
            return Outcome(model.results(), policy_rows(model), model.tables())
    finally:
        if model is not None:
            model.forget()


@contextmanager
def naming(played: str) -> Iterator[None]:
    """Say of whatever goes wrong what was played: a policy of a user's own may fail in any way.

    Parameters
    ----------
    played : str
        What is played, as `name_of` says it.

    Raises
    ------
    RunError
        If anything goes wrong.
    """
    try:
        yield
    except (Exception, SystemExit) as error:  # which code of a user's own may raise
        raise RunError(f"{played} failed: {_line(error)}", traceback.format_exc()) from error


def attempt(run: Run, record: str, code: str) -> tuple[Outcome | Failure, float]:
    """Play one run, and return a failure as what came out of it.

    Parameters
    ----------
    run, record
        As for `play`.
    code : str
        The code that is to play it, as `code_version` gives it. On a cluster, a worker may have another.

    Returns
    -------
    outcome : Outcome or Failure
        What came out.
    seconds : float
        CPU time (s).
    """
    if code != code_version():
        return Failure(f"the worker has kswarms {code_version()}, it must have {code}"), 0.0
    started = time.thread_time()
    result: Outcome | Failure
    try:
        result = play(run, record)
    except RunError as error:
        result = Failure(_line(error.__cause__ or error), error.trace)
    return result, time.thread_time() - started


def play_all(
    runs: Sequence[Run], jobs: int = 1, record: str = "", executor: Executor | None = None
) -> Generator[tuple[Run, Outcome], None, None]:
    """Play runs, the longest first, and yield each with its outcome as it ends.

    Parameters
    ----------
    runs, jobs, record, executor
        As for `sweep`.

    Raises
    ------
    RunError
        If a game fails or a worker process dies of it.
    """
    with closing(sweep(runs, jobs, record, executor)) as played:
        for run, result, _ in played:
            if isinstance(result, Failure):
                raise RunError(f"{name_of(run)} failed: {result.error}", result.trace)
            yield run, result


def sweep(
    runs: Sequence[Run], jobs: int = 1, record: str = "", executor: Executor | None = None
) -> Generator[Result, None, None]:
    """Play runs, the longest first, and yield each with what came out of it as it ends.

    What has ended is not kept, so the memory that a sweep takes does not grow with it.

    Parameters
    ----------
    runs : sequence of Run
        What is played.
    jobs : int
        How many are played at the same time; an executor has twice as many at hand. Without one, 1 plays
        in this process.
    record : str
        Names of the tables to record, separated by commas.
    executor : concurrent.futures.Executor, optional
        Who plays; by default processes on this machine (`kswarms.scenarios.runs.processes`).

    Raises
    ------
    RunError
        If the executor gives up.
    """
    waiting = deque(sorted(runs, key=lambda run: run.effort, reverse=True))
    if executor is not None:
        for run, result, seconds in play_through(executor, waiting, 2 * jobs, record):
            if result is None:
                raise RunError(_GONE)
            yield run, result, seconds
        if waiting:
            raise RunError(_GONE)
    elif min(jobs, len(runs)) <= 1:
        for run in waiting:
            yield run, *attempt(run, record, code_version())
    else:
        from kswarms.scenarios.runs.processes import in_processes

        yield from in_processes(waiting, jobs, record)


def play_through(
    executor: Executor, waiting: deque[Run], at_once: int, record: str
) -> Generator[tuple[Run, Outcome | Failure | None, float], None, None]:
    """Play runs through an executor, and yield each as it ends.

    Parameters
    ----------
    executor : concurrent.futures.Executor
        Who plays.
    waiting : deque of Run
        What is played, in order. If the executor breaks, what it had not begun is left in it.
    at_once : int
        How many are given to it at a time.
    record : str
        Names of the tables to record, separated by commas.

    Yields
    ------
    run : Run
        What was played.
    result : Outcome, Failure or None
        What came out; None if the executor broke, maybe because of this run.
    seconds : float
        CPU time (s).
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
        if playing:
            future = ended.get()
            run = playing.pop(future)
            error = CancelledError() if future.cancelled() else future.exception()
            if isinstance(error, BrokenExecutor | CancelledError):
                broken = True
                yield run, None, 0.0
            elif error is not None:  # what was asked or answered could not be sent, say
                yield run, Failure(_line(error), "".join(traceback.format_exception(error))), 0.0
            else:
                yield run, *future.result()


def name_of(run: Run) -> str:
    """Name a run as people do."""
    scenario, condition = run.labels[0]
    return f"run scenario={scenario!r} condition={condition!r} n={run.n} seed={run.seed}"


def _line(error: BaseException) -> str:
    return " ".join(f"{type(error).__name__}: {error}".split())
