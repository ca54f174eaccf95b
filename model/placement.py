"""Where robots start: uniformly at random, without overlap (specification, section 3.1)."""

import math
from typing import Final

import numpy as np

from agents.errors import InputError
from agents.fleet import Floats
from agents.streams import Purpose, stream

_BATCHES: Final = (16, 256, *(4096,) * 500)
"""Places tried at a time: few at first, many where room is scarce."""


def start_poses(
    n: int, seed: int, half: float, radius: float, clearance: float, wall_clearance: float
) -> tuple[Floats, Floats]:
    """Draw positions and headings, robot by robot from its own streams.

    The same for every game with this seed, number of robots, arena and body, whatever the policies.

    Parameters
    ----------
    n, seed : int
        Robots, and the seed of the run.
    half, radius : float
        Half the side of the arena; of a body (m).
    clearance, wall_clearance : float
        Least gap between two bodies, and to a wall (m).

    Returns
    -------
    positions : ndarray of float64, shape (n, 2)
        (m)
    headings : ndarray of float64, shape (n,)
        (rad)

    Raises
    ------
    InputError
        If no free place is found for a robot.
    """
    positions = np.empty((n, 2))
    headings = np.empty(n)
    limit = half - radius - wall_clearance
    apart = (2 * radius + clearance) ** 2
    for robot in range(n):
        draws = stream(seed, robot, Purpose.POSITION)
        for batch in _BATCHES:
            places = draws.uniform(-limit, limit, size=(batch, 2))
            squares = ((places[:, None, :] - positions[None, :robot, :]) ** 2).sum(axis=2)
            free = np.flatnonzero((squares >= apart).all(axis=1))
            if len(free) > 0:
                positions[robot] = places[free[0]]
                break
        else:
            raise InputError("n", n, f"robots of radius {radius} m find no place in a square of {2 * half} m")
        headings[robot] = stream(seed, robot, Purpose.HEADING).uniform(-math.pi, math.pi)
    return positions, headings
