"""What a robot senses: the ring of eight proximity sensors and the walls (sections 2.2, 2.3).

Compiled functions of plain numbers and arrays. The arena is the square |x|, |y| ≤ `half`;
lengths in metres, angles in radians.
"""

import math
from typing import Final

import numpy as np

from kswarms.agents.body import SENSORS
from kswarms.agents.common.arrays import Floats, Integers
from kswarms.agents.common.jit import compiled

SECTOR: Final = 2.0 * math.pi / SENSORS
"""Angle covered by one sensor (rad)."""
_COSINES: Final = tuple(math.cos(sensor * SECTOR) for sensor in range(SENSORS))
_SINES: Final = tuple(math.sin(sensor * SECTOR) for sensor in range(SENSORS))
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
    """Return the distance from (x, y) along the unit vector (dx, dy) to the wall it meets."""
    along_x = (half - x) / dx if dx > 0.0 else ((-half - x) / dx if dx < 0.0 else math.inf)
    along_y = (half - y) / dy if dy > 0.0 else ((-half - y) / dy if dy < 0.0 else math.inf)
    return min(along_x, along_y)


@compiled
def walls_met(x: float, y: float, heading: float, half: float, reach: float, half_angle: float) -> int:
    """Return which walls the robot is about to run into.

    A wall counts if the robot heads towards it and one of the rays ahead (one, or three where
    `half_angle` is not 0) meets it nearer than `reach`.

    Parameters
    ----------
    x, y : float
        Centre of the robot.
    heading : float
        Its direction.
    half : float
        Half the side of the arena.
    reach : float
        Distance from the centre within which a wall counts.
    half_angle : float
        Angle between the ray ahead and those at its sides, 0 for the ray ahead alone.

    Returns
    -------
    int
        Sum of 1 (x = +half), 2 (x = −half), 4 (y = +half), 8 (y = −half).
    """
    met = 0
    if half - max(abs(x), abs(y)) >= reach:
        return met
    for wall in range(4):
        ahead = math.cos(heading - _wall_direction(wall))
        if ahead <= 0.0:
            continue
        distance = half - (x, -x, y, -y)[wall]
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
    """Return whether `heading` has a component towards any of `walls` (sum as in `walls_met`)."""
    for wall in range(4):
        if walls >> wall & 1 and math.cos(heading - _wall_direction(wall)) > 0.0:
            return True
    return False


@compiled
def _wall_direction(wall: int) -> float:
    return (0.0, math.pi, 0.5 * math.pi, -0.5 * math.pi)[wall]


@compiled
def sense(
    robot: int,
    forward_x: float,
    forward_y: float,
    positions: Floats,
    others: Integers,
    n_others: int,
    radius: float,
    half: float,
    limit: float,
    free: Floats,
) -> None:
    """Measure the free distance of each of the eight sensors of a robot.

    The smaller of the wall along the middle of the sensor and the nearest surface of another robot
    whose centre lies in its sector; both from the own surface.

    Parameters
    ----------
    robot : int
        The robot that senses.
    forward_x, forward_y : float
        Unit vector of its heading.
    positions : ndarray of float64, shape (n, 2)
        Of all robots.
    others : ndarray of int64, shape (≥ n_others,)
        Robots that may be in range; `robot` itself is passed over.
    n_others : int
        How many of them count.
    radius : float
        Radius of every body.
    half : float
        Half the side of the arena.
    limit : float
        Robots with a greater gap are passed over.
    free : ndarray of float64, shape (8,)
        Receives the distances, the sensor ahead first, then counter-clockwise.
    """
    x = positions[robot, 0]
    y = positions[robot, 1]
    for sensor in range(SENSORS):
        # A rotation of the heading is cheaper than a cosine and a sine for each sensor.
        dx = forward_x * _COSINES[sensor] - forward_y * _SINES[sensor]
        dy = forward_x * _SINES[sensor] + forward_y * _COSINES[sensor]
        free[sensor] = wall_ray(x, y, dx, dy, half) - radius
    reach = 2.0 * radius + limit
    for k in range(n_others):
        other = others[k]
        dx = positions[other, 0] - x
        dy = positions[other, 1] - y
        squared = dx * dx + dy * dy
        if other == robot or squared > reach * reach:
            continue
        sensor = _sector(dx * forward_x + dy * forward_y, dy * forward_x - dx * forward_y)
        free[sensor] = min(free[sensor], math.sqrt(squared) - 2.0 * radius)


@compiled
def _sector(ahead: float, aside: float) -> int:
    """Return the sensor in whose sector a direction lies.

    Seen from the right edge of the sensor ahead, the sectors are the eight octants: comparisons tell them
    apart in a fraction of the time of an arctangent.
    """
    x = ahead * _HALF_COSINE - aside * _HALF_SINE
    y = aside * _HALF_COSINE + ahead * _HALF_SINE
    if y > 0.0 or (y == 0.0 and x > 0.0):
        if x > 0.0:
            return 0 if y < x else 1
        return 2 if y > -x else 3
    if x < 0.0:
        return 4 if y > x else 5
    return 6 if -y > x else 7


def read_robots(
    robot: int,
    met: int,
    forward_x: float,
    forward_y: float,
    positions: Floats,
    radius: float,
    half: float,
    active_range: float,
) -> tuple[int, ...]:
    """Tell which robot each of the eight sensors reads at the start of a conflict.

    An active sensor reads the nearest thing in its sector, as in `sense`: one robot, or a wall. The robot
    met is what the sensor towards it reads in any case: it is the one that was noticed.

    Parameters
    ----------
    robot, met : int
        The robot that senses, and the one that it meets.
    forward_x, forward_y : float
        Unit vector of its heading.
    positions : ndarray of float64, shape (n, 2)
        Of all robots.
    radius : float
        Radius of every body.
    half : float
        Half the side of the arena.
    active_range : float
        A sensor is active if what is nearest in its sector is not farther, from the own surface.

    Returns
    -------
    tuple of int, length 8
        Robots, −1 where a sensor reads none; the sensor ahead first, then counter-clockwise.
    """
    nearest = np.full(SENSORS, active_range)
    read = np.full(SENSORS, -1)
    _read(robot, met, forward_x, forward_y, positions, radius, half, nearest, read)
    return tuple(read.tolist())


@compiled
def _read(
    robot: int,
    met: int,
    forward_x: float,
    forward_y: float,
    positions: Floats,
    radius: float,
    half: float,
    nearest: Floats,
    read: Integers,
) -> None:
    """Write what is read, and how near it is where it is nearer than `nearest` was."""
    x = positions[robot, 0]
    y = positions[robot, 1]
    for sensor in range(SENSORS):
        dx = forward_x * _COSINES[sensor] - forward_y * _SINES[sensor]
        dy = forward_x * _SINES[sensor] + forward_y * _COSINES[sensor]
        nearest[sensor] = min(nearest[sensor], wall_ray(x, y, dx, dy, half) - radius)
    for other in range(len(positions)):
        if other == robot:
            continue
        dx = positions[other, 0] - x
        dy = positions[other, 1] - y
        sensor = _sector(dx * forward_x + dy * forward_y, dy * forward_x - dx * forward_y)
        gap = -math.inf if other == met else math.sqrt(dx * dx + dy * dy) - 2.0 * radius
        if gap <= nearest[sensor]:
            read[sensor] = other
            nearest[sensor] = gap
