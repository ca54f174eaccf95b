"""Bootstrap confidence intervals over seeds: the one kind of interval of figures, tables and findings.

Every statistic here is a function of the mean over the seeds. The mean of a resample is a weighted mean of
the seeds, so one product of two arrays gives all resamples.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import special

from kswarms.agents.common.errors import InputError

Values = NDArray[np.float64]
Statistic = Callable[[Values], Values]
"""Maps means over the seeds, shape (resamples, …), to values of shape (resamples, …)."""

CONFIDENCE: Final = 0.95
RESAMPLES: Final = 9999
# Fixed, so that the same results always give the same interval.
RANDOM_SEED: Final = 0


@dataclass(frozen=True)
class Interval:
    """The value of a statistic for all seeds, and the bounds of its confidence interval."""

    estimate: float
    low: float
    high: float


def mean_itself(means: Values) -> Values:
    """Return the means: the default statistic."""
    return means


def bootstrap_interval(
    samples: ArrayLike,
    statistic: Statistic = mean_itself,
    confidence: float = CONFIDENCE,
    smooth: bool = True,
) -> Interval:
    """Return one statistic with its interval; see `bootstrap_intervals`."""
    estimate, low, high = bootstrap_intervals(samples, statistic, confidence, smooth)
    return Interval(float(estimate), float(low), float(high))


def bootstrap_intervals(
    samples: ArrayLike,
    statistic: Statistic = mean_itself,
    confidence: float = CONFIDENCE,
    smooth: bool = True,
) -> tuple[Values, Values, Values]:
    """Return statistics of the mean over the seeds, with bootstrap intervals.

    The method is BCa (bias-corrected and accelerated), or percentiles where BCa is undefined. Bootstrap
    intervals of few seeds are too narrow, so each tail is Φ(−√(n / (n − 1)) t), where t is the quantile of
    Student's distribution with n − 1 degrees of freedom (Hesterberg 2015, "expanded percentile").

    Parameters
    ----------
    samples : array_like
        Shape (seeds, …). All values of a seed are resampled together.
    statistic : callable
        Maps means of shape (resamples, …) to values of shape (resamples, …); the default is the mean itself.
    confidence : float
        Level of the intervals, 0 … 1.
    smooth : bool
        False for a statistic of ranks. BCa is not valid for it: where all ranks are chance, intervals of 95 %
        for a rank correlation excluded 0 in a fifth of all samples. Its bounds are percentiles.

    Returns
    -------
    estimate, low, high : ndarray of float64
        The statistic of all seeds and its bounds. Identical seeds give an interval of width 0. With fewer
        seeds than `fewest_seeds`, the bounds are −inf and inf. Both are NaN where the statistic is NaN in any
        resample.
    """
    values = np.asarray(samples, dtype=np.float64)
    seeds = check_seeds(values, 1)

    # Relative to the first seed, so that means of identical seeds are exact.
    offsets = (values - values[0]).reshape(seeds, -1)

    def of_means(counts: Values, total: int) -> Values:
        # einsum, not BLAS: its threads wait for each other on a busy machine.
        means = np.einsum("sv,sr->vr", offsets, counts).T.reshape(-1, *values.shape[1:])
        return np.moveaxis(statistic(values[0] + means / total), 0, -1)

    estimate = of_means(np.ones((seeds, 1)), seeds)[..., 0]
    if seeds < fewest_seeds(confidence):
        return estimate, np.full_like(estimate, -np.inf), np.full_like(estimate, np.inf)
    resampled = np.sort(of_means(_seed_counts(seeds), seeds))
    student = float(special.stdtrit(seeds - 1, (1 + confidence) / 2))
    reach = math.sqrt(seeds / (seeds - 1)) * student
    if not smooth:
        undefined = np.full_like(estimate, np.nan)
        low, high = (_quantile(resampled, undefined, z) for z in (-reach, reach))
        return estimate, low, high
    with np.errstate(invalid="ignore", divide="ignore"):
        below, up_to = (
            np.count_nonzero(compare(resampled, estimate[..., np.newaxis]), axis=-1)
            for compare in (np.less, np.less_equal)
        )
        bias = special.ndtri((below + up_to) / (2 * RESAMPLES))
        one_left_out = of_means(1 - np.eye(seeds), seeds - 1)
        gaps = one_left_out.mean(axis=-1, keepdims=True) - one_left_out
        acceleration = (gaps**3).sum(axis=-1) / (6 * (gaps**2).sum(axis=-1) ** 1.5)
    low, high = (_quantile(resampled, _level(bias, acceleration, z), z) for z in (-reach, reach))
    return estimate, low, high


def fewest_seeds(confidence: float = CONFIDENCE) -> int:
    """Return the minimum number of seeds for a distribution-free interval of this level.

    A bootstrap interval of a mean lies within the sampled values. All n values lie on one side of the median
    with probability 2^(1 − n), which must not exceed 1 − confidence: six seeds for 95 %.
    """
    check_confidence(confidence)
    return math.ceil(1 - math.log2(1 - confidence))


def check_seeds(samples: Values, fewest: int) -> int:
    """Return the number of seeds of samples, shape (seeds, …), which must be at least `fewest`."""
    if len(samples) < fewest:
        raise InputError("seeds", len(samples), f"must be at least {fewest}")
    return len(samples)


def check_confidence(confidence: float) -> None:
    """Require a level between 0 and 1."""
    if not 0 < confidence < 1:
        raise InputError("confidence", confidence, "must be between 0 and 1")


@lru_cache(maxsize=4)
def _seed_counts(seeds: int) -> Values:
    """Return how often each seed is in each resample, shape (seeds, RESAMPLES)."""
    counts = np.random.default_rng(RANDOM_SEED).multinomial(seeds, np.full(seeds, 1 / seeds), size=RESAMPLES)
    return np.ascontiguousarray(counts.T, dtype=np.float64)


def _level(bias: Values, acceleration: Values, z: float) -> Values:
    """Return the quantile level that BCa uses for a normal quantile `z`; NaN where BCa is undefined."""
    with np.errstate(invalid="ignore"):
        shrink = 1 - acceleration * (bias + z)
        level = special.ndtr(bias + (bias + z) / shrink)
    return np.where(np.isfinite(bias) & (shrink > 0), level, np.nan)


def _quantile(ordered: Values, level: Values, z: float) -> Values:
    """Return quantiles along the sorted last axis, at the level of `z` where `level` is NaN."""
    level = np.where(np.isnan(level), special.ndtr(z), level)
    # A sampled value, never a value between two: these may be infinite.
    index = np.clip(np.ceil(level * RESAMPLES).astype(int) - 1, 0, RESAMPLES - 1)
    found = np.take_along_axis(ordered, index[..., np.newaxis], axis=-1)[..., 0]
    # NaNs are sorted last.
    return np.where(np.isnan(ordered[..., -1]), np.nan, found)
