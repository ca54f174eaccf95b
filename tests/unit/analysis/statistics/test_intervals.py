"""Statistics over seeds, on data whose answers are known: by hand, or by the law they are drawn from."""

import math
from collections.abc import Callable, Iterator

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats
from statsmodels.stats.power import TTestPower

from kswarms.agents.common.errors import InputError
from kswarms.analysis.statistics.intervals import (
    Interval,
    adjusted,
    bootstrap_interval,
    compare_paired,
    effect_size,
    fewest_seeds,
    more_seeds,
)

Values = NDArray[np.float64]


def normal_samples(count: int, seeds: int, mean: float = 0.0) -> Iterator[Values]:
    draws = np.random.default_rng(0)
    for _ in range(count):
        yield draws.normal(loc=mean, size=seeds)


def may_be(share: float, hits: int, count: int, slack: float = 0.0) -> bool:
    """Return whether `hits` of `count` suit odds of `share`, up to `slack`, by the binomial law (99.9 %)."""
    low, _ = stats.binom.interval(0.999, count, share - slack)
    _, high = stats.binom.interval(0.999, count, min(1.0, share + slack))
    return bool(low <= hits <= high)


def test_the_binomial_check_tells_odds_apart() -> None:
    assert may_be(0.05, 20, 400)
    assert not may_be(0.05, 40, 400)
    assert not may_be(0.05, 3, 400)


# ---------------------------------------------------------------------------------------- bootstrap intervals


@pytest.mark.parametrize(
    ("seeds", "draw", "mean"),
    [
        (8, lambda draws, seeds: draws.normal(size=seeds), 0.0),
        (20, lambda draws, seeds: draws.normal(size=seeds), 0.0),
        (20, lambda draws, seeds: draws.poisson(16, seeds) - draws.poisson(11, seeds), 5.0),
    ],
    ids=["normal, 8 seeds", "normal, 20 seeds", "difference of counts, 20 seeds"],
)
def test_an_interval_of_95_percent_covers_the_truth_about_as_often(
    seeds: int, draw: Callable[[np.random.Generator, int], Values], mean: float
) -> None:
    draws, count = np.random.default_rng(0), 400
    intervals = [bootstrap_interval(draw(draws, seeds)) for _ in range(count)]
    hits = sum(interval.low <= mean <= interval.high for interval in intervals)
    # A bootstrap of few seeds keeps its level to a point or two.
    assert may_be(0.95, hits, count, slack=0.02), hits / count


def test_an_interval_says_no_where_the_truth_is_elsewhere() -> None:
    samples = list(normal_samples(50, seeds=20, mean=2.0))
    assert not any(bootstrap_interval(sample).low <= 0 for sample in samples)


def test_an_interval_is_the_same_each_time() -> None:
    sample = next(normal_samples(1, seeds=12))
    assert bootstrap_interval(sample) == bootstrap_interval(sample)


def test_a_higher_confidence_gives_a_wider_interval() -> None:
    sample = next(normal_samples(1, seeds=20))
    narrow, wide = bootstrap_interval(sample, confidence=0.8), bootstrap_interval(sample, confidence=0.99)
    assert wide.low < narrow.low < narrow.high < wide.high


def test_seeds_that_are_alike_give_an_interval_of_no_width() -> None:
    assert bootstrap_interval([3.0] * 8) == Interval(3.0, 3.0, 3.0)


def test_too_few_seeds_give_an_interval_without_bounds() -> None:
    assert bootstrap_interval([1.0, 2.0, 3.0]) == Interval(2.0, -math.inf, math.inf)
    assert bootstrap_interval([3.0] * 5) == Interval(3.0, -math.inf, math.inf)
    assert bootstrap_interval([1.0, 2.0, 3.0], confidence=0.7).low > 0


def test_six_seeds_are_the_fewest_for_95_percent() -> None:
    # All on one side: 2 / 2⁶ = 0.031, but 2 / 2⁵ = 0.063.
    assert fewest_seeds(0.95) == 6
    assert fewest_seeds(0.5) == 2
    assert fewest_seeds(0.995) == 9


def test_bca_has_no_answer_and_percentiles_have() -> None:
    # Leaving one seed out never changes the median, so there is no acceleration to compute.
    sample = np.array([0.0] * 4 + [1.0] * 8 + [2.0] * 4)
    median = bootstrap_interval(sample, lambda samples: np.median(samples, axis=1))
    assert median == Interval(1.0, 0.5, 1.5)


def test_infinite_resamples_count() -> None:
    sample = np.arange(8.0)
    interval = bootstrap_interval(
        sample, lambda samples: np.where(samples.mean(axis=1) > 4.5, np.inf, samples.mean(axis=1))
    )
    assert interval.high == math.inf
    assert 0 < interval.low < 3.5


def test_what_belongs_to_a_seed_is_drawn_together() -> None:
    # The two columns are the same numbers, so in every resample their difference is 0.
    column = next(normal_samples(1, seeds=10))
    interval = bootstrap_interval(
        np.stack([column, column], axis=1), lambda samples: (samples[..., 0] - samples[..., 1]).mean(axis=1)
    )
    assert interval == Interval(0.0, 0.0, 0.0)


@pytest.mark.parametrize("confidence", [0.0, 1.0, -1.0, 95.0])
def test_a_confidence_is_between_0_and_1(confidence: float) -> None:
    with pytest.raises(InputError, match=r"confidence=.*must be between 0 and 1"):
        bootstrap_interval([1.0, 2.0], confidence=confidence)


