"""Selection rules: which arm to pull while learning (specification, section 1.5).

A rule is a frozen description with a method; a new one is a subclass of `Rule`, under a name in `RULES` or in
a file of a user's own.
"""

import math
from abc import ABC, abstractmethod
from numbers import Integral
from typing import Final

from numpy.random import Generator
from pydantic import Field

from kswarms.agents.common.descriptions import Checked
from kswarms.agents.common.errors import InputError
from kswarms.agents.learning.bandit import Bandit
from kswarms.agents.streams import Purpose, stream
from kswarms.agents.user_code.loading import blaming, is_reference
from kswarms.agents.user_code.syntax import build, parse_call

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
        """Return the arm to pull, from 0, when all were tried."""


class UCB(Rule):
    """Upper confidence bound: argmax Q(a) + sqrt(γ ln N / N(a)) (Eq. 4.16).

    Attributes
    ----------
    gamma : float
        γ, how much is explored.
    """

    gamma: float = Field(0.1211, ge=0)

    def bounds(self, bandit: Bandit) -> list[float]:
        """Return Q(a) + sqrt(γ ln N / N(a)) of each arm; all must have been tried."""
        scale, sqrt = self.gamma * math.log(sum(bandit.count)), math.sqrt
        return [
            reward / time + sqrt(scale / count)
            for reward, time, count in zip(bandit.reward, bandit.time, bandit.count)  # noqa: B905  # one bandit's
        ]

    def prefer(self, bandit: Bandit, draws: Generator) -> int:
        """Return the arm of the greatest bound, ties broken at random."""
        return _greatest(self.bounds(bandit), draws)


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


def make_rule(text: str, arms: int) -> Rule:
    """Build the rule that a text describes, and try one from outside.

    Parameters
    ----------
    text : str
        One of `RULES`, or a subclass of `Rule` as ``path/to/my_file.py:MyRule``, with arguments.
    arms : int
        Number of actions that it is to choose from.

    Raises
    ------
    InputError
        If there is no such rule, or it chooses what is no arm.
    """
    rule = build("rule", text, RULES, Rule)
    name = parse_call("rule", text).name
    if is_reference(name):
        bandit, draws = Bandit(arms), stream(0, 0, Purpose.EXPLORE)
        with blaming("rule", name, "factor"):
            factor = rule.factor
        if not isinstance(factor, float | int) or not 0 < factor <= 1:
            raise InputError("rule", name, f"factor must be a number above 0 and at most 1, not {factor!r}")
        for _ in range(2 * arms):
            with blaming("rule", name, "choose(…)"):
                arm = rule.choose(bandit, draws)
            if not isinstance(arm, Integral) or not 0 <= arm < arms:
                raise InputError("rule", name, f"prefer(…) must return 0 to {arms - 1}, not {arm!r}")
            bandit.choices += 1
            with blaming("rule", name, "choose(…) changes the bandit, and its update"):
                bandit.update(arm, 1.0, 2.0, factor)
    return rule


def _greatest(values: list[float], draws: Generator) -> int:
    most = max(values)
    first = values.index(most)
    if values.count(most) == 1:
        return first
    arms = [arm for arm, value in enumerate(values) if value == most]
    return arms[_pick(len(arms), draws)]


def _pick(n: int, draws: Generator) -> int:
    return int(draws.random() * n)
