"""Constants of the robots' controller."""

import math
from typing import NamedTuple


class Habits(NamedTuple):
    """The constants of the controller; lengths in metres, angles in radians.

    Attributes
    ----------
    period : float
        Control period (s).
    turn_step : float
        Most that a robot can turn in a period.
    leg_mean : float
        Mean wander leg (s).
    wander_turn : float
        The turn between two legs is uniform within ± this angle.
    half : float
        Half the side of the arena.
    wall_reach, wall_half_angle : float
        As in `kswarms.agents.robot.sensing.walls_met`.
    radius, active_range : float
        As in `kswarms.agents.robot.sensing.read_robots`.
    escape_away : bool
        Whether a new heading only has to point away from the walls met.
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
        """Return the whole periods that a duration takes, rounded up, at least one."""
        # A billionth of a period forgives what a quotient like 0.3 / 0.1 is too large.
        return max(1, math.ceil(seconds / self.period - 1e-9))

    def seconds(self, periods: int) -> float:
        """Return how long some periods take (s), without the dust of binary fractions."""
        return round(periods * self.period, 9)
