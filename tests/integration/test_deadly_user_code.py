"""User-defined code with hidden state, code that ends its process, and code that never returns."""

import re
import time
from collections.abc import Mapping
from concurrent.futures import BrokenExecutor
from multiprocessing import active_children
from pathlib import Path

import pytest

from kswarms.agents.actions import Action
from kswarms.agents.common.errors import InputError
from kswarms.agents.policies.interface import Setting
from kswarms.model.foraging import ForagingModel
from kswarms.scenarios.cli import invoke
from kswarms.scenarios.description.scenario import Scenario
from kswarms.scenarios.runs import processes, trial, workers
from kswarms.scenarios.runs.outcome import Failure, Outcome
from kswarms.scenarios.runs.run import Run, expand
from kswarms.scenarios.runs.sweep import sweep
from kswarms.scenarios.runs.trial import failed_trials, require_trials
from kswarms.scenarios.study.database import LEDGER_FILE
from kswarms.scenarios.study.ledger import Ledger

CODE = """
import os
import random
import signal
import sys
import time
import numpy as np
from kswarms.agents.learning.rewards import Reward
from kswarms.agents.learning.selection_rules import Rule

IMPORT

class Mine:
    chosen = 0

    def __init__(self, setting):
        self.actions = setting.actions
        self.own = 0
        CONSTRUCT

    def choose(self, opponent):
        Mine.chosen += 1
        self.own += 1
        return self.actions[INDEX]

class MyReward(Reward):
    def of(self, *conflict):
        return random.random()


class MyRule(Rule):
    def prefer(self, bandit, rng):
        return int(np.random.random() < 0.5)
"""


pytestmark = pytest.mark.usefixtures("empty_directory")


def runs_of(index: str = "0", at_import: str = "pass", construct: str = "pass", **fields: int) -> list[Run]:
    """Write a file with code, and return runs of a short game with the policy of the file."""
    code = {"IMPORT": at_import, "CONSTRUCT": construct, "INDEX": index}
    text = CODE
    for name, part in code.items():
        text = text.replace(name, part)
    Path("mine.py").write_text(text)
    return expand([scenario("mine.py:Mine", **fields)])


def scenario(policy: str, n: int = 6, seeds: int = 1) -> Scenario:
    swarms = ({"policy": "avoid"}, {"policy": policy})
    condition = {"duration": 60.0, "swarms": swarms}
    return Scenario(id="mine", title="Own code", densities=(n,), seeds=seeds, conditions=(condition,))


def failures(runs: list[Run]) -> list[str]:
    """Play runs and return the errors of those that fail."""
    return [result.error for _, result, _ in sweep(runs) if isinstance(result, Failure)]


HIDDEN = {
    "random": "random.random() < 0.5",
    "numpy": "int(np.random.random() < 0.5)",
    "counter": "Mine.chosen // 3 % 2",
    "clock": "int(time.time() / 1e4 * 2 ** (self.own % 9)) % 2",
    "hashes": "hash(str(self.own)) // 8 % 2",
}
"""Expressions of an action that depend on more than the conflict and the seed."""
STATEFUL = "its two trial games differ: does it use global random numbers or keep state between robots?"


def trial_errors(files: Mapping[str, Mapping[str, str]]) -> dict[str, str]:
    """Try policies in files with these parts, in the same processes; return the errors."""
    games = {}
    for name, parts in files.items():
        runs_of(**parts)
        Path("mine.py").rename(f"policy_{name}.py")
        (run,) = expand([scenario(f"policy_{name}.py:Mine")])
        games[run.game] = name
    return {games[game]: failure.error for game, failure in failed_trials(games).items()}


def test_hidden_state_is_detected() -> None:
    found = trial_errors({name: {"index": index} for name, index in HIDDEN.items()})
    assert found == {name: f"InputError: policy='policy_{name}.py:Mine': {STATEFUL}" for name in HIDDEN}


def test_hidden_state_is_detected_when_runs_are_planned() -> None:
    games = [run.game for run in runs_of(HIDDEN["counter"])]
    with pytest.raises(InputError, match=f"policy='mine.py:Mine': {re.escape(STATEFUL)}"):
        require_trials(games)


