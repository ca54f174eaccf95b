"""What every reward must do."""

import math
from collections.abc import Callable, Iterator
from itertools import product
from typing import Final

from kswarms.agents.conformance import shared as descriptions
from kswarms.agents.learning.rewards import Reward

Make = Callable[..., Reward]


def cases() -> Iterator[tuple[float, float, int, int, bool, int]]:
    """Return what a reward may be told: T(a), T(p), n', d, inter, opponent."""
    yield from product(
        (0.1, 2.3, 600.0), (0.0, 0.1, 6.0, 3000.0), (0, 3, 8), (-1, 1), (False, True), (1, 2, 9)
    )


def _rewards(reward: Reward) -> list[float]:
    return [reward.of(*case) for case in cases()]


def check_copies_are_equal_and_reward_alike(make: Make) -> None:
    """Check that copies, pickled ones too, are equal and reward alike."""
    descriptions.check_copies_are_alike(make, _rewards)


def check_it_is_frozen(make: Make) -> None:
    """Check that nothing changes it."""
    descriptions.check_it_is_frozen(make, _rewards)


def check_it_knows_no_other_arguments(make: Make) -> None:
    """Check that an argument that it does not have is refused."""
    descriptions.check_it_knows_no_other_arguments(make)


def check_a_reward_is_a_finite_number(make: Make) -> None:
    """Check that whatever the conflict was, R is a finite float."""
    for case in cases():
        r = make().of(*case)
        assert isinstance(r, float), f"of{case} is {r!r}, no float"
        assert math.isfinite(r), f"of{case} is {r}"


def check_the_same_conflict_brings_the_same(make: Make) -> None:
    """Check that R depends on the conflict alone, not on those before it."""
    one = make()
    first = {case: one.of(*case) for case in cases()}
    for case in reversed(list(first)):
        assert one.of(*case) == first[case], f"of{case} is another the second time"
        assert make().of(*case) == first[case], f"of{case} is another for another robot"


REWARD_CHECKS: Final[tuple[Callable[[Make], None], ...]] = (
    check_copies_are_equal_and_reward_alike,
    check_it_is_frozen,
    check_it_knows_no_other_arguments,
    check_a_reward_is_a_finite_number,
    check_the_same_conflict_brings_the_same,
)
"""Every check of a reward: of its class, or of what calls it with arguments."""
