"""Sensing: the ring of eight proximity sensors and the walls (sections 2.2, 2.3).

Compiled functions of numbers and arrays. The arena is the square |x|, |y| ≤ `half`; lengths are in metres,
angles in radians.
"""

import math
from typing import Final

import numpy as np

from kswarms.agents.body import SENSORS
from kswarms.agents.common.arrays import Floats, Integers, Rows
from kswarms.agents.common.jit import compiled, compiled_inner

SECTOR: Final = 2.0 * math.pi / SENSORS  # angle covered by one sensor (rad)
# Arrays: a compiled function reads a tuple with a jump for each index.
_COSINES: Final = np.array([math.cos(sensor * SECTOR) for sensor in range(SENSORS)])
_SINES: Final = np.array([math.sin(sensor * SECTOR) for sensor in range(SENSORS)])
_HALF_COSINE: Final = math.cos(SECTOR / 2.0)
_HALF_SINE: Final = math.sin(SECTOR / 2.0)


@compiled
def wrap(angle: float) -> float:
    """Return the same direction in (−π, π]."""
    return angle - 2.0 * math.pi * math.ceil((angle - math.pi) / (2.0 * math.pi))


ANGLES_OF: Final = [
    tuple(wrap(sensor * SECTOR) for sensor in range(SENSORS) if bits >> sensor & 1)
    for bits in range(2**SENSORS)
]
"""Angles of the sensors whose bits are set, from the heading (rad)."""


@compiled
def wall_ray(x: float, y: float, dx: float, dy: float, half: float) -> float:
    """Return the distance from (x, y) to the walls along the unit vector (dx, dy)."""
    # The wall on the side of the ray; without branches, half of whose predictions would fail.
    gap_x = half - math.copysign(x, x * dx)
    gap_y = half - math.copysign(y, y * dy)
    return min(gap_x / abs(dx), gap_y / abs(dy))


@compiled
def walls_met(x: float, y: float, heading: float, half: float, reach: float, half_angle: float) -> int:
    """Return the walls ahead of a robot at (x, y): a sum of 1, 2, 4, 8 for the walls +x, −x, +y, −y.

    A wall counts if the robot heads towards it and a ray from the centre meets it within `reach`. There is
    one ray ahead, and two more at ± `half_angle` if that is not 0.
    """
    met = 0
    if half - max(abs(x), abs(y)) >= reach:
        return met
    for wall in range(4):
        distance = half - (x, -x, y, -y)[wall]
        if distance >= reach:  # no ray is shorter; cosines take time
            continue
        ahead = math.cos(heading - _wall_direction(wall))
        if ahead <= 0.0:
            continue
        nearest = distance / ahead
        if half_angle > 0.0:
            for side in (-half_angle, half_angle):
                ahead = math.cos(heading + side - _wall_direction(wall))
                if ahead > 0.0:
                    nearest = min(nearest, distance / ahead)
        if nearest < reach:
            met += 1 << wall
    return met


@compiled
def heads_for(heading: float, walls: int) -> bool:
    """Return whether `heading` has a component towards one of `walls` (a sum as in `walls_met`)."""
    for wall in range(4):
        if walls >> wall & 1 and math.cos(heading - _wall_direction(wall)) > 0.0:
            return True
    return False


@compiled
def turn_from_walls(
    headings: Floats,
    used: int,
    x: float,
    y: float,
    heading: float,
    half: float,
    reach: float,
    half_angle: float,
    away: bool,
) -> tuple[int, float]:
    """Find the first of random headings at which a robot meets no wall.

    Parameters
    ----------
    headings : ndarray of float64, shape (k,)
        Random headings (rad), of which the first `used` were used before.
    x, y, heading, half, reach, half_angle : float
        As in `walls_met`.
    away : bool
        Only the walls that the robot meets now count, and it must not head towards them at all.

    Returns
    -------
    used : int
        The number of headings used.
    angle : float
        The turn to the heading (rad), NaN if there is none.
    """
    met = walls_met(x, y, heading, half, reach, half_angle)
    for k in range(used, len(headings)):
        target = headings[k]
        if not (heads_for(target, met) if away else walls_met(x, y, target, half, reach, half_angle) != 0):
            return k + 1, wrap(target - heading)
    return len(headings), math.nan


NO_HEADINGS: Final = np.empty(0)
"""Argument of `turn_from_walls` before random headings have been drawn."""


@compiled_inner
def _wall_direction(wall: int) -> float:
    return (0.0, math.pi, 0.5 * math.pi, -0.5 * math.pi)[wall]


