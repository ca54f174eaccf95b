"""Parameters of the world (specification, section 2.7) and their named presets. SI units."""

import math
from typing import Final, Literal

from pydantic import Field

from kswarms.agents.actions import AWAY, LONGEST, TOWARDS, Action
from kswarms.agents.common.descriptions import Checked
from kswarms.agents.common.errors import InputError

FARTHEST: Final = 10_000.0
"""No sense reaches farther, nor are robots put farther apart (m): as far as the side of the largest arena."""
SHORTEST_PERIOD: Final = 1e-6
"""Less (s) would only make more periods of everything, until they cannot be counted."""
SLOWEST_TURN: Final = 1e-9
"""Turning more slowly (rad/s), a robot would take a century to turn about."""


class Parameters(Checked):
    """What neither the thesis nor the public simulator fixes, with the defaults fitted to Table 6.1.

    Distances are for the body in the simulator's scale; the sensing distances of another body are
    scaled by its `kswarms.agents.robot.body.Body.sensing_scale`.

    Attributes
    ----------
    period : float
        Control period (s); every duration rounds up to whole periods.
    conflict_distance : float
        Gap between two surfaces within which a robot ahead starts a conflict (m).
    front_half_angle : float
        Bearings within ± this angle are ahead (rad).
    flight_duration, fight_duration : float
        How long the two standard actions drive, after their turn (s).
    turning_rate : float
        Of every turn in place (rad/s).
    flight_range : float
        Free distances are cut off there when a flight looks for the most vacant direction (m).
    active_range : float
        A sensor with something nearer than this counts as active, n'_i of Eq. 5.4 (m).
    leg_mean : float
        Mean of the exponential duration of a straight leg of the wandering (s).
    wander_turn : float
        The turn between two legs is uniform within ± this angle (rad).
    wall_distance : float
        Gap to a wall ahead within which a wandering robot turns away (m).
    wall_half_angle : float
        0: a wall is looked for straight ahead; else also along rays at ± this angle (rad).
    wall_escape : {'clear', 'away'}
        The new heading is uniform among those that meet no wall within the wall distance, or among
        those that point away from the walls met.
    station_radius, base_radius : float
        A robot whose centre is nearer to the middle is at the station, at the base (m).
    base_range : float
        The own base is seen within this distance, centre to centre (m).
    friction : float
        Coulomb coefficient of the contacts.
    push_share : float
        Share of a blocked motion by which the standing body is shoved, 0 to 1.
    clearance, wall_clearance : float
        Least gaps between bodies, and to the walls, at the start (m).
    preempt : bool
        Whether another robot ahead interrupts an action.
    """

    period: float = Field(0.1, ge=SHORTEST_PERIOD, le=1)
    conflict_distance: float = Field(0.1718, gt=0, le=FARTHEST)
    front_half_angle: float = Field(math.radians(62.5), gt=0, le=math.pi)
    flight_duration: float = Field(1.619, gt=0, le=LONGEST)
    fight_duration: float = Field(1.0, gt=0, le=LONGEST)
    turning_rate: float = Field(2.96, ge=SLOWEST_TURN)
    flight_range: float = Field(0.46, gt=0, le=FARTHEST)
    active_range: float = Field(0.2467, gt=0, le=FARTHEST)
    leg_mean: float = Field(6.7, gt=0, le=LONGEST)
    wander_turn: float = Field(math.radians(86), gt=0, le=math.pi)
    wall_distance: float = Field(0.06, gt=0, le=FARTHEST)
    wall_half_angle: float = Field(0.0, ge=0, lt=math.pi / 2)
    wall_escape: Literal["clear", "away"] = "clear"
    station_radius: float = Field(0.16, gt=0)
    base_radius: float = Field(0.17, gt=0)
    base_range: float = Field(0.82, gt=0, le=FARTHEST)
    friction: float = Field(0.1596, ge=0)
    push_share: float = Field(0.0, ge=0, le=1)
    clearance: float = Field(0.01, ge=0, le=FARTHEST)
    wall_clearance: float = Field(0.005, ge=0, le=FARTHEST)
    preempt: bool = False

    def actions(self) -> tuple[Action, Action]:
        """Return the two standard actions: flight and fight."""
        return (
            Action(name="flight", direction=AWAY, duration=self.flight_duration),
            Action(name="fight", direction=TOWARDS, duration=self.fight_duration),
        )


PRESETS: Final = {
    "fitted": Parameters(),
    # The controller that the ARGoS measurements were made with; friction and push share are fitted to them.
    "argos": Parameters(
        conflict_distance=0.10,
        front_half_angle=math.radians(67.5),
        flight_duration=1.0,
        fight_duration=1.0,
        turning_rate=3.927,
        flight_range=0.667,
        active_range=0.30,
        leg_mean=3.0,
        wander_turn=math.radians(120),
        wall_distance=0.10,
        wall_half_angle=math.pi / 4,
        wall_escape="away",
        station_radius=0.12,
        base_radius=0.12,
        base_range=0.667,
        friction=0.45,
        push_share=0.0,
    ),
}


def parse_parameters(text: str) -> Parameters:
    """Read the name of a preset, followed by single parameters that differ from it.

    Parameters
    ----------
    text : str
        For example ``"argos"``, or ``"fitted, friction=0.3, preempt=true"``.

    Raises
    ------
    InputError
        If there is no such preset or parameter, or the value is not allowed.
    """
    preset, *changes = (part.strip() for part in text.split(","))
    if preset not in PRESETS:
        raise InputError("parameters", preset, f"must begin with one of {', '.join(PRESETS)}")
    pairs = [change.partition("=") for change in changes]
    for name, sign, _ in pairs:
        if not sign:
            raise InputError("parameters", name, "after the preset, must be name=value")
    values: dict[str, str] = {}
    for name, _, value in pairs:
        if values.setdefault(name.strip(), value.strip()) != value.strip():
            raise InputError(f"parameters.{name.strip()}", value.strip(), "must be given once")
    return PRESETS[preset].replace(**values)
