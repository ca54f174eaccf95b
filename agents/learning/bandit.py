"""A multi-armed bandit whose arms are actions of different length (specification, section 1.5)."""

import math


class Bandit:
    """What a robot has learned about conflicts with one swarm.

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
        N(a): conflicts in which the arm was taken, discounted where the rule discounts.
    choices : int
        Choices made so far, those of conflicts that are still open included.
    """

    __slots__ = ("choices", "count", "reward", "time")

    def __init__(self, arms: int) -> None:
        self.reward = [0.0] * arms
        self.time = [0.0] * arms
        self.count = [0.0] * arms
        self.choices = 0

    def update(self, arm: int, reward: float, time: float, discount: float = 1.0) -> None:
        """Add a conflict.

        Parameters
        ----------
        arm : int
            The action taken.
        reward : float
            R of the conflict (s).
        time : float
            T(a) + T(p) of the conflict (s).
        discount : float
            Factor by which all that was there before loses weight, λ of discounted UCB.
        """
        if discount != 1.0:
            for sums in (self.reward, self.time, self.count):
                sums[:] = [discount * value for value in sums]
        self.reward[arm] += reward
        self.time[arm] += time
        self.count[arm] += 1.0

    def value(self, arm: int) -> float:
        """Return Q(a) = Σ R / Σ (T(a) + T(p)) (Eq. 4.15), NaN if the arm was never tried."""
        return self.reward[arm] / self.time[arm] if self.time[arm] > 0.0 else math.nan

    def best(self) -> int | None:
        """Return the tried arm of the greatest Q, the first of equals; none if nothing was tried."""
        tried = [arm for arm, count in enumerate(self.count) if count > 0.0]
        return max(tried, key=self.value, default=None)

    def __repr__(self) -> str:
        return f"Bandit(reward={self.reward}, time={self.time}, count={self.count})"
