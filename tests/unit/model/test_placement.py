"""Starting places of robots: random, apart from each other and the walls (section 3.1)."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.distance import pdist

from kswarms.agents.common.errors import InputError
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
