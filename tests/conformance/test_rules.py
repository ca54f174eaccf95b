"""What every selection rule must do: a new one in `RULES` is checked by all of this without another line.

What users' rules must do too is in `kswarms.agents.conformance`. Here are the checks of the package's own.
check is a function of a rule's class, and has a rule that it must turn down.
"""

import random
from collections.abc import Callable
from typing import Any, Final

import pytest
from numpy.random import Generator

from kswarms.agents.common.errors import InputError
from kswarms.agents.conformance import RULE_CHECKS
from kswarms.agents.conformance.rules import ARMS, choose_arms, draws
from kswarms.agents.learning.bandit import Bandit
from kswarms.agents.learning.selection_rules import RULES, UCB, Greedy, Rule, UniformRandom, make_rule

IGNORES_WHAT_IT_KNOWS: Final = {"uniform-random"}
"""Rules that may take a tried arm though others were not, by their own definition (section 1.5)."""


def tried(values: list[float]) -> Bandit:
    """Return a bandit that tried every arm equally often, with these values of Q."""
    bandit = Bandit(len(values))
    for arm, value in enumerate(values):
        for _ in range(8):
            bandit.update(arm, 10.0 * value, 10.0)
    bandit.choices = 8 * len(values)
    return bandit


def check_it_is_built_from_its_name(rule: type[Rule]) -> None:
    name = next((name for name, known in RULES.items() if known is rule), None)
    built = make_rule(name) if name else rule()
    assert type(built) is rule
    assert built == rule()


def check_repr_tells_its_name_and_arguments(rule: type[Rule]) -> None:
    text = repr(rule())
    assert text.startswith(f"{rule.__name__}(")
    assert all(f"{field}=" in text for field in rule.model_fields)
    assert eval(text, {rule.__name__: rule}) == rule()


def check_every_arm_is_reachable(rule: type[Rule]) -> None:
    for arms in ARMS:
        for arm in range(arms):
            known = tried([float(other == arm) for other in range(arms)])
            assert arm in {rule().choose(known, draws(seed)) for seed in range(100)}


def check_arms_never_tried_come_first(rule: type[Rule]) -> None:
    for arms in ARMS:
        for seed in range(40):
            assert sorted(choose_arms(rule(), arms, seed)[:arms]) == list(range(arms))


def check_the_first_of_all_is_random(rule: type[Rule]) -> None:
    for arms in ARMS:
        assert {rule().choose(Bandit(arms), draws(seed)) for seed in range(200)} == set(range(arms))


def check_ties_are_broken_by_the_robots_own_stream(rule: type[Rule]) -> None:
    for arms in ARMS:
        by_stream = [rule().choose(tried([0.5] * arms), draws(seed)) for seed in range(200)]
        assert set(by_stream) == set(range(arms))
        assert [rule().choose(tried([0.5] * arms), draws(seed)) for seed in range(200)] == by_stream


class Unbuildable(Rule):
    """Has an argument without a default."""

    gamma: float

    def prefer(self, bandit: Bandit, draws: Generator) -> int:
        return 0


class Mute(Greedy):
    """Tells nothing of itself."""

    def __repr__(self) -> str:
        return "<rule>"


class Moody(Greedy):
    """No two are alike."""

    def __init__(self, **values: object) -> None:
        super().__init__(**values)
        object.__setattr__(self, "mood", random.random())

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Moody) and vars(self) == vars(other)

    __hash__ = Greedy.__hash__


class Thawed(UCB):
    """Can be changed, and changes itself."""

    model_config = {"frozen": False}

    def prefer(self, bandit: Bandit, draws: Generator) -> int:
        self.gamma += 0.1
        return super().prefer(bandit, draws)


class Lenient(Greedy):
    """Takes any argument."""

    model_config = {"extra": "ignore"}


class Unseeded(Greedy):
    """Draws from a stream that is not the robot's."""

    def choose(self, bandit: Bandit, draws: Generator) -> int:
        return random.randrange(len(bandit.count))


class OneTooFar(UniformRandom):
    """Counts from 1."""

    def choose(self, bandit: Bandit, draws: Generator) -> int:
        return 1 + super().choose(bandit, draws)


class First(Greedy):
    """Takes the first arm, or the first of equals."""

    def choose(self, bandit: Bandit, draws: Generator) -> int:
        return 0


class FirstOfEquals(Rule):
    """Greedy without a draw, once every arm was tried."""

    def prefer(self, bandit: Bandit, draws: Generator) -> int:
        return bandit.best() or 0


class Meddler(Greedy):
    """Counts its choices itself."""

    def choose(self, bandit: Bandit, draws: Generator) -> int:
        arm = super().choose(bandit, draws)
        bandit.choices += 1
        return arm


class Inflating(Greedy):
    """Makes more of the past than it was."""

    @property
    def factor(self) -> float:
        return 1.01


Check = Callable[[Any], None]
CHECKS: Final[dict[Check, type[Rule]]] = {
    check_it_is_built_from_its_name: Unbuildable,
    check_repr_tells_its_name_and_arguments: Mute,
    check_every_arm_is_reachable: First,
    check_arms_never_tried_come_first: UniformRandom,
    check_the_first_of_all_is_random: First,
    check_ties_are_broken_by_the_robots_own_stream: FirstOfEquals,
    **dict(
        zip(RULE_CHECKS, (Moody, Thawed, Lenient, Unseeded, OneTooFar), strict=True)
    ),
}
"""Every check, with a rule that must not pass it."""


@pytest.mark.parametrize("name", RULES)
@pytest.mark.parametrize("check", CHECKS)
def test_every_rule_passes_every_check(name: str, check: Check) -> None:
    if check is check_arms_never_tried_come_first and name in IGNORES_WHAT_IT_KNOWS:
        return
    check(RULES[name])


@pytest.mark.parametrize("check", CHECKS)
def test_every_check_turns_a_bad_rule_down(check: Check) -> None:
    try:
        check(CHECKS[check])
    except (AssertionError, InputError, pytest.fail.Exception):
        return
    pytest.fail(f"{check.__name__} let {CHECKS[check].__name__} pass")


def test_names_are_as_users_write_them() -> None:
    for name in RULES:
        assert name == name.lower().strip()
        assert not set(name) & set("()+,'\" ")
    assert len(set(RULES.values())) == len(RULES)
