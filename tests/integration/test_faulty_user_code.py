"""User-defined code that passes its trial and fails during games."""

from pathlib import Path

import pytest

from kswarms.agents.common.errors import InputError
from kswarms.model.foraging import ForagingModel
from kswarms.model.game_model import GameModel
from kswarms.model.recorder import save_policies
from kswarms.scenarios.cli import invoke
from kswarms.scenarios.description.toml_files import read_scenarios
from kswarms.scenarios.runs.outcome import Failure
from kswarms.scenarios.runs.play import attempt
from kswarms.scenarios.runs.run import code_version, expand
from kswarms.scenarios.study.database import LEDGER_FILE
from kswarms.scenarios.study.ledger import Ledger

POLICY = """
import os
import sys
from pathlib import Path

from kswarms.agents.actions import Action
from simpy.core import StopSimulation


class Faulty:
    def __init__(self, setting):
        self.actions = setting.actions
        self.asked = 0

    def choose(self, opponent):
        self.asked += 1
        if self.asked > 20:  # the trial has 19 conflicts
            FAULT
        return self.actions[0]
"""
REWARD = """
from kswarms.agents.learning.rewards import Reward


class Faulty(Reward):
    def of(self, t_a, t_p, n_active, direction, inter, opponent):
        in_periods = abs(10 * t_p - round(10 * t_p)) < 1e-6 and t_p not in (0.0, 6.0)
        return FAULT if in_periods else 1.0  # as in a game, but not in its trial
"""
RULE = """
from kswarms.agents.learning.selection_rules import Rule


class Faulty(Rule):
    def prefer(self, bandit, rng):
        return 0 if bandit.choices < 20 else FAULT  # the trial has 19 conflicts
"""
SCENARIO = """
id = "faulty"
title = "Own code"
densities = [30]
seeds = 2
[[conditions]]
duration = 60
learning = 300
swarms = [{ policy = "avoid" }, { policy = "POLICY" }]
"""
RUN = ["run", "mine.toml", "--jobs", "1", "--quiet", "--no-figures"]


@pytest.fixture(autouse=True)
def _change_to_a_temporary_directory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def errors_of(code: str, policy: str = "faulty.py:Faulty") -> list[str]:
    """Play a scenario with faulty code in this process, and return the errors of its runs."""
    Path("faulty.py").write_text(code)
    Path("mine.toml").write_text(SCENARIO.replace("POLICY", policy))
    runs = expand(read_scenarios(Path("mine.toml")))
    results = [attempt(run, "", code_version())[0] for run in runs]
    return [result.error for result in results if isinstance(result, Failure)]


@pytest.mark.parametrize(
    ("fault", "error"),
    [
        ("return None", "must return an action of the game, not None"),
        ("return 'fight'", "must return an action of the game, not 'fight'"),
        # Another action with the name of an action of the game.
        ("return Action(name='fight', direction=-1, duration=30)", "must return an action of the game, not "),
        ("raise StopSimulation(None)", "RuntimeError: the clock was stopped at "),
        ("sys.exit(0)", "SystemExit: 0"),
        ("return self.choose(opponent)", "RecursionError: "),
    ],
)
def test_a_policy_that_fails_in_the_game_fails_its_runs(fault: str, error: str) -> None:
    failed = errors_of(POLICY.replace("FAULT", fault))
    assert len(failed) == 2
    assert all(error in line for line in failed)


@pytest.mark.parametrize("fault", ["os.remove(__file__)", "Path(__file__).write_text('# another')"])
def test_a_removed_or_changed_file_fails_the_remaining_runs(fault: str) -> None:
    (error,) = errors_of(
        POLICY.replace("FAULT", f"self.asked == 21 and os.path.exists(__file__) and {fault}")
    )
    assert "policy='faulty.py': must not change while its games are played" in error


