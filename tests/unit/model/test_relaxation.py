"""Relaxation: small and large crowds are moved by different loops, with the same result."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kswarms.agents.common.arrays import Floats
from kswarms.model.kernel.arrays import make_pairs, make_work
from kswarms.model.kernel.relaxation import _measure_overlaps, _momentum, _move_all, _move_bodies, _reset

RADIUS, LIMIT = 0.1, 0.8


def crowd(seed: int) -> Floats:
    """Return x and y of 40 bodies that overlap, shape (2, 40)."""
    return np.random.default_rng(seed).uniform(-LIMIT, LIMIT, (2, 40))


def relaxed(places: Floats, few: bool, passes: int = 12) -> tuple[Any, ...]:
    """Return the places and moves after some passes of the loop for few bodies, or of the other."""
    x, y = places.copy()
    n = len(x)
    work, pairs = make_work(n), make_pairs(n * (n - 1) // 2 + 1)
    n_pairs = len(pairs.first) - 1
    pairs.close_first[:n_pairs], pairs.close_second[:n_pairs] = np.triu_indices(n, 1)
    _reset(work)
    n_moved = 0
    for done in range(passes):
        n_overlaps, _ = _measure_overlaps(x, y, RADIUS, work, pairs, n_pairs)
        if few:
            _move_all(x, y, LIMIT, work, _momentum(done))
        else:
            n_moved = _move_bodies(x, y, LIMIT, work, pairs, n_overlaps, n_moved, _momentum(done))
    return x, y, work.move_x, work.move_y


@given(st.integers(0, 2**32))
def test_both_loops_move_bodies_alike(seed: int) -> None:
    for few, many in zip(relaxed(crowd(seed), few=True), relaxed(crowd(seed), few=False), strict=True):
        np.testing.assert_array_equal(few, many)


def test_a_difference_of_the_loops_is_detected() -> None:
    places = crowd(0)
    places[0, 0] += 1e-9
    with pytest.raises(AssertionError):
        np.testing.assert_array_equal(relaxed(places, few=True)[0], relaxed(crowd(0), few=False)[0])
