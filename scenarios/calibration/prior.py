"""The prior of a calibration: the free parameters (specification, section 2.7) and their ranges."""

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

from kswarms.agents.common.arrays import Floats
from kswarms.model.description.parameters import Parameters
from kswarms.model.description.presets import PRESETS


class Range(NamedTuple):
    """Range of a parameter: uniform in the logarithm, or on a linear scale in steps of `step`."""

    low: float
    high: float
    step: float = 0.0
    """0 for a continuous parameter on a logarithmic scale."""


PRIOR: Final[dict[str, Range]] = {
    "conflict_distance": Range(0.06, 0.24),
    "front_half_angle": Range(math.radians(40), math.radians(90)),
    "flight_duration": Range(0.8, 1.2, step=0.1),
    "fight_duration": Range(0.8, 1.2, step=0.1),
    "turning_rate": Range(2.0, 6.0),
    "flight_range": Range(0.2, 0.667),
    "active_range": Range(0.15, 0.5),
    "leg_mean": Range(1.5, 10.0),
    "wander_turn": Range(math.radians(45), math.pi),
    "wall_distance": Range(0.03, 0.15),
    "station_radius": Range(0.08, 0.2),
    "base_radius": Range(0.08, 0.2),
    "base_range": Range(0.4, 1.2),
    "friction": Range(0.15, 1.5),
    "push_share": Range(0.0, 1.0, step=0.01),
    "gamma": Range(0.002, 0.2),
}
"""The free parameters by name. A range contains everything that is plausible for a Krembot.

Durations are whole control periods. A base must not touch the wall. The upper end of `flight_range` is the
range of the robot's sensors.
"""


def values_at(free: Sequence[str], position: Floats) -> dict[str, float]:
    """Return the parameters at a position in the unit cube, shape (len(free),), with four digits."""
    values = {}
    for name, part in zip(free, position, strict=True):
        low, high, step = PRIOR[name]
        if step:
            steps = round((high - low) / step) + 1
            value = low + step * min(int(part * steps), steps - 1)
        else:
            value = low * (high / low) ** float(part)
        values[name] = min(float(f"{value:.4g}"), high)  # rounding may exceed the range
    return values


def to_world(free: Sequence[str], position: Floats) -> Parameters:
    """Return the world at a position. The other parameters have their defaults."""
    return PRESETS["fitted"].replace(**values_at(free, position))
