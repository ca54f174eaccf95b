"""Checks of rewards."""

import math
from collections.abc import Callable, Iterable, Iterator
from itertools import product
from typing import Final

from kswarms.agents.conformance import shared
from kswarms.agents.conformance.shared import require
from kswarms.agents.learning.rewards import Reward

Make = Callable[..., Reward]
Case = tuple[float, float, int, int, bool, int]
"""Arguments of `Reward.of`: T(a), T(p), n', d, inter, opponent."""


def cases() -> Iterator[Case]:
    """Return arguments of `Reward.of` that cover its range."""
    yield from product(
        (0.1, 2.3, 600.0), (0.0, 0.1, 6.0, 3000.0), (0, 3, 8), (-1, 1), (False, True), (1, 2, 9)
    )


def compute_rewards(reward: Reward, conflicts: Iterable[Case]) -> list[float]:
    """Return the rewards of conflicts; check that they are finite."""
    rewards = []
    for case in conflicts:
        r = reward.of(*case)
        is_finite = isinstance(r, float | int) and math.isfinite(r)
        require(is_finite, f"of{case} must return a finite float, not {r!r}")
        rewards.append(r)
    return rewards


def check_copies(make: Make) -> None:
    """Check that copies and pickled copies are equal and give the same rewards."""
    shared.check_copies(make, lambda reward: [reward.of(*case) for case in cases()])


def check_frozen(make: Make) -> None:
    """Check that the reward is immutable."""
    shared.check_frozen(make, lambda reward: [reward.of(*case) for case in cases()])


def check_rewards_are_finite(make: Make) -> None:
    """Check that R is a finite number for every conflict."""
    compute_rewards(make(), cases())


def check_same_conflict_gives_same_reward(make: Make) -> None:
    """Check that R depends on the conflict alone, not on earlier ones."""
    one = make()
    first = {case: one.of(*case) for case in cases()}
    for case in reversed(list(first)):
        require(one.of(*case) == first[case], f"of{case} differs the second time")
        require(make().of(*case) == first[case], f"of{case} differs for another robot")


REWARD_CHECKS: Final[tuple[Callable[[Make], None], ...]] = (
    check_copies,
    check_frozen,
    shared.check_unknown_arguments,
    check_rewards_are_finite,
    check_same_conflict_gives_same_reward,
)
"""The checks of a reward's class or factory."""