def test_no_seed_is_no_sample() -> None:
    with pytest.raises(InputError, match="seeds=0: must be at least 1"):
        bootstrap_interval([])


# ----------------------------------------------------------------------------------------- paired comparisons


@pytest.mark.slow
def test_a_true_null_is_rejected_in_about_5_of_100_cases() -> None:
    # What both share from seed to seed hides nothing: it goes out with the difference.
    count, draws = 400, np.random.default_rng(1)
    rejected = 0
    for shared in normal_samples(count, seeds=12):
        first, second = shared + draws.normal(size=12), shared + draws.normal(size=12)
        rejected += compare_paired(first, second).p_value <= 0.05
    assert may_be(0.05, rejected, count), rejected / count


@pytest.mark.slow
def test_a_known_effect_is_found_with_the_stated_power() -> None:
    size, seeds, count = 0.8, 14, 300
    power = float(TTestPower().power(effect_size=size, nobs=seeds, alpha=0.05))
    assert 0.7 < power < 0.85
    found = sum(
        compare_paired(sample, np.zeros(seeds)).p_value <= 0.05
        for sample in normal_samples(count, seeds, mean=size)
    )
    assert may_be(power, found, count), (found / count, power)


def test_a_paired_comparison_by_hand() -> None:
    compared = compare_paired([3.0, 5.0, 4.0, 6.0, 8.0, 7.0], [2.0, 3.0, 3.0, 4.0, 5.0, 6.0])
    differences = np.array([1.0, 2.0, 1.0, 2.0, 3.0, 1.0])
    assert compared.seeds == 6
    assert compared.difference.estimate == pytest.approx(differences.mean())
    assert compared.d_z == pytest.approx(differences.mean() / differences.std(ddof=1))
    # Of the 2⁶ exchanges two are as extreme.
    assert compared.p_value == pytest.approx(2 / 64)
    pairs = [(x > y) - (x < y) for x in (3, 5, 4, 6, 8, 7) for y in (2, 3, 3, 4, 5, 6)]
    assert compared.cliffs_delta == pytest.approx(sum(pairs) / 36)


def test_pairs_that_cannot_differ() -> None:
    compared = compare_paired([1.0] * 6, [1.0] * 6)
    assert (compared.p_value, compared.d_z, compared.cliffs_delta) == (1.0, 0.0, 0.0)


def test_the_same_difference_everywhere_is_an_effect_without_end() -> None:
    assert effect_size([2.0, 2.0]) == math.inf
    assert effect_size([-2.0, -2.0]) == -math.inf
    assert effect_size([0.0, 0.0]) == 0.0


@pytest.mark.parametrize(
    ("first", "second", "complaint"),
    [
        ([1.0, 2.0], [1.0], r"second=\(1,\): must have the shape \(2,\), one value for each seed"),
        ([[1.0]], [[1.0]], "one value for each seed"),
        ([1.0], [2.0], "seeds=1: must be at least 2"),
    ],
)
def test_pairs_that_are_none(first: list[float], second: list[float], complaint: str) -> None:
    with pytest.raises(InputError, match=complaint):
        compare_paired(first, second)


# ------------------------------------------------------------------------------------- many, and seeds needed


def test_holm_by_hand() -> None:
    assert adjusted([0.01, 0.04, 0.03, 0.5]) == pytest.approx([0.04, 0.09, 0.09, 0.5])


def test_benjamini_hochberg_by_hand() -> None:
    corrected = adjusted([0.01, 0.04, 0.03, 0.5], "benjamini-hochberg")
    assert corrected == pytest.approx([0.04, 4 / 3 * 0.04, 4 / 3 * 0.04, 0.5])


def test_nothing_to_correct() -> None:
    assert adjusted([]) == []


def test_what_is_no_p_value_or_no_method() -> None:
    with pytest.raises(InputError, match=r"p_values=1\.5: must be between 0 and 1"):
        adjusted([0.5, 1.5])
    with pytest.raises(InputError, match="method='none': must be one of holm, benjamini-hochberg"):
        adjusted([0.5], "none")  # type: ignore[arg-type]


@pytest.mark.parametrize("d_z", [0.1, 0.5, 2.0])
def test_the_seeds_asked_for_have_the_power(d_z: float) -> None:
    sample = next(normal_samples(1, seeds=3))
    sample = (sample - sample.mean()) / sample.std(ddof=1) + d_z
    more = more_seeds(sample, power=0.8)
    assert more is not None
    powers = [TTestPower().power(d_z, 3 + seeds, 0.05) for seeds in (more - 1, more)]
    assert powers[0] < 0.8 <= powers[1]


def test_seeds_enough_and_seeds_that_would_never_do() -> None:
    assert more_seeds([5.0, 5.1, 4.9, 5.0]) == 0
    assert more_seeds([5.0, 5.0]) == more_seeds([50.0, 50.1, 49.9, 50.0], confidence=0.995) == 0
    assert more_seeds([1.0, -1.0]) is None


def test_no_power_and_no_seeds() -> None:
    with pytest.raises(InputError, match=r"power=1\.0: must be between 0 and 1"):
        more_seeds([1.0, 2.0], power=1.0)
    with pytest.raises(InputError, match="seeds=1: must be at least 2"):
        more_seeds([1.0])
