# haste.py
"""A reward and a selection rule, for any learner."""

from numpy.random import Generator
from pydantic import Field

from kswarms.agents.learning.bandit import Bandit
from kswarms.agents.learning.rewards import Reward
from kswarms.agents.learning.selection_rules import Rule


class Haste(Reward):
    """Program time is worth its seconds, a conflict costs `cost` for each of its own."""

    cost: float = Field(0.5, ge=0)

    def of(self, t_a: float, t_p: float, n_active: int, direction: int, inter: bool, opponent: int) -> float:
        """Return R (s)."""
        return t_p - self.cost * t_a


class EpsilonGreedy(Rule):
    """The best arm, but with probability `epsilon` a random one."""

    epsilon: float = Field(0.1, ge=0, le=1)

    def prefer(self, bandit: Bandit, draws: Generator) -> int:
        """Return the arm to pull when all were tried."""
        arms = len(bandit.count)
        if draws.random() < self.epsilon:
            return int(draws.integers(arms))
        return max(range(arms), key=bandit.value)