@pytest.mark.parametrize(
    "policy", ["mine.py:Mine", "learner(reward='mine.py:MyReward')", "learner(rule='mine.py:MyRule')"]
)
def test_hidden_state_is_detected_when_a_model_is_built(policy: str) -> None:
    runs_of(HIDDEN["counter"], at_import="random.seed(1); np.random.seed(1)")
    with pytest.raises(InputError, match=re.escape(STATEFUL)):
        ForagingModel(n=6, policies=["avoid", policy])


def test_a_factory_of_this_process_may_share_state_between_robots() -> None:
    class Shared:
        turns = 0

        def __init__(self, setting: Setting) -> None:
            self.actions = setting.actions

        def choose(self, _opponent: int) -> Action:
            Shared.turns += 1
            return self.actions[Shared.turns % 2]

    model = ForagingModel(n=6, policies=["avoid", Shared], duration=20)
    model.play()
    assert Shared.turns > 0


RAISED = ["raise KeyboardInterrupt", "sys.exit('no')", "raise GeneratorExit", "raise BaseException('no')"]


def test_an_exception_that_ends_processes_is_an_error_of_the_code() -> None:
    places = ["at_import", "construct"] * 2
    errors = trial_errors({f"f{k}": {place: RAISED[k]} for k, place in enumerate(places)})
    assert list(errors) == ["f0", "f1", "f2", "f3"]
    for name, error in errors.items():
        assert re.match(rf"InputError: policy='policy_{name}.py:Mine': .* raises \w+", error)


DEADLY = {
    "exit": "os._exit(7)",
    "exit without an error": "os._exit(0)",
    "signal": "os.kill(os.getpid(), signal.SIGKILL)",
}
ENDLESS = "sum(0 for _ in iter(int, 1))"
PLACES = {
    "import": {"at_import": "CODE"},
    "construction": {"construct": "CODE"},
    "choice": {"index": "0 if self.own < 3 else [CODE, 0][1]"},
}


@pytest.mark.parametrize(("code", "place"), [*zip(DEADLY, PLACES, strict=True)])
def test_code_that_ends_its_process_fails_its_runs(code: str, place: str) -> None:
    parts = {name: text.replace("CODE", DEADLY[code]) for name, text in PLACES[place].items()}
    runs = runs_of(**parts, seeds=2)
    require_trials(run.game for run in runs)
    assert failures(runs) == ["policy='mine.py:Mine': its trial ended its worker process"] * 2


@pytest.mark.parametrize("place", PLACES)
def test_endless_code_fails_its_runs(place: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trial, "TRIAL_LIMIT", 0.3)
    parts = {name: text.replace("CODE", ENDLESS) for name, text in PLACES[place].items()}
    runs = runs_of(**parts, seeds=2)
    assert failures(runs) == ["policy='mine.py:Mine': its trial took longer than 0.3 s"] * 2


LATE = """
import os
import time

class Endless:
    def __init__(self, setting):
        self.actions = setting.actions
        self.own = 0

    def choose(self, opponent):
        self.own += 1
        if self.own > 20:
            self.act()
        return self.actions[0]

    def act(self):
        sum(0 for _ in iter(int, 1))

class Deaf(Endless):
    def act(self):
        while True:
            try: time.sleep(100)
            except BaseException: pass

class Ending(Endless):
    def act(self):
        os._exit(0)
"""
"""Policies that misbehave after the 19 conflicts of a trial game."""


@pytest.mark.slow
def test_runs_that_exceed_or_ignore_their_limit_fail_and_no_other_is_lost() -> None:
    Path("late.py").write_text(LATE)
    late = {name: expand([scenario(f"late.py:{name}", n=30)])[0] for name in ("Endless", "Deaf")}
    others = expand([scenario("attack", seeds=2)])
    results = {run.digest: result for run, result, _ in sweep([*late.values(), *others], 1, run_limit=2.0)}
    failed = {name: results.pop(run.digest) for name, run in late.items()}
    assert {name: result.error for name, result in failed.items() if isinstance(result, Failure)} == {
        "Endless": "TimeLimitError: took longer than 2 s",
        "Deaf": "took longer than 2 s; its worker was killed",
    }
    assert 'late.py", line' in failed["Endless"].trace.splitlines()[-3]
    assert results == {run.digest: result for run, result, _ in sweep(others)}


