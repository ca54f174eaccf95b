"""Starting places of robots: uniformly at random, without overlap (specification, section 3.1).

Each robot draws random places and takes the first free one. If none is free, it takes the place with the most
room in its last batch; at the end, overlaps are relaxed (`kswarms.model.kernel.relaxation`).
"""

import math
from typing import Final

import numpy as np
from numpy.random import Generator
from scipy.spatial.distance import pdist

from kswarms.agents.common.arrays import Floats
from kswarms.agents.common.errors import InputError
from kswarms.agents.streams import Purpose, stream
from kswarms.model.kernel.arrays import make_pairs, make_work
from kswarms.model.kernel.relaxation import TOLERANCE, relax

_FEW: Final = (8, 56)
"""Numbers of places that are drawn first and tested one by one, which is fastest if many places are free."""
_BATCHES: Final = (208, 4096, 4096)
"""Sizes of the batches of places that are tested together afterwards. The total decides places in a crowd."""


def start_poses(
    n: int, seed: int, half: float, radius: float, clearance: float, wall_clearance: float
) -> tuple[Floats, Floats]:
    """Draw positions (m), shape (n, 2), and headings (rad), shape (n,), from the streams of the robots.

    `half` is half the side of the arena; the clearances are the minimum gaps between bodies and to walls (m).
    """
    positions: list[tuple[float, float]] = []
    headings = np.empty(n)
    limit = half - radius - wall_clearance
    min_squared = (2 * radius + clearance) ** 2
    crowded = False
    for robot in range(n):
        place, is_free = _draw_place(stream(seed, robot, Purpose.POSITION), limit, positions, min_squared)
        positions.append(place)
        crowded |= not is_free
        headings[robot] = stream(seed, robot, Purpose.HEADING).uniform(-math.pi, math.pi)
    places = np.array(positions)
    if crowded:
        _separate(places, limit, radius + clearance / 2)
        if pdist(places).min() < 2 * radius + clearance:
            raise InputError("n", n, f"robots of radius {radius} m do not fit in a square of {2 * half} m")
    return places, headings


def _draw_place(
    rng: Generator, limit: float, taken: list[tuple[float, float]], min_squared: float
) -> tuple[tuple[float, float], bool]:
    """Return the first free place and True, or the place with most room in the last batch and False.

    A place is free if its squared distance from all taken places is at least `min_squared` (m²).
    """
    for few in _FEW:
        for x, y in rng.uniform(-limit, limit, size=(few, 2)).tolist():
            for other_x, other_y in taken:
                dx, dy = x - other_x, y - other_y
                if dx * dx + dy * dy < min_squared:
                    break
            else:
                return (x, y), True
    others = np.array(taken)
    for batch in _BATCHES:
        places = rng.uniform(-limit, limit, size=(batch, 2))
        dx, dy = (np.subtract.outer(places[:, axis], others[:, axis]) for axis in (0, 1))
        room = (dx * dx + dy * dy).min(axis=1)
        free = np.flatnonzero(room >= min_squared)
        if len(free) > 0:
            return tuple(places[free[0]].tolist()), True
    return tuple(places[room.argmax()].tolist()), False


def _separate(positions: Floats, limit: float, reach: float) -> None:
    """Move places within ± `limit` until their distances are at least twice `reach` (m)."""
    n = len(positions)
    pairs = make_pairs(n * (n - 1) // 2)
    pairs.first[:], pairs.second[:] = np.triu_indices(n, 1)
    reach += TOLERANCE
    x, y = positions.T.copy()
    relax(x, y, reach, limit + reach, make_work(n), pairs, len(pairs.first))
    positions[:, 0], positions[:, 1] = x, y
