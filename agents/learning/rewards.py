"""Rewards of conflicts, computed from what the robot itself senses (specification, section 1.4).

A reward is an immutable object with a method. A new reward is a subclass of `Reward`: named in `REWARDS`, or
user-defined. All robots of a policy share one reward object.
"""

from abc import ABC, abstractmethod
from functools import lru_cache
from typing import Annotated, Final

from pydantic import Discriminator, Field, Tag

from kswarms.agents.body import SENSORS
from kswarms.agents.common.descriptions import FrozenModel
from kswarms.agents.theory.estimates import estimated_wlu, program_weight_of_equals, sigma
from kswarms.agents.theory.times import intra_utility
from kswarms.agents.user_code.syntax import build


def _kind(value: object) -> str:
    return "by-opponent" if isinstance(value, dict) else "for-all"


# Discriminated unions, so that an error message refers to the given form.
_Delta = Annotated[float, Field(strict=True, ge=0, le=1)]
_Deltas = Annotated[
    Annotated[_Delta, Tag("for-all")] | Annotated[dict[int, _Delta], Tag("by-opponent")], Discriminator(_kind)
]
_Ratio = Annotated[float, Field(strict=True, gt=0, lt=3)]
_Ratios = Annotated[
    Annotated[_Ratio, Tag("for-all")] | Annotated[dict[int, _Ratio], Tag("by-opponent")], Discriminator(_kind)
]


Weights = tuple[float, list[float]]
"""Weight of T(p), and the weight of T(a) for each number of active sensors."""


class Reward(FrozenModel, ABC):
    """Base class of rewards."""

    def opponents(self) -> frozenset[int]:
        """Return the swarm-IDs (from 1) that the arguments name."""
        return frozenset()

    @abstractmethod
    def of(self, t_a: float, t_p: float, n_active: int, direction: int, inter: bool, opponent: int) -> float:
        """Return R of a closed conflict (s).

        Parameters
        ----------
        t_a, t_p : float
            T(a) and T(p) (s).
        n_active : int
            n'_i, number of active sensors at the start of the conflict, 0 to 8.
        direction : {-1, 1}
            d of the action: +1 towards the other robot, −1 away.
        inter : bool
            Whether the other robot belongs to another swarm.
        opponent : int
            Swarm-ID of the other robot, from 1.
        """

    def linear_weights(self, direction: int, inter: bool, opponent: int) -> Weights | None:
        """Return the weights of T(p) and, for n' from 0 to 8, of T(a), if R is their sum; else None.

        They save a call of `of` for each conflict. A subclass that has its own `of` inherits no weights.
        """
        return None


class WLU(Reward):
    """Wonderful Life Utility: R = (3 − b)/2 · T(p) + (n'/8) · σ · Δ · T(a) (Eqs. 5.4, 6.2, 7.2)."""

    delta: _Deltas = 0.125  # Δ for all opponents, or by swarm-ID with 0.125 for others
    b: _Ratios = 1.0  # advantage β_m/β_i of all opponents, or by swarm-ID with 1 for others

    def opponents(self) -> frozenset[int]:
        """Return the swarm-IDs with their own Δ or b."""
        return frozenset(swarm for each in (self.delta, self.b) if isinstance(each, dict) for swarm in each)

    def of(self, t_a: float, t_p: float, n_active: int, direction: int, inter: bool, opponent: int) -> float:
        """Return R (s)."""
        delta, b = self._parameters(opponent)
        program = program_weight_of_equals(b)
        return estimated_wlu(program, t_a, t_p, n_active, sigma(inter, direction), delta)

    def linear_weights(self, direction: int, inter: bool, opponent: int) -> Weights | None:
        """Return the weights of T(p) and, for each n', of T(a)."""
        if type(self).of is not WLU.of:
            return None
        delta, b = self._parameters(opponent)
        return _wlu_weights(b, sigma(inter, direction), delta)

    def _parameters(self, opponent: int) -> tuple[float, float]:
        """Return Δ and b of an opponent."""
        delta, b = self.delta, self.b
        return (
            delta if isinstance(delta, float) else delta.get(opponent, 0.125),
            b if isinstance(b, float) else b.get(opponent, 1.0),
        )


@lru_cache(maxsize=64)
def _wlu_weights(b: float, sign: int, delta: float) -> Weights:
    of_action = [estimated_wlu(0.0, 1.0, 0.0, n, sign, delta) for n in range(SENSORS + 1)]
    return program_weight_of_equals(b), of_action


class IndividualUtility(Reward):
    """The robot's own utility: r = w · T(p) − w · Δ · T(a), w = n'/8 (Eq. 6.3)."""

    delta: _Delta = 0.125
    half: bool = False  # whether w is the constant ½ instead

    def of(self, t_a: float, t_p: float, n_active: int, direction: int, inter: bool, opponent: int) -> float:
        """Return r (s)."""
        weight = 0.5 if self.half else n_active / SENSORS
        return intra_utility(weight, t_a, t_p, self.delta, 1.0)


class SingleSwarmWLU(Reward):
    """WLU in a game of one swarm: R = (n'/8) · (T(p) − κ T(a)) (section 6.3.5)."""

    kappa: float = Field(3.0, ge=0)  # κ = (α_i + ᾱ_k + β)/β; 3 for α = β

    def of(self, t_a: float, t_p: float, n_active: int, direction: int, inter: bool, opponent: int) -> float:
        """Return R (s)."""
        return intra_utility(n_active / SENSORS, t_a, t_p, self.kappa, 1.0)


REWARDS: Final[dict[str, type[Reward]]] = {
    "wlu": WLU,
    "individual": IndividualUtility,
    "single-swarm": SingleSwarmWLU,
}
"""The rewards by name."""


def make_reward(reward: str | Reward) -> Reward:
    """Return a reward, built from its text if one is given.

    A text is the name of one of `REWARDS` or a user-defined subclass of `Reward`, with arguments.
    """
    return reward if isinstance(reward, Reward) else build("reward", reward, REWARDS, Reward)
