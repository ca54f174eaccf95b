"""Bootstrap intervals of samples with known answers."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from kswarms.agents.common.errors import InputError
from kswarms.analysis.statistics.intervals import (
    Interval,
    bootstrap_interval,
    intervals_of_means,
    min_seeds,
)
from tests.helpers.chance import is_plausible, normal_samples

Values = NDArray[np.float64]


def test_the_plausibility_check_rejects_other_shares() -> None:
    assert is_plausible(0.05, 20, 400)
    assert not is_plausible(0.05, 40, 400)
    assert not is_plausible(0.05, 3, 400)


@pytest.mark.parametrize(
    ("seeds", "draw", "mean"),
    [
        (8, lambda draws, shape: draws.normal(size=shape), 0.0),
        (20, lambda draws, shape: draws.normal(size=shape), 0.0),
        (20, lambda draws, shape: draws.poisson(16, shape) - draws.poisson(11, shape), 5.0),
        (20, lambda draws, shape: draws.exponential(size=shape), 1.0),
    ],
    ids=["normal, 8 seeds", "normal, 20 seeds", "difference of counts, 20 seeds", "exponential, 20 seeds"],
)
def test_an_interval_covers_the_true_mean_at_its_level(
    seeds: int, draw: Callable[[np.random.Generator, tuple[int, int]], Values], mean: float
) -> None:
    count = 400
    low, high = intervals_of_means(draw(np.random.default_rng(0), (count, seeds)))
    hits = int(((low <= mean) & (mean <= high)).sum())
    # A bootstrap of few seeds keeps its level to one or two points.
    assert is_plausible(0.95, hits, count, slack=0.02), hits / count


def test_an_interval_excludes_a_distant_value() -> None:
    low, _ = intervals_of_means(np.stack(list(normal_samples(50, seeds=20, mean=2.0))))
    assert (low > 0).all()


def test_intervals_of_many_means_equal_single_intervals() -> None:
    samples = np.stack([*normal_samples(4, seeds=12), np.full(12, 0.1)])
    single = [bootstrap_interval(sample) for sample in samples]
    for bounds, name in zip(intervals_of_means(samples), ("low", "high"), strict=True):
        # Rounding decides whether a resample equals the estimate, and with it the bias of BCa.
        assert bounds.tolist() == pytest.approx([getattr(each, name) for each in single], rel=1e-3)


def test_a_higher_confidence_gives_a_wider_interval() -> None:
    sample = next(normal_samples(1, seeds=20))
    narrow, wide = bootstrap_interval(sample, confidence=0.8), bootstrap_interval(sample, confidence=0.99)
    assert narrow == bootstrap_interval(sample, confidence=0.8)  # the same each time
    assert wide.low < narrow.low < narrow.high < wide.high


def test_identical_seeds_give_an_interval_of_width_0() -> None:
    assert bootstrap_interval([0.1] * 8) == Interval(0.1, 0.1, 0.1)


def test_too_few_seeds_give_no_bounds() -> None:
    assert bootstrap_interval([1.0, 2.0, 3.0]) == Interval(2.0, -math.inf, math.inf)
    assert bootstrap_interval([3.0] * 5) == Interval(3.0, -math.inf, math.inf)
    assert bootstrap_interval([1.0, 2.0, 3.0], confidence=0.7).low > 0


def test_six_seeds_are_the_minimum_for_95_percent() -> None:
    # All on one side: 2 / 2⁶ = 0.031, but 2 / 2⁵ = 0.063.
    assert min_seeds(0.95) == 6
    assert min_seeds(0.5) == 2
    assert min_seeds(0.995) == 9


def test_percentiles_replace_bca_where_it_is_undefined() -> None:
    # Leaving one seed out never changes the rounded mean, so BCa has no acceleration.
    sample = np.array([0.0] * 4 + [1.0] * 8 + [2.0] * 4)
    interval = bootstrap_interval(sample, lambda means: np.round(2 * means) / 2)
    assert interval == Interval(1.0, 0.5, 1.5)


def test_infinite_resamples_give_infinite_bounds() -> None:
    interval = bootstrap_interval(np.arange(8.0), lambda means: np.where(means > 4.5, np.inf, means))
    assert interval.high == math.inf
    assert 0 < interval.low < 3.5


def test_an_undefined_resample_leaves_no_bounds() -> None:
    interval = bootstrap_interval(np.arange(8.0), lambda means: np.where(means > 4.5, np.nan, means))
    assert interval.estimate == 3.5
    assert math.isnan(interval.low)
    assert math.isnan(interval.high)


def test_values_of_one_seed_are_resampled_together() -> None:
    column = next(normal_samples(1, seeds=10))
    interval = bootstrap_interval(np.stack([column, column], axis=1), lambda means: means[:, 0] - means[:, 1])
    assert interval == Interval(0.0, 0.0, 0.0)


@pytest.mark.parametrize("confidence", [0.0, 1.0, -1.0, 95.0])
def test_a_confidence_is_between_0_and_1(confidence: float) -> None:
    with pytest.raises(InputError, match=r"confidence=.*must be between 0 and 1"):
        bootstrap_interval([1.0, 2.0], confidence=confidence)


def test_a_sample_needs_a_seed() -> None:
    with pytest.raises(InputError, match="seeds=0: must be at least 1"):
        bootstrap_interval([])
