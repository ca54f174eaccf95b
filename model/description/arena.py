"""The arena: a square with supply stations and home bases (specification, section 2.1). SI units."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from kswarms.agents.common.arrays import Floats
from kswarms.agents.common.errors import InputError
from kswarms.agents.streams import ENVIRONMENT, Purpose, stream

# Positions of the layouts in an arena of 2 m × 2 m.
_SIDE: Final = 2.0
_BASE_X: Final = 0.80
_STATION_Y: Final = 0.66
_BASE_SPACING: Final = 0.36
"""Distance in y between neighbouring bases on one side (m)."""
_NEARER: Final = (0.96, 1.12)
"""Distances of the upper station from the bases of S1 and S2 in the disadvantaged arena (m)."""


@dataclass(frozen=True)
class Arena:
    """Stations and bases, which must not overlap each other or the walls. The origin is the centre.

    Attributes
    ----------
    half : float
        Half the side of the square (m).
    stations : ndarray of float64, shape (S, 2)
        Centres of the supply stations (m).
    bases : ndarray of float64, shape (K, 2)
        Centres of the home bases, S1 first (m).
    station_radius, base_radius : float
        Radii of a station and a base (m).
    """

    half: float
    stations: Floats
    bases: Floats
    station_radius: float
    base_radius: float

    def __post_init__(self) -> None:
        names = [f"base {k + 1}" for k in range(len(self.bases))]
        names += [f"station {k + 1}" for k in range(len(self.stations))]
        places = [*self.bases.tolist(), *self.stations.tolist()]
        radii = [self.base_radius] * len(self.bases) + [self.station_radius] * len(self.stations)
        for k, ((x, y), radius) in enumerate(zip(places, radii, strict=True)):
            rule = ""
            if max(abs(x), abs(y)) + radius > self.half:
                rule = "must lie inside the walls"
            for other in range(k):
                if math.dist(places[other], (x, y)) < radius + radii[other]:
                    rule = rule or f"must not overlap {names[other]}"
            if rule:
                raise InputError(names[k], [round(x, 3), round(y, 3)], f"with radius {radius} m {rule}")


def build_arena(
    layout: str,
    swarms: int,
    side: float,
    station_radius: float,
    base_radius: float,
    seed: int,
    stations: Sequence[tuple[float, float]] = (),
    bases: Sequence[tuple[float, float]] = (),
) -> Arena:
    """Build an arena.

    Parameters
    ----------
    layout, side, stations, bases
        As in `kswarms.model.description.fields.GameFields`.
    swarms : int
        Number of swarms K.
    station_radius, base_radius : float
        Radii of a station and a base (m).
    seed : int
        Seed of the run; only random stations depend on it.

    Raises
    ------
    InputError
        If stations, bases and walls overlap.
    """
    scale = side / _SIDE
    base_places = np.array(bases) if bases else scale * base_positions(swarms)
    if stations:
        station_places = np.array(stations)
    elif layout == "random-stations":
        station_places = _random_stations(seed, base_places, side / 2, station_radius, base_radius)
    else:
        station_places = scale * np.array([[0.0, _STATION_Y], [0.0, -_STATION_Y]])
        if layout == "nearer-station":
            station_places[0] = scale * _nearer_station()
    return Arena(side / 2, station_places, base_places, station_radius, base_radius)


def base_positions(swarms: int) -> Floats:
    """Return the bases for a side of 2 m (m), ndarray of float64, shape (K, 2).

    All bases have the same sum of distances to the two stations. S1, S3, S5 … lie on the left from top to
    bottom, S2, S4 … on the right.
    """
    # Points with the same sum of distances as (±0.8, 0) form an ellipse with the stations as foci.
    long_axis = math.hypot(_BASE_X, _STATION_Y)
    bases = np.empty((swarms, 2))
    for first, sign in ((0, -1.0), (1, 1.0)):
        on_side = range(first, swarms, 2)
        for place, k in enumerate(on_side):
            y = _BASE_SPACING * ((len(on_side) - 1) / 2 - place)
            bases[k] = sign * _BASE_X * math.sqrt(max(0.0, 1.0 - (y / long_axis) ** 2)), y
    return bases


def _nearer_station() -> Floats:
    """Return the upper station of the disadvantaged arena, from its distances to the two bases (m)."""
    near, far = _NEARER
    x = (near**2 - far**2) / (4 * _BASE_X)
    return np.array([x, math.sqrt(near**2 - (x + _BASE_X) ** 2)])


def _random_stations(
    seed: int, bases: Floats, half: float, station_radius: float, base_radius: float
) -> Floats:
    """Draw two stations that overlap neither bases, walls nor each other."""
    rng = stream(seed, ENVIRONMENT, Purpose.STATIONS)
    limit = max(0.0, half - station_radius)
    stations: list[Floats] = []
    for _ in range(100_000):
        place = rng.uniform(-limit, limit, size=2)
        clear = all(math.dist(place, base) >= station_radius + base_radius for base in bases)
        if clear and all(math.dist(place, other) >= 2 * station_radius for other in stations):
            stations.append(place)
            if len(stations) == 2:
                return np.array(stations)
    raise InputError("station_radius", station_radius, "must leave room for two stations beside the bases")
