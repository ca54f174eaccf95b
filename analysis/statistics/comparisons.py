"""Comparisons of two samples over seeds, corrections for multiple tests, and required numbers of seeds."""

import math
import warnings
from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import ArrayLike
from scipy import stats
from statsmodels.stats.multitest import multipletests
from statsmodels.stats.power import TTestPower

from kswarms.agents.common.errors import InputError
from kswarms.analysis.statistics.intervals import (
    CONFIDENCE,
    RANDOM_SEED,
    RESAMPLES,
    Interval,
    bootstrap_interval,
    check_confidence,
    check_seeds,
)

_MAX_SEEDS: Final = 1_000_000


@dataclass(frozen=True)
class PairedComparison:
    """Comparison of two samples of the same seeds.

    Attributes
    ----------
    difference : Interval
        Mean of first − second, in the unit of the samples.
    d_z : float
        Cohen's d_z, as `effect_size` returns it.
    cliffs_delta : float
        P(first > second) − P(first < second) over all pairs of values, −1 … 1.
    p_value : float
        Two-sided p-value of the permutation test that swaps the values of a seed; exact up to 13 seeds.
    seeds : int
        Number of pairs.
    """

    difference: Interval
    d_z: float
    cliffs_delta: float
    p_value: float
    seeds: int


def compare_paired(first: ArrayLike, second: ArrayLike, confidence: float = CONFIDENCE) -> PairedComparison:
    """Compare two samples of the same seeds in the same order; shape (seeds,), at least two seeds."""
    one, other = np.asarray(first, dtype=np.float64), np.asarray(second, dtype=np.float64)
    if one.ndim != 1 or one.shape != other.shape:
        raise InputError("second", other.shape, f"must have the shape {one.shape}, one value for each seed")
    check_seeds(one, 2)
    test = stats.permutation_test(
        (one, other),
        lambda x, y, axis: np.mean(x - y, axis=axis),
        permutation_type="samples",
        vectorized=True,
        n_resamples=RESAMPLES,
        rng=np.random.default_rng(RANDOM_SEED),
    )
    larger = stats.mannwhitneyu(one, other).statistic / one.size**2
    return PairedComparison(
        difference=bootstrap_interval(one - other, confidence=confidence),
        d_z=effect_size(one - other),
        cliffs_delta=float(2 * larger - 1),
        p_value=float(test.pvalue),
        seeds=one.size,
    )


def compare_independent(first: ArrayLike, second: ArrayLike, confidence: float = CONFIDENCE) -> Interval:
    """Return the difference of the means of two independent samples, with Welch's interval.

    The bounds are NaN if a sample has a single value. The interval has width 0 if both samples are constant.
    """
    one, other = np.asarray(first, dtype=np.float64), np.asarray(second, dtype=np.float64)
    difference = float(one.mean() - other.mean())
    if min(one.size, other.size) < 2:
        return Interval(difference, math.nan, math.nan)
    if np.ptp(one) == np.ptp(other) == 0:
        return Interval(difference, difference, difference)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # a sample may be constant
        bounds = stats.ttest_ind(one, other, equal_var=False).confidence_interval(confidence)
    return Interval(difference, float(bounds.low), float(bounds.high))


def effect_size(differences: ArrayLike) -> float:
    """Return Cohen's d_z, mean / standard deviation; for equal values ±inf, or 0 if they are 0."""
    values = np.asarray(differences, dtype=np.float64)
    mean, deviation = float(values.mean()), float(values.std(ddof=1))
    if (values == values[0]).all():
        return math.copysign(math.inf, mean) if mean else 0.0
    return mean / deviation


def adjust_p_values(
    p_values: Sequence[float], method: Literal["holm", "benjamini-hochberg"] = "holm"
) -> list[float]:
    """Return p-values corrected for multiple tests, in the same order.

    `p_values` are those of all tests, significant or not. ``holm`` controls the family-wise error rate,
    ``benjamini-hochberg`` the false discovery rate.
    """
    names = {"holm": "holm", "benjamini-hochberg": "fdr_bh"}
    if method not in names:
        raise InputError("method", method, f"must be one of {', '.join(names)}")
    for p in p_values:
        if not 0 <= p <= 1:
            raise InputError("p_values", p, "must be between 0 and 1")
    if not p_values:
        return []
    _, corrected, _, _ = multipletests(p_values, method=names[method])
    return [float(p) for p in corrected]


def additional_seeds(
    differences: ArrayLike, power: float = 0.8, confidence: float = CONFIDENCE
) -> int | None:
    """Return the number of additional seeds for a test to distinguish the mean difference from 0.

    The test is the two-sided t-test at the level `confidence`; its `power`, 0 … 1, is the probability that it
    rejects a mean of 0. The mean and the standard deviation of `differences`, shape (seeds,), are assumed to
    be the true values. The result is 0 if the seeds suffice, and None if a million seeds are too few.
    """
    values = np.asarray(differences, dtype=np.float64)
    seeds = check_seeds(values, 2)
    check_confidence(confidence)
    if not 0 < power < 1:
        raise InputError("power", power, "must be between 0 and 1")
    size = abs(effect_size(values))
    test = TTestPower()

    def is_enough(count: int) -> bool:
        # The power is NaN for very large effects.
        return not test.power(size, count, 1 - confidence) < power

    # Bisect, because the solver of statsmodels fails for large effects.
    more = bisect_left(range(seeds, _MAX_SEEDS), True, key=is_enough)
    return more if seeds + more < _MAX_SEEDS else None
