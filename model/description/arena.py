"""The arena: a square with supply stations and home bases (specification, section 2.1). SI units."""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from kswarms.agents.common.arrays import Floats
from kswarms.agents.common.errors import InputError
from kswarms.agents.streams import WORLD, Purpose, stream

LAYOUTS: Final = ("symmetric", "nearer-station", "random-stations")

# For the arena of 2 × 2 m; all else follows.
_SIDE: Final = 2.0
_BASE_X: Final = 0.80
_STATION_Y: Final = 0.66
_BASE_SPACING: Final = 0.36
"""Distance in y between bases on one side."""
_NEARER: Final = (0.96, 1.12)
"""Distances of the upper station from S1's and S2's base in the disadvantaged arena."""


@dataclass(frozen=True)
class Arena:
    """Where things are.

    Attributes
    ----------
    half : float
        Half the side of the square, whose middle is the origin (m).
    stations : ndarray of float64, shape (2, 2)
        Middles of the supply stations (m).
    bases : ndarray of float64, shape (K, 2)
        Middles of the home bases, S1 first (m).
    station_radius, base_radius : float
        (m)

    Raises
    ------
    InputError
        If two of them overlap, or one and a wall.
    """

    half: float
    stations: Floats
    bases: Floats
    station_radius: float
    base_radius: float

    def __post_init__(self) -> None:
        places = [(f"base {k + 1}", base, self.base_radius) for k, base in enumerate(self.bases)]
        places += [
            (f"station {k + 1}", station, self.station_radius) for k, station in enumerate(self.stations)
        ]
        for k, (name, middle, radius) in enumerate(places):
            if np.abs(middle).max() + radius > self.half:
                raise InputError(
                    name,
                    [round(float(c), 3) for c in middle],
                    f"with radius {radius} m must lie inside the walls",
                )
            for other, there, its_radius in places[:k]:
                if math.dist(middle, there) < radius + its_radius:
                    raise InputError(
                        name,
                        [round(float(c), 3) for c in middle],
                        f"with radius {radius} m must not overlap {other}",
                    )


def build_arena(
    layout: str, swarms: int, side: float, station_radius: float, base_radius: float, seed: int
) -> Arena:
    """Build an arena.

    Parameters
    ----------
    layout : str
        One of `LAYOUTS`.
    swarms : int
        Number of swarms, K.
    side : float
        Side of the square (m); positions, given for 2 m, scale with it.
    station_radius, base_radius : float
        (m)
    seed : int
        Seed of the run, used by ``random-stations``.

    Raises
    ------
    InputError
        If stations, bases and walls overlap.
    """
    scale = side / _SIDE
    bases = scale * base_positions(swarms)
    if layout == "random-stations":
        stations = _random_stations(seed, bases, side / 2, station_radius, base_radius)
    else:
        stations = scale * np.array([[0.0, _STATION_Y], [0.0, -_STATION_Y]])
        if layout == "nearer-station":
            stations[0] = scale * _nearer_station()
    return Arena(side / 2, stations, bases, station_radius, base_radius)


def base_positions(swarms: int) -> Floats:
    """Return the bases for a side of 2 m: all with the same sum of distances to the two stations.

    S1, S3, S5 … lie on the left from top to bottom, S2, S4 … on the right.

    Parameters
    ----------
    swarms : int
        Number of swarms, K.

    Returns
    -------
    ndarray of float64, shape (K, 2)
    """
    # The points with the distance sum of (±0.8, 0) form an ellipse with the stations as foci.
    long_axis = math.hypot(_BASE_X, _STATION_Y)
    bases = np.empty((swarms, 2))
    for first, sign in ((0, -1.0), (1, 1.0)):
        on_side = range(first, swarms, 2)
        for place, k in enumerate(on_side):
            y = _BASE_SPACING * ((len(on_side) - 1) / 2 - place)
            bases[k] = sign * _BASE_X * math.sqrt(max(0.0, 1.0 - (y / long_axis) ** 2)), y
    return bases


def _nearer_station() -> Floats:
    """Return the upper station of the disadvantaged arena, solved from its distances to the two bases."""
    near, far = _NEARER
    x = (near**2 - far**2) / (4 * _BASE_X)
    return np.array([x, math.sqrt(near**2 - (x + _BASE_X) ** 2)])


def _random_stations(
    seed: int, bases: Floats, half: float, station_radius: float, base_radius: float
) -> Floats:
    """Draw two stations that overlap no base, no wall and not each other."""
    draws = stream(seed, WORLD, Purpose.STATIONS)
    limit = max(0.0, half - station_radius)
    stations: list[Floats] = []
    for _ in range(100_000):
        place = draws.uniform(-limit, limit, size=2)
        clear = all(math.dist(place, base) >= station_radius + base_radius for base in bases)
        if clear and all(math.dist(place, other) >= 2 * station_radius for other in stations):
            stations.append(place)
            if len(stations) == 2:
                return np.array(stations)
    raise InputError("station_radius", station_radius, "must leave room for two stations beside the bases")
