"""Places of stations and bases (section 2.1)."""

import math

import numpy as np
import pytest

from kswarms.agents.common.errors import InputError
from kswarms.model.description.arena import Arena, base_positions, build_arena
from kswarms.model.description.fields import LAYOUTS

STATION_RADIUS, BASE_RADIUS = 0.16, 0.17
LOWER_STATION = (0.0, -0.66)


def build(layout: str = "symmetric", swarms: int = 2, side: float = 2.0, seed: int = 0) -> Arena:
    return build_arena(layout, swarms, side, STATION_RADIUS, BASE_RADIUS, seed)


def test_the_symmetric_arena_of_two_swarms() -> None:
    arena = build()
    assert arena.half == 1.0
    assert arena.bases.tolist() == [[-0.8, 0.0], [0.8, 0.0]]
    assert arena.stations.tolist() == [[0.0, 0.66], [0.0, -0.66]]
    assert (arena.station_radius, arena.base_radius) == (STATION_RADIUS, BASE_RADIUS)


def test_the_nearer_station_has_the_given_distances() -> None:
    arena = build("nearer-station")
    upper, lower = arena.stations
    first, second = arena.bases
    assert math.dist(upper, first) == pytest.approx(0.96, abs=1e-12)
    assert math.dist(upper, second) == pytest.approx(1.12, abs=1e-12)
    assert upper == pytest.approx((-0.104, 0.661), abs=5e-4)
    assert tuple(lower) == LOWER_STATION
    assert arena.bases.tolist() == build().bases.tolist()


def distance_sums(swarms: int) -> list[float]:
    arena = build(swarms=swarms)
    return [sum(math.dist(base, station) for station in arena.stations) for base in arena.bases]


def test_bases_of_one_and_of_three_swarms() -> None:
    assert base_positions(1).tolist() == [[-0.8, 0.0]]
    first, second, third = base_positions(3)
    assert tuple(second) == (0.8, 0.0)
    assert first == pytest.approx((-0.788, 0.18), abs=5e-4)
    assert third == pytest.approx((-0.788, -0.18), abs=5e-4)
    assert first[0] == third[0]


@pytest.mark.parametrize("swarms", range(1, 7))
def test_every_base_has_the_same_sum_of_distances_to_the_stations(swarms: int) -> None:
    assert distance_sums(swarms) == pytest.approx([2 * math.hypot(0.8, 0.66)] * swarms, abs=1e-12)


@pytest.mark.parametrize("swarms", range(1, 7))
@pytest.mark.parametrize("layout", ["symmetric", "random-stations"])
def test_places_do_not_overlap_and_are_inside(swarms: int, layout: str) -> None:
    for seed in range(10 if layout == "random-stations" else 1):
        arena = build(layout, swarms, seed=seed)
        discs = [(base, BASE_RADIUS) for base in arena.bases]
        discs += [(station, STATION_RADIUS) for station in arena.stations]
        for k, (middle, radius) in enumerate(discs):
            assert np.abs(middle).max() + radius <= 1.0
            for other, its_radius in discs[:k]:
                assert math.dist(middle, other) >= radius + its_radius


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("side", [2.0, 3.7])
def test_positions_scale_with_the_side_and_radii_do_not(layout: str, side: float) -> None:
    arena = build(layout, side=side)
    assert arena.half == side / 2
    assert arena.station_radius == STATION_RADIUS
    assert arena.bases * 2 / side == pytest.approx(build(layout).bases)
    if layout != "random-stations":
        assert arena.stations * 2 / side == pytest.approx(build(layout).stations)


def test_random_stations_depend_on_the_seed() -> None:
    again, other = (build("random-stations", seed=seed).stations for seed in (3, 4))
    assert (build("random-stations", seed=3).stations == again).all()
    assert not (other == again).any()


def test_random_stations_are_uniform() -> None:
    stations = np.concatenate([build("random-stations", seed=seed).stations for seed in range(300)])
    assert np.abs(stations).max() <= 1 - STATION_RADIUS
    # A quarter is in each quadrant, within four standard deviations.
    quadrants = np.bincount((stations[:, 0] > 0) * 2 + (stations[:, 1] > 0), minlength=4)
    assert quadrants == pytest.approx([150] * 4, abs=4 * math.sqrt(600 * 0.25 * 0.75))


@pytest.mark.parametrize(
    ("arguments", "field", "allowed"),
    [
        (("symmetric", 2, 2.0, 0.16, 0.21), "base 1", "must lie inside the walls"),
        (("symmetric", 2, 2.0, 0.35, 0.17), "station 1", "must lie inside the walls"),
        (("symmetric", 3, 2.0, 0.16, 0.181), "base 3", "must not overlap base 1"),
        (("symmetric", 2, 1.0, 0.33, 0.19), "base 1", "must lie inside the walls"),
        (("symmetric", 2, 0.8, 0.12, 0.08), "base 1", "must lie inside the walls"),
        (("symmetric", 12, 2.0, 0.16, 0.17), "base 1", "must lie inside the walls"),
        (("nearer-station", 2, 2.0, 0.34, 0.17), "station 1", "must lie inside the walls"),
        (("random-stations", 2, 2.0, 0.60, 0.17), "station_radius", "must leave room for two stations"),
        (("random-stations", 2, 2.0, 1.50, 0.17), "station_radius", "must leave room for two stations"),
    ],
)
def test_an_arena_whose_places_do_not_fit_is_refused(
    arguments: tuple[str, int, float, float, float], field: str, allowed: str
) -> None:
    with pytest.raises(InputError) as refusal:
        build_arena(*arguments, 0)
    assert refusal.value.field == field
    assert allowed in refusal.value.allowed
