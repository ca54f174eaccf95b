"""The Krembot's body and senses, in its two scales (specification, section 2.2). SI units."""

from typing import Final

from pydantic import Field

from kswarms.agents.common.descriptions import Checked

SENSORS: Final = 8
"""Proximity sensors of a Krembot, one every 45°, the first looking ahead."""


class Body(Checked):
    """A robot's body.

    Attributes
    ----------
    name : str
        Name of the preset, or of a user-defined body.
    radius : float
        Radius of the body (m).
    sensor_range : float
        How far a proximity sensor sees, from the body's surface (m).
    top_speed : float
        Speed at a drive of 100 % (m/s).
    """

    name: str = "user-defined"
    radius: float = Field(ge=0.001, le=1000)
    sensor_range: float = Field(gt=0, le=10_000)
    top_speed: float = Field(gt=0, le=10_000)

    @property
    def sensing_scale(self) -> float:
        """Factor by which this body's sensing distances differ from the simulator scale's."""
        return self.radius / KREMBOT_SIM.radius


KREMBOT_SIM: Final = Body(name="krembot-sim", radius=0.085, sensor_range=0.667, top_speed=0.25)
KREMBOT: Final = Body(name="krembot", radius=0.0325, sensor_range=0.2551, top_speed=0.25)
ARGOS_FOOTBOT: Final = Body(name="argos-footbot", radius=0.085036758, sensor_range=0.667, top_speed=0.25)

BODIES: Final = {body.name: body for body in (KREMBOT_SIM, KREMBOT, ARGOS_FOOTBOT)}
