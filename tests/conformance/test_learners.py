"""Conformance of all policies in `POLICIES`.

Checks that apply to user-defined policies too are in `kswarms.agents.conformance`; the others are here.
Learners are checked with every reward and rule. Each check takes a factory. For each check, there is a policy
that fails it.
"""

import copy
import math
import pickle
import random
from collections.abc import Callable
from itertools import product
from pathlib import Path
from typing import Any, Final

import pytest

from kswarms.agents.actions import AWAY, Action
from kswarms.agents.conformance import POLICY_CHECKS
from kswarms.agents.conformance.policies import TWO_ACTIONS, make_setting, make_settings, play_conflicts
from kswarms.agents.learning.rewards import REWARDS, Reward, make_reward
from kswarms.agents.learning.selection_rules import RULES, Rule, make_rule
from kswarms.agents.policies.interface import Policy, Setting
from kswarms.agents.policies.learner import Learner
from kswarms.agents.policies.registry import POLICIES
from kswarms.agents.policies.saved import save_learned
from kswarms.agents.policies.spec import Factory, make_policy
from kswarms.agents.streams import Purpose

ARGUMENTS = {"learned": "(file={file!r})"}
"""Required arguments."""
TEXTS = [
    *(name + ARGUMENTS.get(name, "") for name in POLICIES),
    *(f"learner(reward='{reward}', rule='{rule}')" for reward, rule in product(REWARDS, RULES)),
    *TWO_ACTIONS[0].name.split(),
]


def check_repr_shows_the_swarm_and_no_address(build: Factory) -> None:
    text = repr(build(make_setting(swarm=1)))
    assert "swarm=1" in text
    assert " at 0x" not in text
    assert len(text.splitlines()) == 1


def check_a_frozen_learner_ignores_conflicts(build: Factory) -> None:
    """After freeze(), learn(…) changes nothing and returns NaN."""
    for setting in make_settings():
        policy = build(setting)
        if not hasattr(policy, "learn"):
            continue
        assert isinstance(policy, Learner)
        assert play_conflicts(policy, setting)
        known = repr(policy.snapshot())
        policy.freeze()
        returned = play_conflicts(policy, setting, conflicts=40)[1::2]
        assert repr(policy.snapshot()) == known
        assert all(math.isnan(number) for entry in returned for number in entry)


def check_copies_look_alike(build: Factory) -> None:
    policy = build(setting := make_setting())
    play_conflicts(policy, setting, conflicts=17)
    assert repr(copy.deepcopy(policy)) == repr(pickle.loads(pickle.dumps(policy))) == repr(policy)


class ForeignAction:
    """Returns an action that is not in the game."""

    def __init__(self, setting: Setting) -> None:
        self.swarm = setting.swarm

    def choose(self, opponent: int) -> Action:
        return Action(name="hide", direction=AWAY, duration=1.0)


class Unseeded(ForeignAction):
    """Draws from another source of randomness."""

    def __init__(self, setting: Setting) -> None:
        super().__init__(setting)
        self.actions = setting.actions

    def choose(self, opponent: int) -> Action:
        return random.choice(self.actions)


class SharedState(Unseeded):
    """Shares state among robots."""

    met: Final[list[int]] = []

    def choose(self, opponent: int) -> Action:
        self.met.append(opponent)
        return self.actions[len(self.met) > 100]


class Unpicklable(Unseeded):
    """Loses its state when pickled."""

    def choose(self, opponent: int) -> Action:
        self.met = getattr(self, "met", 0) + 1
        return self.actions[self.met % 20 < 5]

    def __getstate__(self) -> dict[str, Any]:
        return {"actions": self.actions, "swarm": self.swarm}


class WrongStream(Unseeded):
    """Draws from the stream of another purpose."""

    def __init__(self, setting: Setting) -> None:
        super().__init__(setting)
        self.streams = setting.streams

    def choose(self, opponent: int) -> Action:
        return self.actions[self.streams.generator(Purpose.LEG).random() < 0.5]


class NeverFreezes(Learner):
    """Continues to explore and learn after freeze()."""

    def __init__(self, setting: Setting) -> None:
        super().__init__(setting, rule="uniform-random")

    def freeze(self) -> None:
        pass


FAULTY = (ForeignAction, Unseeded, SharedState, Unpicklable, WrongStream, NeverFreezes)
Check = Callable[[Factory], None]
CHECKS: Final[dict[Check, Factory]] = {
    **dict(zip(POLICY_CHECKS, FAULTY, strict=True)),
    check_repr_shows_the_swarm_and_no_address: ForeignAction,
    check_copies_look_alike: Unpicklable,
    check_a_frozen_learner_ignores_conflicts: NeverFreezes,
}
"""Each check with a policy that fails it."""


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[int, str]:
    """Return files of learned policies by swarm."""
    folder, paths = tmp_path_factory.mktemp("learned"), {}
    for swarm in range(3):
        learner = Learner(setting := make_setting(swarm))
        play_conflicts(learner, setting)
        paths[swarm] = str(Path(folder, f"swarm-{swarm + 1}.json"))
        save_learned(Path(paths[swarm]), swarm + 1, [learner.snapshot()])
    return paths


@pytest.mark.parametrize("text", TEXTS)
@pytest.mark.parametrize("check", CHECKS)
def test_every_policy_passes_every_check(text: str, check: Check, files: dict[int, str]) -> None:
    def build(setting: Setting) -> Policy:
        return make_policy(text.replace("{file!r}", repr(files[setting.swarm])), setting)

    check(build)


@pytest.mark.parametrize("check", CHECKS)
def test_every_check_refuses_a_bad_policy(check: Check) -> None:
    with pytest.raises(AssertionError):
        check(CHECKS[check])


@pytest.mark.parametrize(("name", "kind"), [*REWARDS.items(), *RULES.items()])
def test_a_name_builds_its_class_with_an_informative_repr(name: str, kind: type[Reward | Rule]) -> None:
    built: Reward | Rule = make_reward(name) if issubclass(kind, Reward) else make_rule(name)
    text = repr(built)
    assert text.startswith(f"{kind.__name__}(")
    assert all(f"{field}=" in text for field in kind.model_fields)
    assert eval(text, {kind.__name__: kind}) == built == kind()


def test_names_can_be_written_in_texts() -> None:
    for name in (*POLICIES, *REWARDS, *RULES):
        assert name == name.lower().strip()
        assert not set(name) & set("()+,'\" ")
    assert all(len(set(known.values())) == len(known) for known in (REWARDS, RULES))
