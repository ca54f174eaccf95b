"""Checks of selection rules."""

import random
from collections.abc import Callable
from numbers import Integral
from typing import Final

import numpy as np
from numpy.random import Generator

from kswarms.agents.conformance import shared
from kswarms.agents.conformance.shared import require
from kswarms.agents.learning.bandit import Bandit
from kswarms.agents.learning.selection_rules import Rule
from kswarms.agents.streams import Purpose, stream

ARMS: Final = (1, 2, 3, 4)
Make = Callable[..., Rule]


def exploration_rng(seed: int = 0) -> Generator:
    """Return a robot's stream for exploration."""
    return stream(seed, 1, Purpose.EXPLORE)


def choose_arms(rule: Rule, arms: int, seed: int, conflicts: int = 60) -> list[int]:
    """Return the choices of a rule in conflicts whose outcomes depend on `seed` and the choices alone.

    Check that the factor is in (0, 1], choices are arms, and no choice changes the bandit.
    """
    bandit, rng, noise = Bandit(arms), exploration_rng(seed), np.random.default_rng(99)
    factor, chosen = rule.factor, []
    in_range = isinstance(factor, float | int) and 0 < factor <= 1
    require(in_range, f"factor must be a number above 0 and at most 1, not {factor!r}")
    for _ in range(conflicts):
        before = repr(bandit), bandit.choices
        arm = rule.choose(bandit, rng)
        is_arm = isinstance(arm, Integral) and 0 <= arm < arms
        require(is_arm, f"prefer(…) must return 0 to {arms - 1}, not {arm!r}")
        require((repr(bandit), bandit.choices) == before, "choose(…) must not change the bandit")
        chosen.append(arm)
        bandit.choices += 1
        bandit.update(arm, 5.0 + arm + noise.normal(0.0, 1.0), 10.0, factor)
    return chosen


def check_copies(make: Make) -> None:
    """Check that copies and pickled copies are equal and make the same choices."""
    shared.check_copies(make, lambda rule: choose_arms(rule, 3, seed=5))


def check_frozen(make: Make) -> None:
    """Check that the rule is immutable: learned values belong in the bandit."""
    shared.check_frozen(make, lambda rule: choose_arms(rule, 3, seed=5))


def check_same_seed_gives_same_choices(make: Make) -> None:
    """Check that the robot's stream is the only source of randomness, and that robots share no state."""
    for arms in ARMS:
        choices = choose_arms(make(), arms, seed=3)
        random.random()
        choose_arms(make(), arms, seed=4)
        require(choose_arms(make(), arms, seed=3) == choices, "the same seed gave other choices")


def check_choices_and_factor(make: Make) -> None:
    """Check that choices are arms and change no bandit, and that the discount factor is in (0, 1]."""
    for arms in ARMS:
        for seed in range(20):
            choose_arms(make(), arms, seed)


RULE_CHECKS: Final[tuple[Callable[[Make], None], ...]] = (
    check_copies,
    check_frozen,
    shared.check_unknown_arguments,
    check_same_seed_gives_same_choices,
    check_choices_and_factor,
)
"""The checks of a selection rule's class or factory."""
