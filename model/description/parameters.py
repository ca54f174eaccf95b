"""Parameters of the world (specification, section 2.7). SI units."""

import math
from typing import Literal

from pydantic import Field

from kswarms.agents.actions import AWAY, TOWARDS, Action
from kswarms.agents.common.descriptions import FrozenModel
from kswarms.agents.common.limits import (
    FASTEST,
    LONGEST_DISTANCE,
    LONGEST_PERIOD,
    LONGEST_TIME,
    MAX_FRICTION,
    SHORTEST_DISTANCE,
    SHORTEST_TIME,
    SLOWEST,
    SMALLEST_ANGLE,
)
from kswarms.agents.learning.selection_rules import GAMMA


class Parameters(FrozenModel):
    """Free parameters of the world: fixed neither by the thesis nor by the public simulator.

    The defaults are fitted to Table 6.1. Distances are for the body in the simulator's scale; sensing
    distances of another body are scaled by its `kswarms.agents.body.Body.sensing_scale`.

    Attributes
    ----------
    period : float
        Control period (s); every duration is rounded up to whole periods.
    conflict_distance : float
        Maximum gap between the surfaces of two robots in conflict (m).
    front_half_angle : float
        A robot is ahead if its bearing is within ± this angle (rad).
    flight_duration, fight_duration : float
        Driving time of the two standard actions after their turn (s).
    turning_rate : float
        Angular speed of every turn in place (rad/s).
    flight_range : float
        Cut-off of the free distances among which a flight looks for the most vacant direction (m).
    active_range : float
        A sensor is active if its free distance is at most this, n'_i of Eq. 5.4 (m).
    leg_mean : float
        Mean of the exponential duration of a straight leg while wandering (s).
    wander_turn : float
        The turn between two legs is uniform within ± this angle (rad).
    wall_distance : float
        Gap to a wall ahead at which a wandering robot turns away (m).
    wall_half_angle : float
        Angle of two more rays, on either side of the heading, that detect walls (rad); 0 for none.
    wall_escape : {'clear', 'away'}
        The new heading is uniform among headings without a wall within the wall distance, or among
        headings that point away from the detected walls.
    station_radius, base_radius : float
        A robot is at a station, or at its base, if its centre is within this radius (m).
    base_range : float
        Maximum distance, centre to centre, at which a robot sees its base (m).
    friction : float
        Coulomb coefficient of the contacts.
    push_share : float
        Fraction of their common momentum that two robots in contact keep while their drives oppose each
        other, 0 to 1. With 0 a standing robot is never pushed.
    clearance, wall_clearance : float
        Minimum gaps between bodies, and to the walls, at the start (m).
    preempt : bool
        Whether another robot ahead interrupts an action.
    gamma : float
        γ, the weight of exploration in UCB (Eq. 4.16), for rules without their own.
    """

    period: float = Field(0.1, ge=SHORTEST_TIME, le=LONGEST_PERIOD)
    conflict_distance: float = Field(0.1718, ge=SHORTEST_DISTANCE, le=LONGEST_DISTANCE)
    front_half_angle: float = Field(math.radians(62.5), ge=SMALLEST_ANGLE, le=math.pi)
    flight_duration: float = Field(1.619, ge=SHORTEST_TIME, le=LONGEST_TIME)
    fight_duration: float = Field(1.0, ge=SHORTEST_TIME, le=LONGEST_TIME)
    turning_rate: float = Field(2.96, ge=SLOWEST, le=FASTEST)
    flight_range: float = Field(0.46, ge=SHORTEST_DISTANCE, le=LONGEST_DISTANCE)
    active_range: float = Field(0.2467, ge=SHORTEST_DISTANCE, le=LONGEST_DISTANCE)
    leg_mean: float = Field(6.7, ge=SHORTEST_TIME, le=LONGEST_TIME)
    wander_turn: float = Field(math.radians(86), ge=SMALLEST_ANGLE, le=math.pi)
    wall_distance: float = Field(0.06, ge=SHORTEST_DISTANCE, le=LONGEST_DISTANCE)
    wall_half_angle: float = Field(0.0, ge=0, lt=math.pi / 2)
    wall_escape: Literal["clear", "away"] = "clear"
    station_radius: float = Field(0.16, ge=SHORTEST_DISTANCE, le=LONGEST_DISTANCE)
    base_radius: float = Field(0.17, ge=SHORTEST_DISTANCE, le=LONGEST_DISTANCE)
    base_range: float = Field(0.82, ge=SHORTEST_DISTANCE, le=LONGEST_DISTANCE)
    friction: float = Field(0.1596, ge=0, le=MAX_FRICTION)
    push_share: float = Field(0.0, ge=0, le=1)
    clearance: float = Field(0.01, ge=0, le=LONGEST_DISTANCE)
    wall_clearance: float = Field(0.005, ge=0, le=LONGEST_DISTANCE)
    preempt: bool = False
    gamma: float = Field(GAMMA, ge=0)

    def actions(self) -> tuple[Action, Action]:
        """Return the two standard actions: flight and fight."""
        return (
            Action(name="flight", direction=AWAY, duration=self.flight_duration),
            Action(name="fight", direction=TOWARDS, duration=self.fight_duration),
        )
