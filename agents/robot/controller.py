"""Constants of the controller."""

import math
from typing import NamedTuple


class Controller(NamedTuple):
    """Constants of a robot's controller; lengths in metres, angles in radians.

    Attributes
    ----------
    period : float
        Control period (s).
    turn_step : float
        Maximum turn in a period.
    leg_mean : float
        Mean duration of a wander leg (s).
    wander_turn : float
        Turns between legs are uniform within ± this angle.
    half : float
        Half the side of the arena.
    wall_reach, wall_half_angle : float
        As in `walls_met`.
    radius, active_range : float
        As in `sensed_robots`.
    escape_away : bool
        Whether a turn at walls only needs to point away from the walls met.
    """

    period: float
    turn_step: float
    leg_mean: float
    wander_turn: float
    half: float
    wall_reach: float
    wall_half_angle: float
    radius: float
    active_range: float
    escape_away: bool

    def periods(self, seconds: float) -> int:
        """Return a duration in periods, rounded up, at least 1."""
        # Subtract 1e-9 to absorb rounding errors of a quotient such as 0.3 / 0.1.
        return max(1, math.ceil(seconds / self.period - 1e-9))

    def seconds(self, periods: int) -> float:
        """Return the duration of some periods (s), rounded to nanoseconds."""
        return round(periods * self.period, 9)
