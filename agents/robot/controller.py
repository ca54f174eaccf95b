"""Constants of the controller."""

import math
from typing import Final, NamedTuple

import numpy as np

from kswarms.agents.common.arrays import Floats

_ROUNDING: Final = 1e-9
"""Maximum rounding error of a quotient such as 0.3 / 0.1."""


class Controller(NamedTuple):
    """Constants of a robot's controller; lengths in metres, angles in radians."""

    period: float  # control period (s)
    turn_step: float  # maximum turn in a period
    leg_mean: float  # mean duration of a wander leg (s)
    wander_turn: float  # turns between legs are uniform within ± this angle
    half: float  # half the side of the arena
    wall_reach: float  # as in `walls_met`
    wall_half_angle: float  # as in `walls_met`
    radius: float  # of the body
    active_range: float  # a sensor that reads a smaller distance is active
    escape_away: bool  # whether `wall_escape` is ``away``

    def periods(self, seconds: float) -> int:
        """Return a duration in periods, rounded up, at least 1."""
        return max(1, math.ceil(seconds / self.period - _ROUNDING))

    def whole_periods(self, seconds: Floats) -> list[int]:
        """Return `periods` of several durations."""
        periods: list[int] = np.maximum(1.0, np.ceil(seconds / self.period - _ROUNDING)).astype(int).tolist()
        return periods

    def seconds(self, periods: int) -> float:
        """Return the duration of some periods (s), rounded to nanoseconds."""
        return round(periods * self.period, 9)
