"""Crossings and trends of curves with known answers."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats

from kswarms.agents.common.errors import InputError
from kswarms.analysis.statistics.curves import crossings, overtaking, rank_correlation_with_n
from kswarms.analysis.statistics.intervals import Interval
from tests.helpers.chance import is_plausible

DENSITIES = (6, 16, 26, 36, 46)


def seeds_around(
    curve: list[float], seeds: int = 12, noise: float = 1.0, seed: int = 0
) -> NDArray[np.float64]:
    """Return samples, (seeds, densities), whose mean is the curve exactly."""
    draws = np.random.default_rng(seed).normal(scale=noise, size=(seeds, len(curve)))
    return np.asarray(curve) + draws - draws.mean(axis=0)


@pytest.mark.parametrize(
    ("curve", "expected"),
    [
        ([-2, -1, 1, 2, 3], (21.0,)),
        ([-3, 1, -1, 2, 3], (13.5, 21.0, 29 + 1 / 3)),
        ([3, 2, 1, -1, -2], (31.0,)),
        ([1, 2, 3, 4, 5], ()),
        ([-2, -1, 0, 1, 2], (26.0,)),
        ([-2, 0, 0, 1, 2], (21.0,)),  # level with 0 from 16 to 26: its middle
        ([2, 1, 0, 1, 2], ()),  # touches
        ([0, 0, 0, 0, 0], ()),
        ([0, 0, 1, 2, 3], ()),  # never below
    ],
)
def test_crossings_are_interpolated_linearly(curve: list[float], expected: tuple[float, ...]) -> None:
    assert crossings(DENSITIES, curve) == pytest.approx(expected)


def test_a_curve_overtakes_at_its_last_crossing() -> None:
    found = overtaking(DENSITIES, seeds_around([-9, 5, -5, 10, 10], noise=0.1))
    assert len(found.crossings) == 3
    assert found.last_crossing.estimate == pytest.approx(found.crossings[-1]) == pytest.approx(26 + 10 / 3)
    assert 29 < found.last_crossing.low < found.last_crossing.estimate < found.last_crossing.high < 30


def test_a_curve_that_is_always_ahead_never_overtakes() -> None:
    found = overtaking(DENSITIES, seeds_around([5, 5, 5, 5, 5], noise=0.1))
    assert found.crossings == ()
    assert found.last_crossing == Interval(-math.inf, -math.inf, -math.inf)


@pytest.mark.parametrize("curve", [[-5, -5, -5, -5, -5], [5, 5, 5, 5, -5], [5, 5, 5, 5, 0]])
def test_a_curve_that_is_behind_at_the_end_has_not_overtaken(curve: list[float]) -> None:
    values = np.tile(np.asarray(curve, dtype=np.float64), (8, 1))
    assert overtaking(DENSITIES, values).last_crossing == Interval(math.inf, math.inf, math.inf)


def test_an_uncertain_lead_at_the_last_density_gives_an_infinite_bound() -> None:
    found = overtaking(DENSITIES, seeds_around([-9, -9, -9, -9, 0.1]))
    assert 45 < found.last_crossing.estimate < 46
    assert found.last_crossing.high == math.inf
    assert found.last_crossing.low > 44


def test_similar_curves_have_an_infinite_lower_bound_of_the_crossing() -> None:
    found = overtaking(DENSITIES, seeds_around([0.1, -0.1, 0.1, -0.1, 5]))
    assert found.last_crossing.low == -math.inf
    assert 36 < found.last_crossing.high < 38


@pytest.mark.slow
def test_the_interval_of_a_crossing_covers_the_true_crossing_at_its_level() -> None:
    # The line through 0 at N = 30, where the noise of the means is a fifth of the slope between densities.
    line, count = np.array([-2.4, -1.4, -0.4, 0.6, 1.6]), 200
    draws = np.random.default_rng(3)
    hits = 0
    for _ in range(count):
        interval = overtaking(DENSITIES, line + draws.normal(scale=0.9, size=(20, 5))).last_crossing
        hits += interval.low <= 30 <= interval.high
    assert is_plausible(0.95, hits, count), hits / count


def test_rank_correlation_is_spearmans() -> None:
    curve = [1.0, 3.0, 2.0, 5.0, 5.0]
    correlation = rank_correlation_with_n(DENSITIES, seeds_around(curve, noise=0.001))
    assert correlation.estimate == pytest.approx(stats.spearmanr(DENSITIES, curve).statistic, abs=0.06)
    values = np.tile(curve, (8, 1))
    assert rank_correlation_with_n(DENSITIES, values).estimate == pytest.approx(
        stats.spearmanr(DENSITIES, curve).statistic
    )


def test_rank_correlations_of_a_rise_of_noise_and_of_a_constant() -> None:
    rise = rank_correlation_with_n(DENSITIES, seeds_around([0, 10, 20, 30, 40], noise=0.1))
    assert rise == Interval(1.0, 1.0, 1.0)
    level = rank_correlation_with_n(DENSITIES, seeds_around([0.0, 0.1, 0.0, 0.1, 0.0]))
    assert level.low < 0 < level.high
    assert rank_correlation_with_n(DENSITIES, np.ones((8, 5))) == Interval(0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("densities", "values", "complaint"),
    [
        ((6,), np.ones((8, 1)), "densities=.*must be two or more, in ascending order"),
        ((16, 6), np.ones((8, 2)), "must be two or more, in ascending order"),
        ((6, 16), np.ones((8, 3)), "must have 2 densities along the last axis"),
        ((6, 16), np.ones(2), r"must have the shape \(seeds, densities\)"),
    ],
)
def test_invalid_samples_are_refused(
    densities: tuple[int, ...], values: NDArray[np.float64], complaint: str
) -> None:
    for function in (overtaking, rank_correlation_with_n):
        with pytest.raises(InputError, match=complaint):
            function(densities, values)
