"""Conformance of all selection rules in `RULES`.

Checks that apply to user-defined rules too are in `kswarms.agents.conformance`; the others are here. Each
check takes a class. For each check, there is a rule that fails it.
"""

import random
from collections.abc import Callable
from typing import Any, Final

import pytest
from numpy.random import Generator

from kswarms.agents.common.errors import InputError
from kswarms.agents.conformance import RULE_CHECKS
from kswarms.agents.conformance.rules import ARMS, choose_arms, exploration_rng
from kswarms.agents.learning.bandit import Bandit
from kswarms.agents.learning.selection_rules import RULES, UCB, Greedy, Rule, UniformRandom

IGNORES_UNTRIED_ARMS: Final = {"uniform-random"}
"""Rules that ignore by definition whether arms were tried (section 1.5)."""


def tried(values: list[float]) -> Bandit:
    """Return a bandit in which all arms have the same count and these values of Q."""
    bandit = Bandit(len(values))
    for arm, value in enumerate(values):
        for _ in range(8):
            bandit.update(arm, 10.0 * value, 10.0)
    bandit.choices = 8 * len(values)
    return bandit


def check_every_arm_is_reachable(rule: type[Rule]) -> None:
    for arms in ARMS:
        for arm in range(arms):
            known = tried([float(other == arm) for other in range(arms)])
            assert arm in {rule().choose(known, exploration_rng(seed)) for seed in range(100)}


def check_untried_arms_come_first(rule: type[Rule]) -> None:
    for arms in ARMS:
        for seed in range(40):
            assert sorted(choose_arms(rule(), arms, seed)[:arms]) == list(range(arms))


def check_ties_are_broken_by_the_robots_stream(rule: type[Rule]) -> None:
    for arms in ARMS:
        by_stream = [rule().choose(tried([0.5] * arms), exploration_rng(seed)) for seed in range(200)]
        assert set(by_stream) == set(range(arms))
        assert [rule().choose(tried([0.5] * arms), exploration_rng(seed)) for seed in range(200)] == by_stream


class Unequal(Greedy):
    """Equals only itself."""

    def __eq__(self, other: object) -> bool:
        return self is other

    __hash__ = Greedy.__hash__


class Mutable(UCB):
    """Is not frozen and changes itself."""

    model_config = {"frozen": False}

    def prefer(self, bandit: Bandit, rng: Generator) -> int:
        self.gamma = self.weight + 0.1
        return super().prefer(bandit, rng)


class AnyArgument(Greedy):
    """Accepts any argument."""

    model_config = {"extra": "ignore"}


class Unseeded(Greedy):
    """Draws from another source of randomness."""

    def choose(self, bandit: Bandit, rng: Generator) -> int:
        return random.randrange(len(bandit.count))


class ArmsFromOne(UniformRandom):
    """Counts arms from 1."""

    def choose(self, bandit: Bandit, rng: Generator) -> int:
        return 1 + super().choose(bandit, rng)


class AlwaysFirst(Greedy):
    """Always chooses the first arm."""

    def choose(self, bandit: Bandit, rng: Generator) -> int:
        return 0


class TiesToFirst(Rule):
    """Greedy without random ties."""

    def prefer(self, bandit: Bandit, rng: Generator) -> int:
        return bandit.best() or 0


class ChangesBandit(Greedy):
    """Changes the bandit."""

    def choose(self, bandit: Bandit, rng: Generator) -> int:
        arm = super().choose(bandit, rng)
        bandit.choices += 1
        return arm


class InvalidFactor(Greedy):
    """Has a discount factor above 1."""

    @property
    def factor(self) -> float:
        return 1.01


Check = Callable[[Any], None]
CHECKS: Final[dict[Check, type[Rule]]] = {
    check_every_arm_is_reachable: AlwaysFirst,
    check_untried_arms_come_first: UniformRandom,
    check_ties_are_broken_by_the_robots_stream: TiesToFirst,
    **dict(zip(RULE_CHECKS, (Unequal, Mutable, AnyArgument, Unseeded, ArmsFromOne), strict=True)),
}
"""Each check with a rule that fails it."""


@pytest.mark.parametrize("name", RULES)
@pytest.mark.parametrize("check", CHECKS)
def test_every_rule_passes_every_check(name: str, check: Check) -> None:
    if check is check_untried_arms_come_first and name in IGNORES_UNTRIED_ARMS:
        return
    check(RULES[name])


@pytest.mark.parametrize(
    ("check", "bad"), [*CHECKS.items(), (RULE_CHECKS[-1], ChangesBandit), (RULE_CHECKS[-1], InvalidFactor)]
)
def test_every_check_refuses_a_bad_rule(check: Check, bad: type[Rule]) -> None:
    with pytest.raises((AssertionError, InputError, pytest.fail.Exception)):
        check(bad)
