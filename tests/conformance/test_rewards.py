"""Conformance of all rewards in `REWARDS`.

Checks that apply to user-defined rewards too are in `kswarms.agents.conformance`; the others are here. Each
check takes a class. For each check, there is a reward that fails it.
"""

import math
from collections.abc import Callable
from itertools import product
from typing import Any, Final

import pytest
from pydantic import Field

from kswarms.agents.common.errors import InputError
from kswarms.agents.conformance import REWARD_CHECKS
from kswarms.agents.conformance.rewards import cases
from kswarms.agents.learning.rewards import REWARDS, WLU, IndividualUtility, Reward


def check_numbers_are_checked(reward: type[Reward]) -> None:
    for field, default in reward():
        if isinstance(default, float):
            for value in (math.nan, math.inf, -math.inf, -1.0, "much", None):
                with pytest.raises(InputError) as caught:
                    reward(**{field: value})
                assert caught.value.field == field


def check_program_time_increases_the_reward(reward: type[Reward]) -> None:
    for t_a, t_p, *rest in cases():
        assert reward().of(t_a, t_p + 1.0, *rest) >= reward().of(t_a, t_p, *rest)
    for d, inter in product((-1, 1), (False, True)):
        assert reward().of(1.0, 2.0, 8, d, inter, 1) > reward().of(1.0, 1.0, 8, d, inter, 1)


def check_it_is_in_seconds(reward: type[Reward]) -> None:
    """Q is a reward per second, so twice the times give twice the reward (Eqs. 4.15, 5.4)."""
    for t_a, t_p, *rest in cases():
        assert reward().of(2 * t_a, 2 * t_p, *rest) == pytest.approx(2 * reward().of(t_a, t_p, *rest))


def check_rewards_are_linear_in_active_sensors(reward: type[Reward]) -> None:
    """R is linear in n' (Eqs. 5.4, 6.3)."""
    for t_a, t_p, n_active, *rest in cases():
        none, all_of_them = (reward().of(t_a, t_p, n, *rest) for n in (0, 8))
        expected = none + n_active / 8 * (all_of_them - none)
        assert reward().of(t_a, t_p, n_active, *rest) == pytest.approx(expected, abs=1e-9)


class Unequal(IndividualUtility):
    """Equals only itself."""

    def __eq__(self, other: object) -> bool:
        return self is other

    __hash__ = IndividualUtility.__hash__


class Mutable(IndividualUtility):
    """Is not frozen."""

    model_config = {"frozen": False}


class AnyArgument(WLU):
    """Accepts any argument."""

    model_config = {"extra": "ignore"}


class AcceptsNaN(WLU):
    """Accepts NaN and infinities."""

    model_config = {"allow_inf_nan": True}
    bonus: float = 0.0


class ReturnsNaN(WLU):
    """Returns NaN."""

    def of(self, *conflict: Any) -> float:
        return 1 if conflict[1] else math.nan


class Stateful(WLU):
    """Returns less each time."""

    given: list[float] = Field(default_factory=list)

    def of(self, *conflict: Any) -> float:
        self.given.append(0.0)
        return super().of(*conflict) / len(self.given)


class DecreasingInProgramTime(WLU):
    """Decreases with program time."""

    def of(self, t_a: float, t_p: float, *rest: Any) -> float:
        return super().of(t_a, -t_p, *rest)


class WithBonus(WLU):
    """Adds a bonus of 1 for each conflict, however short."""

    def of(self, *conflict: Any) -> float:
        return super().of(*conflict) + 1.0


class QuadraticInSensors(WLU):
    """Is quadratic in n'."""

    def of(self, t_a: float, t_p: float, n_active: int, *rest: Any) -> float:
        return super().of(t_a, t_p, n_active * n_active, *rest)


Check = Callable[[Any], None]
CHECKS: Final[dict[Check, type[Reward]]] = {
    check_numbers_are_checked: AcceptsNaN,
    **dict(zip(REWARD_CHECKS, (Unequal, Mutable, AnyArgument, ReturnsNaN, Stateful), strict=True)),
    check_program_time_increases_the_reward: DecreasingInProgramTime,
    check_it_is_in_seconds: WithBonus,
    check_rewards_are_linear_in_active_sensors: QuadraticInSensors,
}
"""Each check with a reward that fails it."""


@pytest.mark.parametrize("name", REWARDS)
@pytest.mark.parametrize("check", CHECKS)
def test_every_reward_passes_every_check(name: str, check: Check) -> None:
    check(REWARDS[name])


@pytest.mark.parametrize("check", CHECKS)
def test_every_check_refuses_a_bad_reward(check: Check) -> None:
    with pytest.raises((AssertionError, InputError, pytest.fail.Exception)):
        check(CHECKS[check])
