"""Bodies of robots (specification, section 2.2). SI units."""

from typing import Final

from pydantic import Field

from kswarms.agents.common.descriptions import FrozenModel, Line
from kswarms.agents.common.limits import (
    FASTEST,
    LARGEST_RADIUS,
    LONGEST_DISTANCE,
    LONGEST_NAME,
    SHORTEST_DISTANCE,
    SLOWEST,
    SMALLEST_RADIUS,
)

SENSORS: Final = 8  # proximity sensors, one every 45°, the first ahead


class Body(FrozenModel):
    """Body of a robot.

    Attributes
    ----------
    name : str
        Name of the preset, or of a user-defined body.
    radius : float
        Radius of the body (m).
    sensor_range : float
        Range of a proximity sensor, from the surface of the body (m).
    top_speed : float
        Speed at a drive of 1 (m/s).
    """

    name: Line = Field("user-defined", max_length=LONGEST_NAME)
    radius: float = Field(ge=SMALLEST_RADIUS, le=LARGEST_RADIUS)
    sensor_range: float = Field(ge=SHORTEST_DISTANCE, le=LONGEST_DISTANCE)
    top_speed: float = Field(ge=SLOWEST, le=FASTEST)

    @property
    def sensing_scale(self) -> float:
        """Ratio of this body's sensing distances to those of `KREMBOT_SIM`."""
        return self.radius / KREMBOT_SIM.radius


KREMBOT_SIM: Final = Body(name="krembot-sim", radius=0.085, sensor_range=0.667, top_speed=0.25)
KREMBOT: Final = Body(name="krembot", radius=0.0325, sensor_range=0.2551, top_speed=0.25)
ARGOS_FOOTBOT: Final = Body(name="argos-footbot", radius=0.085036758, sensor_range=0.667, top_speed=0.25)

BODIES: Final = {body.name: body for body in (KREMBOT_SIM, KREMBOT, ARGOS_FOOTBOT)}
