"""Selection rules: which arm to pull while learning (specification, section 1.5).

A rule is a frozen description with a method; a new one is a subclass of `Rule` under a name in `RULES`.
"""

import math
from abc import ABC, abstractmethod
from typing import Final

from numpy.random import Generator
from pydantic import Field

from agents.bandit import Bandit
from agents.validation import Checked

FORGOTTEN: Final = 1e-12
"""An arm whose discounted count is less counts as never tried."""


class Rule(Checked, ABC):
    """Base of the selection rules: arms never tried come first, in random order."""

    @property
    def factor(self) -> float:
        """What the past is multiplied by at each new conflict of the bandit, 1 to forget nothing."""
        return 1.0

    def choose(self, bandit: Bandit, draws: Generator) -> int:
        """Return the arm to pull now.

        Parameters
        ----------
        bandit : Bandit
            What is known.
        draws : numpy.random.Generator
            The robot's own stream for this purpose.
        """
        if min(bandit.count) < FORGOTTEN:
            untried = [arm for arm, count in enumerate(bandit.count) if count < FORGOTTEN]
            return untried[_pick(len(untried), draws)]
        return self.prefer(bandit, draws)

    @abstractmethod
    def prefer(self, bandit: Bandit, draws: Generator) -> int:
        """Return the arm to pull when all were tried."""


class UCB(Rule):
    """Upper confidence bound: argmax Q(a) + sqrt(γ ln N / N(a)) (Eq. 4.16).

    Attributes
    ----------
    gamma : float
        γ, how much is explored.
    """

    gamma: float = Field(0.155, ge=0)

    def prefer(self, bandit: Bandit, draws: Generator) -> int:
        """Return the arm of the greatest bound, ties broken at random."""
        scale, sqrt = self.gamma * math.log(sum(bandit.count)), math.sqrt
        bounds = [
            reward / time + sqrt(scale / count)
            for reward, time, count in zip(bandit.reward, bandit.time, bandit.count)  # noqa: B905  # one bandit's
        ]
        return _greatest(bounds, draws)


class DiscountedUCB(UCB):
    """UCB on sums that lose a part of their weight at each conflict (Garivier & Moulines 2008).

    Q, N(a) and N are the discounted ones: bonus sqrt(γ ln n_λ / N_λ(a)), n_λ = Σ_a N_λ(a).

    Attributes
    ----------
    discount : float
        λ, what remains of the past at each conflict of the bandit.
    """

    discount: float = Field(0.99, gt=0, le=1)

    @property
    def factor(self) -> float:
        """λ."""
        return self.discount


class Greedy(Rule):
    """Always the arm of the greatest Q."""

    def prefer(self, bandit: Bandit, draws: Generator) -> int:
        """Return the arm of the greatest Q, ties broken at random."""
        return _greatest([bandit.value(arm) for arm in range(len(bandit.count))], draws)


class PeriodicRandom(Greedy):
    """Greedy, but every so many choices one is random.

    Attributes
    ----------
    every : int
        Of each this many choices of a bandit the last is uniformly random.
    """

    every: int = Field(5, ge=1)

    def prefer(self, bandit: Bandit, draws: Generator) -> int:
        """Return a random arm if it is time for one, else that of the greatest Q."""
        if (bandit.choices + 1) % self.every == 0:
            return _pick(len(bandit.count), draws)
        return super().prefer(bandit, draws)


class UniformRandom(Rule):
    """Every arm with the same probability, whatever is known."""

    def choose(self, bandit: Bandit, draws: Generator) -> int:
        """Return a random arm, also while some were never tried."""
        return self.prefer(bandit, draws)

    def prefer(self, bandit: Bandit, draws: Generator) -> int:
        """Return a random arm."""
        return _pick(len(bandit.count), draws)


RULES: Final[dict[str, type[Rule]]] = {
    "ucb": UCB,
    "discounted-ucb": DiscountedUCB,
    "greedy": Greedy,
    "periodic-random": PeriodicRandom,
    "uniform-random": UniformRandom,
}
"""Every selection rule by its name."""


def _greatest(values: list[float], draws: Generator) -> int:
    most = max(values)
    first = values.index(most)
    if values.count(most) == 1:
        return first
    arms = [arm for arm, value in enumerate(values) if value == most]
    return arms[_pick(len(arms), draws)]


def _pick(n: int, draws: Generator) -> int:
    return int(draws.random() * n)
