"""Rewards: what a conflict was worth, by what the robot itself sensed (specification, section 1.4).

A reward is a frozen description with a method; a new one is a subclass of `Reward`, under a name in `REWARDS`
or in a file of a user's own.
"""

import math
from abc import ABC, abstractmethod
from itertools import product
from typing import Annotated, Final

from pydantic import Discriminator, Field, Tag

from kswarms.agents.common.descriptions import Checked
from kswarms.agents.common.errors import InputError
from kswarms.agents.robot.body import SENSORS
from kswarms.agents.theory.estimates import estimated_wlu, program_weight_of_equals, sigma
from kswarms.agents.theory.times import intra_utility
from kswarms.agents.user_code.loading import blaming, is_reference
from kswarms.agents.user_code.syntax import build, parse_call


def _kind(value: object) -> str:
    return "by-opponent" if isinstance(value, dict) else "for-all"


# Told apart by what is given, so that an error speaks of the form that was meant.
_Delta = Annotated[float, Field(strict=True, ge=0, le=1)]
_Deltas = Annotated[
    Annotated[_Delta, Tag("for-all")] | Annotated[dict[int, _Delta], Tag("by-opponent")], Discriminator(_kind)
]
_Ratio = Annotated[float, Field(strict=True, gt=0, lt=3)]
_Ratios = Annotated[
    Annotated[_Ratio, Tag("for-all")] | Annotated[dict[int, _Ratio], Tag("by-opponent")], Discriminator(_kind)
]


class Reward(Checked, ABC):
    """Base of the rewards."""

    def opponents(self) -> frozenset[int]:
        """Return the swarm-IDs (from 1) that it names."""
        return frozenset()

    @abstractmethod
    def of(self, t_a: float, t_p: float, n_active: int, direction: int, inter: bool, opponent: int) -> float:
        """Return R of a closed conflict (s).

        Parameters
        ----------
        t_a, t_p : float
            T(a) and T(p) (s).
        n_active : int
            n'_i: sensors of the eight that were active when it began.
        direction : {-1, 1}
            d of the action taken: +1 towards the other robot, −1 away.
        inter : bool
            Whether the other robot was of another swarm.
        opponent : int
            Swarm-ID of the other robot, from 1.
        """


class WLU(Reward):
    """Wonderful Life Utility: R = (3 − b)/2 · T(p) + (n'/8) · σ · Δ · T(a) (Eqs. 5.4, 6.2, 7.2).

    Attributes
    ----------
    delta : float, or dict of int to float
        Δ, for all opponents or for each swarm-ID (0.125 for those not named).
    b : float, or dict of int to float
        The opponent's advantage β_m/β_i, likewise (1 for those not named).
    """

    delta: _Deltas = 0.125
    b: _Ratios = 1.0

    def opponents(self) -> frozenset[int]:
        """Return the swarm-IDs that have a Δ or b of their own."""
        return frozenset(swarm for each in (self.delta, self.b) if isinstance(each, dict) for swarm in each)

    def of(self, t_a: float, t_p: float, n_active: int, direction: int, inter: bool, opponent: int) -> float:
        """Return R (s)."""
        delta = self.delta if isinstance(self.delta, float) else self.delta.get(opponent, 0.125)
        b = self.b if isinstance(self.b, float) else self.b.get(opponent, 1.0)
        program = program_weight_of_equals(b)
        return estimated_wlu(program, t_a, t_p, n_active, sigma(inter, direction), delta)


class IndividualUtility(Reward):
    """The robot's own utility: r = w · T(p) − w · Δ · T(a), w = n'/8 (Eq. 6.3).

    Attributes
    ----------
    delta : float
        Δ.
    half : bool
        Whether w is the constant ½ instead.
    """

    delta: _Delta = 0.125
    half: bool = False

    def of(self, t_a: float, t_p: float, n_active: int, direction: int, inter: bool, opponent: int) -> float:
        """Return r (s)."""
        weight = 0.5 if self.half else n_active / SENSORS
        return intra_utility(weight, t_a, t_p, self.delta, 1.0)


class SingleSwarmWLU(Reward):
    """WLU of a swarm that is alone: R = (n'/8) · (T(p) − κ T(a)) (section 6.3.5).

    Attributes
    ----------
    kappa : float
        κ = (α_i + ᾱ_k + β)/β; 3 for α = β.
    """

    kappa: float = Field(3.0, ge=0)

    def of(self, t_a: float, t_p: float, n_active: int, direction: int, inter: bool, opponent: int) -> float:
        """Return R (s)."""
        return intra_utility(n_active / SENSORS, t_a, t_p, self.kappa, 1.0)


REWARDS: Final[dict[str, type[Reward]]] = {
    "wlu": WLU,
    "individual": IndividualUtility,
    "single-swarm": SingleSwarmWLU,
}
"""Every reward by its name."""


def make_reward(text: str) -> Reward:
    """Build the reward that a text describes, and try one from outside.

    Parameters
    ----------
    text : str
        One of `REWARDS`, or a subclass of `Reward` as ``path/to/my_file.py:MyReward``, with arguments.

    Raises
    ------
    InputError
        If there is no such reward, or it gives something else than a finite float.
    """
    reward = build("reward", text, REWARDS, Reward)
    name = parse_call("reward", text).name
    if is_reference(name):
        for t_p, direction, inter in product((0.0, 6.0), (-1, 1), (False, True)):
            with blaming("reward", name, "of(…)"):
                earned = reward.of(1.8, t_p, 3, direction, inter, 1)
            if not isinstance(earned, float | int) or not math.isfinite(earned):
                raise InputError("reward", name, f"of(…) must return a finite float, not {earned!r}")
    return reward
