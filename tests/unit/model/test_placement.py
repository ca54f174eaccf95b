"""Starting places of robots: random, apart from each other and the walls (section 3.1)."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree
from scipy.spatial.distance import pdist

from kswarms.agents.common.arrays import Floats
from kswarms.agents.common.errors import InputError
from kswarms.agents.streams import Purpose, stream
from kswarms.model.kernel.arrays import make_pairs, make_work
from kswarms.model.kernel.draws import draw, seed_streams
from kswarms.model.kernel.relaxation import TOLERANCE, relax
from kswarms.model.placement import start_poses

RADIUS, CLEARANCE, WALL_CLEARANCE = 0.085, 0.01, 0.005


@settings(max_examples=40)
@given(st.integers(1, 70), st.integers(0, 2**64), st.sampled_from([1.0, 1.3]))
def test_starting_places_do_not_overlap_and_lie_inside_the_walls(n: int, seed: int, half: float) -> None:
    positions, headings = start_poses(n, seed, half, RADIUS, CLEARANCE, WALL_CLEARANCE)
    assert positions.shape == (n, 2)
    assert headings.shape == (n,)
    if n > 1:
        assert pdist(positions).min() >= 2 * RADIUS + CLEARANCE
    assert np.abs(positions).max() <= half - RADIUS - WALL_CLEARANCE
    assert np.abs(headings).max() <= math.pi


def test_more_robots_do_not_move_the_first_ones() -> None:
    fewer, more = (start_poses(n, 7, 1.0, RADIUS, CLEARANCE, WALL_CLEARANCE) for n in (20, 50))
    assert (more[0][:20] == fewer[0]).all()
    assert (more[1][:20] == fewer[1]).all()


def test_other_seeds_give_other_places() -> None:
    worlds = [start_poses(10, seed, 1.0, RADIUS, CLEARANCE, WALL_CLEARANCE) for seed in (1, 2)]
    assert not (worlds[0][0] == worlds[1][0]).any()
    assert not (worlds[0][1] == worlds[1][1]).any()


def test_places_and_headings_are_uniform() -> None:
    # The first robot of a game is placed independently of the others.
    starts = [start_poses(1, seed, 1.0, RADIUS, CLEARANCE, WALL_CLEARANCE) for seed in range(1000)]
    limit = 1.0 - RADIUS - WALL_CLEARANCE
    for draws, width in (
        (np.array([positions[0, 0] for positions, _ in starts]), limit),
        (np.array([positions[0, 1] for positions, _ in starts]), limit),
        (np.array([headings[0] for _, headings in starts]), math.pi),
    ):
        counts, _ = np.histogram(draws, bins=10, range=(-width, width))
        # χ² with 9 degrees of freedom stays below 27.9 in 999 of 1000 cases.
        assert ((counts - 100.0) ** 2 / 100.0).sum() < 27.9


def test_robots_without_room_are_refused() -> None:
    with pytest.raises(InputError, match=r"^n=9: robots of radius 0.2 m do not fit in a square of 1.0 m$"):
        start_poses(9, 0, 0.5, 0.2, 0.0, 0.0)


@pytest.mark.parametrize("seed", range(3))
def test_overlaps_in_a_crowd_are_relaxed(seed: int) -> None:
    positions, _ = start_poses(80, seed, 1.0, RADIUS, CLEARANCE, WALL_CLEARANCE)
    assert pdist(positions).min() >= 2 * RADIUS + CLEARANCE
    assert np.abs(positions).max() <= 1.0 - RADIUS - WALL_CLEARANCE + 1e-12


def place_one_by_one(n: int, seed: int, half: float) -> Floats:
    """Return the places of `start_poses`, found by comparing all robots with each other."""
    limit, gap = half - RADIUS - WALL_CLEARANCE, 2 * RADIUS + CLEARANCE
    places, crowded = np.empty((0, 2)), False
    for robot in range(n):
        drawn = stream(seed, robot, Purpose.POSITION).uniform(-limit, limit, size=(8464, 2))
        for first in (50, 8464):
            room = ((drawn[:first, None] - places) ** 2).sum(axis=2).min(axis=1, initial=np.inf)
            free = np.flatnonzero(room >= gap**2)
            if len(free):
                break
        crowded |= not len(free)
        place = drawn[free[0]] if len(free) else drawn[-4096:][room[-4096:].argmax()]
        places = np.vstack([places, place])
    if crowded:
        pairs = make_pairs(n * (n - 1) // 2)
        pairs.first[:], pairs.second[:] = np.triu_indices(n, 1)
        x, y, reach = places[:, 0].copy(), places[:, 1].copy(), gap / 2 + TOLERANCE
        relax(x, y, reach, limit + reach, make_work(n), pairs, len(pairs.first))
        places = np.column_stack((x, y))
    return places


@pytest.mark.parametrize(("n", "half"), [(40, 20.0), (60, 1.0), (75, 1.0), (85, 1.0)])
def test_places_are_those_of_a_search_among_all_robots(n: int, half: float) -> None:
    positions, headings = start_poses(n, n, half, RADIUS, CLEARANCE, WALL_CLEARANCE)
    assert (positions == place_one_by_one(n, n, half)).all()
    drawn = [stream(n, robot, Purpose.HEADING).uniform(-math.pi, math.pi) for robot in range(n)]
    assert headings.tolist() == drawn


@given(st.one_of(st.integers(0, 2**70), st.integers(0, 2**200)), st.sampled_from(Purpose))
def test_draws_of_many_streams_equal_those_of_each_stream(seed: int, purpose: Purpose) -> None:
    with np.errstate(over="ignore"):
        streams = seed_streams(seed, 3, purpose)
        draws = [[draw(streams, robot) for _ in range(4)] for robot in range(3)]
    assert draws == [stream(seed, robot, purpose).random(4).tolist() for robot in range(3)]


def test_places_of_many_robots_do_not_overlap() -> None:
    positions, _ = start_poses(20_000, 1, 20.0, RADIUS, CLEARANCE, WALL_CLEARANCE)
    assert not cKDTree(positions).query_pairs(2 * RADIUS + CLEARANCE - 1e-12)


def test_a_large_crowd_is_relaxed() -> None:
    positions, _ = start_poses(5000, 1, 7.1, RADIUS, CLEARANCE, WALL_CLEARANCE)
    assert not cKDTree(positions).query_pairs(2 * RADIUS + CLEARANCE - 1e-12)
