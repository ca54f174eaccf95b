"""Trial of the user-defined code of games, in worker processes, before the games are played."""

import time
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import BrokenExecutor
from typing import Final, NamedTuple

from kswarms.agents.actions import Action
from kswarms.agents.common.errors import InputError
from kswarms.agents.conformance.trial import STATEFUL, try_policy
from kswarms.agents.policies.interface import Setting
from kswarms.agents.policies.spec import parse_policies
from kswarms.agents.streams import Streams
from kswarms.model.description.game import Game
from kswarms.scenarios.runs.outcome import Failure
from kswarms.scenarios.runs.run import hash_file
from kswarms.scenarios.runs.workers import BLOCKED_AFTER, TimeLimitError, new_workers, time_limit

TRIAL_LIMIT: Final = 60.0
"""Time limit of a trial by the clock, loading of the code included (s)."""
_CLOCK_SHIFTS: Final = (0.0, 12345.678)
"""Shift of Python's clocks in the first and the second process of a trial (s)."""
_ROBOTS: Final = 7
_CONFLICTS: Final = 19
"""Conflicts of each robot in a trial game."""


class Trial(NamedTuple):
    """A policy with user-defined code, in a game."""

    policy: str
    swarm: int
    swarms: int
    actions: tuple[Action, ...]
    files: tuple[str, ...]
    """Hashes of the files: changed code is tried again."""


TrialResult = str | InputError | Failure
"""Digest of the trial game; error of the code; failure if the code killed its process or took too long."""

_results: dict[Trial, TrialResult] = {}
"""Results of this process, so that code is tried once for planning and playing."""


def require_trials(games: Iterable[Game], run_limit: float | None = None) -> None:
    """Try the user-defined code of games; raise an `InputError` if some raises an error or breaks a rule.

    Code that kills its process or takes too long raises nothing here. `sweep` reports its runs as failed.
    """
    trials = {trial: None for game in games for trial in _trials_of(game)}
    for result in _try_all(trials, run_limit).values():
        if isinstance(result, InputError):
            raise result


def failed_trials(games: Iterable[Game], run_limit: float | None = None) -> dict[Game, Failure]:
    """Try the user-defined code of games; return the failure of each game whose code fails its trial."""
    trials = {game: _trials_of(game) for game in games}
    results = _try_all({trial: None for each in trials.values() for trial in each}, run_limit)
    failures = {}
    for game, each in trials.items():
        for result in (results[trial] for trial in each):
            if not isinstance(result, str):
                failures[game] = result if isinstance(result, Failure) else Failure.of(result)
    return failures


def _trials_of(game: Game) -> list[Trial]:
    return [
        Trial(str(spec), k, len(game.swarms), game.action_set, tuple(map(hash_file, spec.files())))
        for k, swarm in enumerate(game.swarms)
        for spec in parse_policies(swarm.policy)
        if spec.runs_user_code
    ]


def _try_all(trials: Iterable[Trial], run_limit: float | None) -> dict[Trial, TrialResult]:
    """Try policies in two processes with other random numbers, hashes and clocks; the results must agree."""
    limit = TRIAL_LIMIT if run_limit is None else min(run_limit, TRIAL_LIMIT)
    new = [trial for trial in trials if trial not in _results]
    for shift in _CLOCK_SHIFTS:
        passed = [trial for trial in new if isinstance(_results.get(trial, ""), str)]
        for trial, result in zip(passed, _try_in_new_process(passed, limit, shift), strict=True):
            if isinstance(result, str) and _results.get(trial, result) != result:
                result = InputError("policy", trial.policy, STATEFUL)
            _results[trial] = result
    return {trial: _results[trial] for trial in trials}


def _try_in_new_process(trials: Sequence[Trial], limit: float, shift: float) -> Iterator[TrialResult]:
    """Yield the result of each trial. A new process replaces one that dies."""
    waiting = list(reversed(trials))
    while waiting:
        with new_workers(1) as executor:
            executor.submit(_shift_clocks, shift)
            while waiting:
                trial = waiting.pop()
                try:
                    yield executor.submit(_try, trial, limit).result(limit + BLOCKED_AFTER)
                except TimeoutError:  # a signal has stopped the process, for example
                    executor.kill()
                    yield Failure(f"policy={trial.policy!r}: its trial took longer than {limit:g} s")
                    break
                except BrokenExecutor:
                    executor.require_started()
                    yield Failure(f"policy={trial.policy!r}: its trial ended its worker process")
                    break


def _try(trial: Trial, limit: float) -> TrialResult:
    """Try a policy in a worker. Ctrl-C does not reach it, so every exception is an error of the code."""
    try:
        with time_limit(limit):
            (spec,) = parse_policies(trial.policy)
            setting = Setting(trial.swarm, trial.swarms, trial.actions, Streams(0, 0))
            return try_policy(spec, setting, _ROBOTS, _CONFLICTS)
    except InputError as error:
        return error
    except TimeLimitError as error:
        return Failure(f"policy={trial.policy!r}: its trial {error}")
    except BaseException as error:  # noqa: BLE001  # user-defined code may raise anything
        return InputError("policy", trial.policy, f"its trial raises {type(error).__name__}: {error}")


def _shift_clocks(seconds: float) -> None:
    """Shift the clocks of this process, so that code that reads them acts differently."""
    for name in ("time", "monotonic", "perf_counter"):
        read = getattr(time, name)
        setattr(time, name, lambda read=read: read() + seconds)
