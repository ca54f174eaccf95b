"""Sums, values and the best arm of a bandit, compared with sequences computed by hand (Eq. 4.15)."""

import copy
import math
import pickle

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kswarms.agents.learning.bandit import Bandit

LIST = st.lists(st.tuples(st.integers(0, 2), st.floats(-10, 100), st.floats(0.1, 200)), max_size=40)


def test_value_is_the_sum_of_rewards_over_the_sum_of_times() -> None:
    bandit = Bandit(2)
    for arm, reward, time in ((0, 3.0, 4.0), (1, 1.0, 8.0), (0, 0.0, 2.0), (0, -1.5, 2.0)):
        bandit.update(arm, reward, time)
    # Arm 0: (3 + 0 - 1.5) / (4 + 2 + 2) = 1.5 / 8; the mean of the quotients is 0.
    assert bandit.value(0) == 0.1875
    assert bandit.value(1) == 0.125
    assert (bandit.reward, bandit.time, bandit.count) == ([1.5, 1.0], [8.0, 8.0], [3.0, 1.0])


@given(LIST)
def test_sums_cover_the_whole_history(history: list[tuple[int, float, float]]) -> None:
    bandit = Bandit(3)
    for arm, reward, time in history:
        bandit.update(arm, reward, time)
    for arm in range(3):
        own = [(reward, time) for k, reward, time in history if k == arm]
        assert bandit.count[arm] == len(own)
        assert bandit.reward[arm] == pytest.approx(math.fsum(reward for reward, _ in own), abs=1e-9)
        assert bandit.time[arm] == pytest.approx(math.fsum(time for _, time in own))


def test_discounting_applies_to_all_earlier_conflicts_of_every_arm() -> None:
    bandit = Bandit(2)
    bandit.update(0, 4.0, 8.0, discount=0.5)
    bandit.update(1, 6.0, 4.0, discount=0.5)
    bandit.update(1, 1.0, 2.0, discount=0.5)
    # Arm 0 was discounted twice: 4/4, 8/4, 1/4. Arm 1: 6/2 + 1, 4/2 + 2, 1/2 + 1.
    assert (bandit.reward, bandit.time, bandit.count) == ([1.0, 4.0], [2.0, 4.0], [0.25, 1.5])
    # The value of an arm does not change while the other arm is chosen.
    assert bandit.value(0) == 0.5


def test_an_untried_arm_has_no_value_and_is_not_the_best() -> None:
    bandit = Bandit(3)
    assert bandit.best() is None
    assert math.isnan(bandit.value(1))
    bandit.update(1, -5.0, 10.0)
    assert bandit.best() == 1  # negative, but the best of the tried arms
    bandit.update(2, -1.0, 10.0)
    assert bandit.best() == 2


@pytest.mark.parametrize("arm", range(3))
def test_the_best_arm_has_the_greatest_value_not_reward_or_count(arm: int) -> None:
    bandit = Bandit(3)
    for other in range(3):
        if other != arm:
            bandit.update(other, 40.0, 100.0)
            bandit.update(other, 40.0, 100.0)
    bandit.update(arm, 0.9, 1.0)
    assert bandit.best() == arm


def test_the_first_of_equal_arms_is_the_best() -> None:
    bandit = Bandit(2)
    bandit.update(1, 1.0, 2.0)
    bandit.update(0, 2.0, 4.0)
    assert bandit.best() == 0


def test_copies_are_equal_and_repr_shows_the_sums() -> None:
    bandit = Bandit(2)
    bandit.update(1, 1.5, 3.0)
    bandit.choices = 2
    assert repr(bandit) == "Bandit(reward=[0.0, 1.5], time=[0.0, 3.0], count=[0.0, 1.0])"
    for twin in (copy.deepcopy(bandit), pickle.loads(pickle.dumps(bandit))):
        assert repr(twin) == repr(bandit)
        assert twin.choices == 2
        twin.update(0, 1.0, 1.0)
    assert bandit.count == [0.0, 1.0]
