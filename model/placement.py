"""Where robots start: uniformly at random, without overlap (specification, section 3.1).

Each robot takes the first free place that it draws. In a crowd where it draws none, it takes the roomiest of
the places drawn last, and in the end all are parted as wedged bodies are.
"""

import math
from typing import Final

import numpy as np
from scipy.spatial.distance import pdist

from kswarms.agents.common.arrays import Floats
from kswarms.agents.common.errors import InputError
from kswarms.agents.streams import Purpose, stream
from kswarms.model.kernel.arrays import PAIR, WORK
from kswarms.model.kernel.relaxation import TOLERANCE, relax

_BATCHES: Final = (16, 256, 4096, 4096)
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
    crowded = False
    for robot in range(n):
        draws = stream(seed, robot, Purpose.POSITION)
        for batch in _BATCHES:
            places = draws.uniform(-limit, limit, size=(batch, 2))
            squares = ((places[:, None, :] - positions[None, :robot, :]) ** 2).sum(axis=2)
            room = squares.min(axis=1, initial=np.inf)
            free = np.flatnonzero(room >= apart)
            if len(free) > 0:
                positions[robot] = places[free[0]]
                break
        else:
            positions[robot] = places[room.argmax()]
            crowded = True
        headings[robot] = stream(seed, robot, Purpose.HEADING).uniform(-math.pi, math.pi)
    if crowded:
        _part(positions, limit, radius + clearance / 2)
        if _nearest(positions) < 2 * radius + clearance:
            raise InputError("n", n, f"robots of radius {radius} m find no place in a square of {2 * half} m")
    return positions, headings


def _part(positions: Floats, limit: float, reach: float) -> None:
    """Move places that are nearer to each other than twice `reach` apart, within ± `limit` (m)."""
    n = len(positions)
    pairs = np.zeros(n * (n - 1) // 2, dtype=PAIR)
    pairs["first"], pairs["second"] = np.triu_indices(n, 1)
    reach += TOLERANCE
    relax(positions, reach, limit + reach, np.zeros(n, dtype=WORK), pairs, len(pairs))


def _nearest(positions: Floats) -> float:
    """Return the least distance between two places (m)."""
    return float(pdist(positions).min())
