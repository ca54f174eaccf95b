# haste.py
"""A reward and a selection rule, for any learner."""

from numpy.random import Generator
from pydantic import Field

from kswarms import Bandit, Reward, Rule


class Haste(Reward):
    """A second of program earns 1, a second of conflict costs `cost`."""

    cost: float = Field(0.5, ge=0)

    def of(self, t_a: float, t_p: float, n_active: int, direction: int, inter: bool, opponent: int) -> float:
        """Return R (s)."""
        return t_p - self.cost * t_a


class EpsilonGreedy(Rule):
    """The best arm; with probability `epsilon` a random arm."""

    epsilon: float = Field(0.1, ge=0, le=1)

    def prefer(self, bandit: Bandit, rng: Generator) -> int:
        """Return an arm; every arm has been tried."""
        arms = len(bandit.count)
        if rng.random() < self.epsilon:
            return int(rng.integers(arms))
        return max(range(arms), key=bandit.value)