@pytest.mark.parametrize("value", ["float('nan')", "float('inf')"])
def test_a_reward_that_is_not_finite_fails_the_run(value: str) -> None:
    failed = errors_of(REWARD.replace("FAULT", value), "inter-learner(reward='faulty.py:Faulty')")
    assert len(failed) == 2
    assert all("reward=" in line and "must be finite, also for T(a)=" in line for line in failed)


@pytest.mark.parametrize("arm", ["-1", "2"])
def test_a_rule_that_returns_no_arm_fails_the_run(arm: str) -> None:
    failed = errors_of(RULE.replace("FAULT", arm), "inter-learner(rule='faulty.py:Faulty')")
    assert failed == [f"InputError: rule={arm}: must choose 0 to 1"] * 2


def test_a_failure_in_a_worker_becomes_a_row() -> None:
    Path("faulty.py").write_text(POLICY.replace("FAULT", "raise ValueError('late')"))
    Path("mine.toml").write_text(SCENARIO.replace("POLICY", "faulty.py:Faulty"))
    assert invoke(RUN) == 1
    with Ledger(Path("results", LEDGER_FILE)) as ledger:
        assert [error for _, error, _ in ledger.failed_runs()] == ["ValueError: late"] * 2


def test_a_rule_that_changes_the_bandit_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    Path("faulty.py").write_text(RULE.replace("return", "bandit.count.clear(); return"))
    Path("mine.toml").write_text(SCENARIO.replace("POLICY", "inter-learner(rule='faulty.py:Faulty')"))
    assert invoke(RUN) == 2
    assert "rule='faulty.py:Faulty': choose(…) must not change the bandit" in capsys.readouterr().err
    assert not Path("results").exists()


@pytest.mark.parametrize(("opponent", "action"), [(3, "fight"), (0, "fight"), (1, "dance")])
def test_a_snapshot_must_fit_the_game(opponent: int, action: str) -> None:
    arm = {"opponent": opponent, "action": action, "reward": 1.0, "time": 1.0, "count": 1.0, "q": 1.0}
    snapshot = f"    def snapshot(self):\n        return [{arm}]\n"
    Path("faulty.py").write_text(POLICY.replace("FAULT", "pass") + "\n" + snapshot)
    with pytest.raises(InputError, match=r"snapshot\(\) must describe the game's actions and swarms, not "):
        ForagingModel(n=4, policies="avoid,faulty.py:Faulty")


def test_a_step_reports_a_stopped_clock() -> None:
    Path("faulty.py").write_text(POLICY.replace("FAULT", "raise StopSimulation(None)"))
    model = ForagingModel(n=30, policies="avoid,faulty.py:Faulty", duration=100, seed=0)
    with pytest.raises(RuntimeError, match=r"the clock was stopped at \d+"):  # noqa: PT012  # any step may raise it
        while model.running:
            model.step()


@pytest.mark.parametrize("swarm", [0, 3, -1])
def test_policies_are_saved_only_for_swarms_of_the_game(swarm: int) -> None:
    model: GameModel = ForagingModel(n=4, policies="learner,learner", learning=10, duration=10, seed=0)
    with pytest.raises(InputError, match=f"swarm={swarm}: must be an integer from 1 to 2"):
        save_policies(model, swarm, Path("learned.json"))
    assert not Path("learned.json").exists()


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ('"swarm": 1', '"swarm": Infinity'),
        ('"q": null', '"q": 1.0'),
        ('"robots"', f'"x": {"[" * 99999}, "robots"'),
    ],
)
def test_a_damaged_file_of_learned_policies_is_refused(before: str, after: str) -> None:
    model = ForagingModel(n=4, policies="learner,avoid", learning=0, duration=0.1, seed=0)
    path = Path("learned.json")
    save_policies(model, 1, path)
    assert before in path.read_text()
    path.write_text(path.read_text().replace(before, after))
    with pytest.raises(InputError, match="must be a file of learned policies"):
        ForagingModel(n=4, policies="learned(file='learned.json'),avoid")
