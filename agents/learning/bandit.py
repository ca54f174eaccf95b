"""Multi-armed bandit with arms of different duration (specification, section 1.5)."""

import math

from kswarms.agents.common.errors import require_integer
from kswarms.agents.common.limits import MAX_ACTIONS


class Bandit:
    """A robot's experience of conflicts with one swarm.

    Parameters
    ----------
    arms : int
        Number of actions.

    Attributes
    ----------
    reward : list of float, length `arms`
        Σ R of each arm (s).
    time : list of float, length `arms`
        Σ (T(a) + T(p)) of each arm (s).
    count : list of float, length `arms`
        N(a), number of conflicts with the arm, discounted if the rule discounts.
    choices : int
        Number of choices so far, including open conflicts.
    """

    __slots__ = ("choices", "count", "reward", "time")

    def __init__(self, arms: int) -> None:
        require_integer("arms", arms, 1, MAX_ACTIONS)
        self.reward = [0.0] * arms
        self.time = [0.0] * arms
        self.count = [0.0] * arms
        self.choices = 0

    def update(self, arm: int, reward: float, time: float, discount: float = 1.0) -> float:
        """Add a conflict: its R and T(a) + T(p) (s); `discount` is λ of discounted UCB. Return Q(a)."""
        if discount != 1.0:
            for sums in (self.reward, self.time, self.count):
                sums[:] = [discount * value for value in sums]
        self.reward[arm] += reward
        self.time[arm] += time
        self.count[arm] += 1.0
        return self.value(arm)

    def value(self, arm: int) -> float:
        """Return Q(a) = Σ R / Σ (T(a) + T(p)) (Eq. 4.15), NaN if the arm is untried."""
        return self.reward[arm] / self.time[arm] if self.time[arm] > 0.0 else math.nan

    def best(self) -> int | None:
        """Return the tried arm with the greatest Q, the first of equals; None if no arm was tried."""
        tried = [arm for arm, count in enumerate(self.count) if count > 0.0]
        return max(tried, key=self.value, default=None)

    def __repr__(self) -> str:
        return f"Bandit(reward={self.reward}, time={self.time}, count={self.count})"