@compiled
def sense(
    robot: int,
    forward_x: float,
    forward_y: float,
    x: Floats,
    y: Floats,
    others: Rows,
    n_others: int,
    radius: float,
    half: float,
    limit: float,
    free: Floats,
) -> None:
    """Compute the free distance of each of the eight sensors of a robot.

    This is the distance from the robot's surface to the nearest obstacle: the wall along the middle of the
    sensor, or a robot whose centre is in its sector.

    Parameters
    ----------
    forward_x, forward_y : float
        Unit vector of the heading of `robot`.
    x, y : ndarray of float64, shape (n,)
        Centres of all robots.
    others : ndarray of uint32, shape (≥ n_others,)
        Robots that may be in range; `robot` itself is skipped.
    n_others : int
        Number of valid entries of `others`.
    radius, half, limit : float
        Radius of every body, half the side of the arena; robots with a gap larger than `limit` are skipped.
    free : ndarray of float64, shape (8,)
        Output: the distances, starting with the sensor ahead, counter-clockwise.
    """
    own_x = x[robot]
    own_y = y[robot]
    for sensor in range(SENSORS):
        free[sensor] = math.inf  # squared distance of the nearest robot
    reach = 2.0 * radius + limit
    for k in range(n_others):
        other = others[k]
        dx = x[other] - own_x
        dy = y[other] - own_y
        squared = dx * dx + dy * dy
        if squared <= reach * reach and other != robot:
            sensor = _sector(dx * forward_x + dy * forward_y, dy * forward_x - dx * forward_y)
            free[sensor] = min(free[sensor], squared)
    for sensor in range(SENSORS):
        # A rotation of the heading is cheaper than a cosine and a sine for each sensor.
        dx = forward_x * _COSINES[sensor] - forward_y * _SINES[sensor]
        dy = forward_x * _SINES[sensor] + forward_y * _COSINES[sensor]
        wall = wall_ray(own_x, own_y, dx, dy, half) - radius
        free[sensor] = min(wall, math.sqrt(free[sensor]) - 2.0 * radius)


@compiled_inner
def _sector(ahead: float, aside: float) -> int:
    """Return the sensor whose sector contains a direction.

    Relative to the right edge of the sensor ahead, the sectors are octants. Comparisons without branches are
    much faster than an arctangent, and than branches, half of whose predictions would fail.
    """
    x = ahead * _HALF_COSINE - aside * _HALF_SINE
    y = aside * _HALF_COSINE + ahead * _HALF_SINE
    below = int(y < 0.0) | (int(y == 0.0) & int(x <= 0.0))
    odd = (int(x <= 0.0) & ~below) | (int(x >= 0.0) & below)  # quadrants 1 and 3
    steep = (int(abs(y) >= abs(x)) & ~odd) | (int(abs(x) >= abs(y)) & odd)
    return 4 * below + 2 * odd + steep


@compiled
def read_sensors(
    robot: int,
    met: int,
    forward_x: float,
    forward_y: float,
    x: Floats,
    y: Floats,
    radius: float,
    half: float,
    nearest: Floats,
    read: Integers,
) -> None:
    """Find the robot that each sensor reads at the start of a conflict with `met`.

    A sensor is active if the nearest robot or wall in its sector is within the active range, from surface to
    surface; it reads this robot or wall. The sensor towards the opponent always reads the opponent. The other
    parameters are those of `sense`.

    Parameters
    ----------
    nearest : ndarray of float64, shape (8,)
        The active range in all entries; lowered to the distance that each sensor reads.
    read : ndarray of int64, shape (8,)
        −1 in all entries; set to the robot that each sensor reads.
    """
    own_x = x[robot]
    own_y = y[robot]
    for sensor in range(SENSORS):
        dx = forward_x * _COSINES[sensor] - forward_y * _SINES[sensor]
        dy = forward_x * _SINES[sensor] + forward_y * _COSINES[sensor]
        nearest[sensor] = min(nearest[sensor], wall_ray(own_x, own_y, dx, dy, half) - radius)
    for other in range(len(x)):
        if other == robot:
            continue
        dx = x[other] - own_x
        dy = y[other] - own_y
        sensor = _sector(dx * forward_x + dy * forward_y, dy * forward_x - dx * forward_y)
        gap = -math.inf if other == met else math.sqrt(dx * dx + dy * dy) - 2.0 * radius
        if gap <= nearest[sensor]:
            read[sensor] = other
            nearest[sensor] = gap
