"""Selection rules: the choice of an arm while learning (specification, section 1.5).

A rule is an immutable object with a method. A new rule is a subclass of `Rule`: named in `RULES`, or
user-defined. All robots of a policy share one rule object; learned values are in their bandits.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable
from functools import lru_cache, partial
from math import log, sqrt
from typing import Final

from numpy.random import Generator
from pydantic import Field

from kswarms.agents.common.descriptions import FrozenModel
from kswarms.agents.learning.bandit import Bandit
from kswarms.agents.user_code.syntax import build

GAMMA: Final = 0.1211
"""Default of γ, the weight of exploration in UCB."""
FORGOTTEN: Final = 1e-12  # an arm with a smaller discounted count is treated as untried


class Rule(FrozenModel, ABC):
    """Base class of selection rules: untried arms come first, in random order."""

    @property
    def factor(self) -> float:
        """Factor by which each new conflict of a bandit discounts its earlier ones; 1 for no discounting."""
        return 1.0

    def in_game(self, gamma: float) -> "Rule":
        """Return the rule for a game with this γ; rules without a γ, or with their own, are unchanged."""
        return self

    def choose(self, bandit: Bandit, rng: Generator) -> int:
        """Return the arm to pull, from 0; `rng` is the robot's stream for exploration."""
        if min(bandit.count) < FORGOTTEN:
            untried = [arm for arm, count in enumerate(bandit.count) if count < FORGOTTEN]
            return untried[_random_index(len(untried), rng)]
        return self.prefer(bandit, rng)

    def fast_choose(self) -> Callable[[Bandit, Generator], int]:
        """Return `choose`, or a faster function that returns the same."""
        return self.choose

    @abstractmethod
    def prefer(self, bandit: Bandit, rng: Generator) -> int:
        """Return the arm to pull, from 0, once all arms have been tried.

        Parameters
        ----------
        bandit : Bandit
            Experience of conflicts with the opponent's swarm. A rule must not change it.
        rng : numpy.random.Generator
            The robot's stream for exploration. A rule must not use other sources of randomness.
        """


class UCB(Rule):
    """Upper confidence bound: argmax Q(a) + sqrt(γ ln N / N(a)) (Eq. 4.16)."""

    gamma: float | None = Field(None, ge=0)  # γ, the weight of exploration; None: that of the game

    @property
    def weight(self) -> float:
        """γ, the weight of exploration."""
        return GAMMA if self.gamma is None else self.gamma

    def in_game(self, gamma: float) -> Rule:
        """Return the rule with this γ, unless it has its own."""
        return _with_gamma(self, gamma) if self.gamma is None else self

    def bounds(self, bandit: Bandit) -> list[float]:
        """Return Q(a) + sqrt(γ ln N / N(a)) of each arm, all of which must have been tried."""
        scale = self.weight * log(sum(bandit.count))
        return [
            reward / time + sqrt(scale / count)
            for reward, time, count in zip(bandit.reward, bandit.time, bandit.count)  # noqa: B905  # same length
        ]

    def prefer(self, bandit: Bandit, rng: Generator) -> int:
        """Return the arm with the greatest bound, ties broken at random."""
        return _argmax(self.bounds(bandit), rng)

    def fast_choose(self) -> Callable[[Bandit, Generator], int]:
        """Return a function for two arms, the usual number, unless a subclass chooses otherwise."""
        kind = type(self)
        if (kind.choose, kind.prefer, kind.bounds) != (UCB.choose, UCB.prefer, UCB.bounds):
            return self.choose
        return partial(_choose_of_two, self.weight, self.choose)


class DiscountedUCB(UCB):
    """UCB on discounted sums (Garivier & Moulines 2008).

    Q, N(a) and N are discounted: the bonus is sqrt(γ ln n_λ / N_λ(a)), n_λ = Σ_a N_λ(a).
    """

    discount: float = Field(0.99, gt=0, le=1)  # λ, the discount factor at each conflict of the bandit

    @property
    def factor(self) -> float:
        """λ."""
        return self.discount


class Greedy(Rule):
    """The arm with the greatest Q."""

    def prefer(self, bandit: Bandit, rng: Generator) -> int:
        """Return the arm with the greatest Q, ties broken at random."""
        return _argmax([bandit.value(arm) for arm in range(len(bandit.count))], rng)


class PeriodicRandom(Greedy):
    """Greedy, except that every `every`-th choice is random."""

    every: int = Field(5, ge=1)  # period of the uniformly random choices, counted for each bandit

    def prefer(self, bandit: Bandit, rng: Generator) -> int:
        """Return a random arm if one is due, else the arm with the greatest Q."""
        if (bandit.choices + 1) % self.every == 0:
            return _random_index(len(bandit.count), rng)
        return super().prefer(bandit, rng)


class UniformRandom(Rule):
    """Every arm with the same probability."""

    def choose(self, bandit: Bandit, rng: Generator) -> int:
        """Return a random arm, also while some are untried."""
        return self.prefer(bandit, rng)

    def prefer(self, bandit: Bandit, rng: Generator) -> int:
        """Return a random arm."""
        return _random_index(len(bandit.count), rng)


RULES: Final[dict[str, type[Rule]]] = {
    "ucb": UCB,
    "discounted-ucb": DiscountedUCB,
    "greedy": Greedy,
    "periodic-random": PeriodicRandom,
    "uniform-random": UniformRandom,
}
"""The selection rules by name."""


def make_rule(rule: str | Rule) -> Rule:
    """Return a selection rule, built from its text if one is given.

    A text is the name of one of `RULES` or a user-defined subclass of `Rule`, with arguments.
    """
    return rule if isinstance(rule, Rule) else build("rule", rule, RULES, Rule)


@lru_cache(maxsize=64)  # the robots of a swarm share one rule
def _with_gamma(rule: UCB, gamma: float) -> UCB:
    return rule.replace(gamma=gamma)


def _choose_of_two(
    gamma: float, choose: Callable[[Bandit, Generator], int], bandit: Bandit, rng: Generator
) -> int:
    """Return `UCB.choose` for two arms, without a loop and access to fields, which are slow.

    Other numbers of arms, untried arms and ties are left to `choose`.
    """
    counts = bandit.count
    if len(counts) == 2:
        first, second = counts
        if first >= FORGOTTEN and second >= FORGOTTEN:
            scale = gamma * log(first + second)
            reward, other_reward = bandit.reward
            time, other_time = bandit.time
            bound = reward / time + sqrt(scale / first)
            other_bound = other_reward / other_time + sqrt(scale / second)
            if bound != other_bound:
                return 0 if bound > other_bound else 1
    return choose(bandit, rng)


def _argmax(values: list[float], rng: Generator) -> int:
    greatest = max(values)
    first = values.index(greatest)
    if values.count(greatest) == 1:
        return first
    arms = [arm for arm, value in enumerate(values) if value == greatest]
    return arms[_random_index(len(arms), rng)]


def _random_index(n: int, rng: Generator) -> int:
    return int(rng.random() * n)
