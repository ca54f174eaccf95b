"""Play one run."""

import time
import traceback
from collections.abc import Iterator
from contextlib import contextmanager

from kswarms.model.description.game import Game, Swarm
from kswarms.model.game_model import GameModel
from kswarms.model.recorder import policy_rows
from kswarms.scenarios.runs.errors import RunError
from kswarms.scenarios.runs.outcome import Failure, Outcome
from kswarms.scenarios.runs.run import Run, code_version, require_unchanged
from kswarms.scenarios.runs.workers import TimeLimitError, time_limit


def play(run: Run, record: str = "") -> Outcome:
    """Play a run and return its results.

    Parameters
    ----------
    record : str
        Names of the tables to record (`RECORDED_TABLES`), separated by commas.

    Raises
    ------
    RunError
        If the game fails.
    """
    with finished_game(run, record) as model:
        return Outcome(model.results(), policy_rows(model), model.recorder.records())


@contextmanager
def finished_game(run: Run, record: str = "") -> Iterator[GameModel]:
    """Play a run like `play` and yield its model at the end of the game."""
    with run_errors(str(run)):
        require_unchanged(run)
        model = GameModel(run.game, seed=run.seed, record=record)
        model.play()
        yield model


@contextmanager
def run_errors(label: str) -> Iterator[None]:
    """Re-raise every error as a `RunError` with a label; user-defined policies may raise anything."""
    try:
        yield
    except (Exception, SystemExit) as error:
        failure = Failure.of(error)
        raise RunError(f"{label} failed: {failure.error}", failure.trace) from error


def compile_kernel() -> None:
    """Compile the kernel unless its machine code is cached, so that workers only load it."""
    GameModel(Game(swarms=(Swarm(policy="avoid", size=1),)), seed=0)


def attempt(run: Run, record: str, code: str) -> tuple[Outcome | Failure, float]:
    """Play a run in a worker; return its outcome or failure, and its CPU time (s).

    The run fails if the `code_version` of the worker differs from `code`, as may happen on a cluster.
    """
    if code != code_version():
        return Failure(f"the worker has kswarms {code_version()}, it must have {code}"), 0.0
    started = time.thread_time()
    result: Outcome | Failure
    try:
        result = play(run, record)
    except RunError as error:
        result = Failure.of(error.__cause__ or error)
    return result, time.thread_time() - started


def attempt_in_worker(
    record: str, code: str, run_limit: float | None, run: Run
) -> tuple[Outcome | Failure, float]:
    """Play a run like `attempt`, for at most `run_limit` seconds.

    Ctrl-C does not reach a worker, so every exception is a failure of the run.
    """
    started = time.thread_time()
    try:
        with time_limit(run_limit):
            return attempt(run, record, code)
    except TimeLimitError as error:
        calls = traceback.extract_tb(error.__traceback__)[:-1]  # the last is that of the signal's handler
        trace = "".join(["Traceback (most recent call last):\n", *traceback.format_list(calls)])
        return Failure(f"TimeLimitError: {error}", trace), time.thread_time() - started
    except BaseException as error:  # noqa: BLE001  # user-defined code may raise anything
        return Failure.of(error), time.thread_time() - started
