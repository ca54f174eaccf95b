"""What every selection rule must do."""

import random
from collections.abc import Callable
from numbers import Integral
from typing import Final

import numpy as np
from numpy.random import Generator

from kswarms.agents.conformance import shared as descriptions
from kswarms.agents.learning.bandit import Bandit
from kswarms.agents.learning.selection_rules import Rule
from kswarms.agents.streams import Purpose, stream

ARMS: Final = (1, 2, 3, 4)
Make = Callable[..., Rule]


def draws(seed: int = 0) -> Generator:
    """Return a robot's stream for the choices of its rule."""
    return stream(seed, 1, Purpose.EXPLORE)


def play(rule: Rule, arms: int, seed: int, conflicts: int = 60) -> list[int]:
    """Choose and learn in a world of its own, the same whatever the rule draws; return the choices."""
    known, own, world = Bandit(arms), draws(seed), np.random.default_rng(99)
    chosen: list[int] = []
    for _ in range(conflicts):
        noise = world.normal(0.0, 1.0)
        arm = rule.choose(known, own)
        assert isinstance(arm, Integral), f"it chose {arm!r}, no whole number"
        assert arm in range(arms), f"it chose arm {arm} of {arms}"
        chosen.append(arm)
        known.choices += 1
        known.update(arm, 5.0 + arm + noise, 10.0, rule.factor)
    return chosen


def tried(values: list[float]) -> Bandit:
    """Build a bandit that tried every arm as often, with these values of Q."""
    known = Bandit(len(values))
    for arm, value in enumerate(values):
        for _ in range(8):
            known.update(arm, 10.0 * value, 10.0)
    known.choices = 8 * len(values)
    return known


def _choices(rule: Rule) -> list[int]:
    return play(rule, 3, seed=5)


def check_copies_are_equal_and_choose_alike(make: Make) -> None:
    """Check that copies, pickled ones too, are equal and choose alike."""
    descriptions.check_copies_are_alike(make, _choices)


def check_it_is_frozen(make: Make) -> None:
    """Check that nothing changes it: what is learned is the bandit's."""
    descriptions.check_it_is_frozen(make, _choices)


def check_it_knows_no_other_arguments(make: Make) -> None:
    """Check that an argument that it does not have is refused."""
    descriptions.check_it_knows_no_other_arguments(make)


def check_same_seed_same_choices(make: Make) -> None:
    """Check that neither draws elsewhere nor another robot that plays in between make a difference."""
    for arms in ARMS:
        choices = play(make(), arms, seed=3)
        random.random()
        play(make(), arms, seed=4)
        assert play(make(), arms, seed=3) == choices, "the same seed gave other choices"


def check_every_choice_is_an_arm(make: Make) -> None:
    """Check that every choice is one of the arms, counted from 0."""
    for arms in ARMS:
        for seed in range(20):
            play(make(), arms, seed)


def check_choosing_changes_nothing_that_is_known(make: Make) -> None:
    """Check that a choice leaves the bandit as it was."""
    for known in (Bandit(3), tried([0.1, 0.2, 0.3])):
        before = repr(known), known.choices
        for seed in range(30):
            make().choose(known, draws(seed))
        assert (repr(known), known.choices) == before, "a choice changed the bandit"


def check_it_forgets_no_more_than_all(make: Make) -> None:
    """Check that the factor of the past is above 0 and at most 1."""
    assert 0.0 < make().factor <= 1.0, f"the factor is {make().factor}"


RULE_CHECKS: Final[tuple[Callable[[Make], None], ...]] = (
    check_copies_are_equal_and_choose_alike,
    check_it_is_frozen,
    check_it_knows_no_other_arguments,
    check_same_seed_same_choices,
    check_every_choice_is_an_arm,
    check_choosing_changes_nothing_that_is_known,
    check_it_forgets_no_more_than_all,
)
"""Every check of a selection rule: of its class, or of what calls it with arguments."""