@pytest.mark.slow
def test_a_run_that_ends_its_process_after_the_trial_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(processes, "MAX_DEATHS", 1)
    Path("late.py").write_text(LATE)
    runs = expand([scenario("late.py:Ending", n=30)])
    assert failures(runs) == ["its worker process died 1 times: killed or out of memory?"]


def test_a_thread_of_user_code_does_not_keep_a_worker_alive(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(workers, "EXIT_TIMEOUT", 0.2)
    runs = runs_of(at_import="import threading; threading.Thread(target=time.sleep, args=(600,)).start()")
    ((_, outcome, _),) = sweep(runs)
    assert isinstance(outcome, Outcome)
    assert active_children() == []


def test_a_limit_is_suggested_once_for_a_long_run(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    runs = expand([scenario("attack", seeds=2)])
    watch = processes.Watch(None)
    with workers.new_workers(1) as executor:
        for now in (0.0, 59.0, 61.0, 70.0):
            monkeypatch.setattr(processes, "monotonic", lambda now=now: now)
            watch(executor, runs)
    (line,) = caplog.messages
    assert line.startswith(f"kswarms: {runs[0]} takes 61 s, over 20 times its estimate; --run-limit SECONDS")


def test_a_worker_that_is_blocked_beyond_the_limit_is_killed(monkeypatch: pytest.MonkeyPatch) -> None:
    runs = expand([scenario("attack")])
    watch = processes.Watch(10.0)
    with workers.new_workers(1) as executor:
        sleeping = executor.submit(time.sleep, 600)
        for now in (0.0, 79.0):
            monkeypatch.setattr(processes, "monotonic", lambda now=now: now)
            watch(executor, runs)
        assert not sleeping.done()
        monkeypatch.setattr(processes, "monotonic", lambda: 81.0)
        watch(executor, runs)
        assert isinstance(sleeping.exception(), BrokenExecutor)


def test_code_that_stops_its_process_fails_its_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trial, "TRIAL_LIMIT", 0.5)
    monkeypatch.setattr(trial, "BLOCKED_AFTER", 2.0)
    runs = runs_of(construct="os.kill(os.getpid(), signal.SIGSTOP)")
    assert failures(runs) == ["policy='mine.py:Mine': its trial took longer than 0.5 s"]
    assert active_children() == []


def test_a_study_of_deadly_code_has_failed_rows(capsys: pytest.CaptureFixture[str]) -> None:
    runs_of("[os._exit(7) if Mine.chosen > 40 else 0, 0][1]")
    Path("mine.toml").write_text(scenario("mine.py:Mine").to_toml())
    assert invoke(["run", "mine.toml", "--jobs", "1", "--quiet", "--no-figures", "--run-limit", "60"]) == 1
    assert invoke(["status", "results"]) == 0
    failed = "failed: mine, n=6, seed=0: policy='mine.py:Mine': its trial ended its worker process"
    assert failed in capsys.readouterr().out.splitlines()
    with Ledger(Path("results", LEDGER_FILE)) as ledger:
        ((point, _, _),) = ledger.failed_runs()
    assert invoke(["replay", "results", point.run, "--trust"]) == 1
    assert "its trial ended its worker process" in capsys.readouterr().err


@pytest.mark.parametrize("option", ["0", "-1", "nan", "inf", "1e300", "5 --scheduler tcp://localhost:1"])
def test_a_limit_must_be_a_positive_number_of_seconds(
    option: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke(f"run fig-6.1c --run-limit {option}".split()) == 2
    assert capsys.readouterr().err.startswith("kswarms: run_limit=")
    assert list(Path().iterdir()) == []
