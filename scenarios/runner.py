"""Plays runs: in this process or in several, with the same results in any number and any order."""

import os
import signal
import threading
from collections.abc import Generator, Iterable, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from multiprocessing import active_children, get_context, parent_process
from typing import Any, Final

from scenarios.runs import Run, require_unchanged

RECORDS: Final = ("conflicts", "robots", "trajectory")
"""Tables that a game can record, besides its results."""

GAMES_A_WORKER: Final = 100
"""Games after which worker processes are replaced by new ones."""


class RunError(RuntimeError):
    """A run, named in the message, could not be played to its end."""


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
    # Here, since both take over a second and only what plays needs them.
    from mesa import Agent

    from model.foraging import GameModel
    from model.recording import policy_rows

    model = None
    try:
        require_unchanged(run)
        model = GameModel(run.game, seed=run.seed, record=record)
        model.play()
        return Outcome(model.results(), policy_rows(model), model.tables())
    except Exception as error:
        raise RunError(f"{_name(run)} failed: {type(error).__name__}: {error}") from error
    finally:
        # Mesa counts the agents of every model in a table of the class, and so keeps the model alive.
        Agent._ids.pop(model, None)


def play_all(
    runs: Sequence[Run], jobs: int = 1, record: str = ""
) -> Generator[tuple[Run, Outcome], None, None]:
    """Play runs, the longest first, and yield each with its outcome as it ends.

    Parameters
    ----------
    runs : sequence of Run
        What is played.
    jobs : int
        Processes that play; 1 plays in this one.
    record : str
        Names of the tables to record, separated by commas.

    Raises
    ------
    RunError
        If a game fails or a worker process dies.
    """
    longest_first = sorted(runs, key=lambda run: run.effort, reverse=True)
    if min(jobs, len(runs)) == 1:
        for run in longest_first:
            yield run, play(run, record)
        return
    # Fresh workers for each portion bound what Mesa leaves behind in a process. The executor's own
    # `max_tasks_per_child` hangs in Python 3.11 (CPython issue 115634).
    portion = jobs * GAMES_A_WORKER
    for start in range(0, len(runs), portion):
        yield from _play_in_processes(longest_first[start : start + portion], jobs, record)


def _play_in_processes(
    runs: Iterable[Run], jobs: int, record: str
) -> Generator[tuple[Run, Outcome], None, None]:
    others = set(active_children())
    executor = ProcessPoolExecutor(jobs, get_context("spawn"), _follow_parent)
    try:
        futures = _submit(executor, runs, record)
        for future in as_completed(futures):
            # Popped, so that an outcome is freed as soon as its consumer is done with it.
            yield futures.pop(future), future.result()
    except BrokenProcessPool as error:
        raise RunError("a worker process died during a game: killed, or short of memory?") from error
    except BaseException:
        # Ctrl-C, a failed game, or nobody wants the rest: do not wait for games that may take minutes.
        for worker in set(active_children()) - others:
            worker.terminate()
        raise
    finally:
        executor.shutdown(cancel_futures=True)


def _submit(executor: ProcessPoolExecutor, runs: Iterable[Run], record: str) -> dict[Future[Outcome], Run]:
    # Submitting starts the workers, and they inherit the mask: Ctrl-C, which a terminal sends to them
    # too, is left to this process from their first moment on.
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    try:
        return {executor.submit(play, run, record): run for run in runs}
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)


def _follow_parent() -> None:
    """Let this worker end when its parent does, even if that is killed."""
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _name(run: Run) -> str:
    scenario, condition = run.labels[0]
    return f"run scenario={scenario!r} condition={condition!r} n={run.n} seed={run.seed}"
