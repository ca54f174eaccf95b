"""Bootstrap confidence intervals over seeds, for all figures, tables and findings.

The method, the number of resamples and their random seed are fixed, so that the same results always give the
same interval.
"""

import math
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import special, stats

from kswarms.agents.common.errors import InputError

Values = NDArray[np.float64]
Statistic = Callable[[Values], Values]
"""Maps means over the seeds, shape (resamples, …), to values of shape (resamples,)."""

CONFIDENCE: Final = 0.95
RESAMPLES: Final = 9999
RANDOM_SEED: Final = 0
_BATCH: Final = 2_000_000
"""Maximum number of values in a batch of resamples; it limits memory."""


@dataclass(frozen=True)
class Interval:
    """Value of a statistic for all seeds, and bounds of its confidence interval."""

    estimate: float
    low: float
    high: float


def bootstrap_interval(
    samples: ArrayLike,
    statistic: Statistic = lambda means: means,
    confidence: float = CONFIDENCE,
    smooth: bool = True,
) -> Interval:
    """Return a statistic of the mean over the seeds, with its bootstrap interval.

    The method is BCa (`scipy.stats.bootstrap`), or percentiles where BCa is undefined. Bootstrap intervals of
    few seeds are too narrow. Therefore the level is raised to 2 Φ(√(n / (n − 1)) t) − 1, where t is the
    quantile of Student's distribution with n − 1 degrees of freedom (Hesterberg 2015, "expanded percentile").

    Identical seeds give an interval of width 0. With fewer seeds than `min_seeds`, the bounds are ±inf.

    Parameters
    ----------
    samples : array_like of float
        Shape (seeds, …), at least one seed. All values of a seed are resampled together.
    statistic : callable
        Maps means of shape (resamples, …) to values of shape (resamples,); by default the identity.
    confidence : float
        Level of the interval, 0 … 1.
    smooth : bool
        False for a statistic of ranks: bounds are percentiles, because BCa is not valid. For random ranks,
        95 % intervals by BCa of a rank correlation excluded 0 in a fifth of all samples.
    """
    values = np.asarray(samples, dtype=np.float64)
    seeds = check_seeds(values, 1)

    # SciPy resamples one-dimensional data, so each seed is represented by its index.
    def of_indices(indices: NDArray[np.int64], axis: int = -1) -> Values:
        drawn = values[indices.reshape(-1, indices.shape[-1])]
        return statistic(drawn.mean(axis=1)).reshape(indices.shape[:-1])

    identical = bool((values == values[0]).all())
    all_seeds = values[:1] if identical else values.mean(axis=0)[np.newaxis]
    estimate = float(statistic(all_seeds)[0])
    if seeds < min_seeds(confidence):
        return Interval(estimate, -math.inf, math.inf)
    if identical:
        return Interval(estimate, estimate, estimate)
    size = values[0].size
    low, high = _bounds(np.arange(seeds), of_indices, confidence, "BCa" if smooth else "percentile", size)
    return Interval(estimate, float(low), float(high))


def intervals_of_means(samples: Values) -> tuple[Values, Values]:
    """Return the bounds of the 95 % intervals of many means, as `bootstrap_interval` does for one.

    `samples` has the shape (means, seeds), with at least `min_seeds` seeds.
    """
    # Subtract the first seed, so that means of identical seeds are exact.
    first = samples[:, :1]
    low, high = _bounds(samples - first, np.mean, CONFIDENCE, "BCa", len(samples))
    return first[:, 0] + low, first[:, 0] + high


def _bounds(
    data: NDArray[Any], statistic: Callable[..., Values], confidence: float, method: Any, size: int
) -> tuple[Values, Values]:
    """Return the bounds of the intervals of a statistic; seeds are the last axis of `data`."""
    seeds = data.shape[-1]
    student = special.stdtrit(seeds - 1, (1 + confidence) / 2)
    level = float(2 * special.ndtr(math.sqrt(seeds / (seeds - 1)) * student) - 1)
    with warnings.catch_warnings(), np.errstate(invalid="ignore"):
        # BCa warns where it is undefined; percentiles replace it below.
        warnings.simplefilter("ignore", stats.DegenerateDataWarning)
        warnings.simplefilter("ignore", RuntimeWarning)
        result = stats.bootstrap(
            (data,),
            statistic,
            axis=-1,
            vectorized=True,
            n_resamples=RESAMPLES,
            batch=max(1, _BATCH // (size * seeds)),
            confidence_level=level,
            method=method,
            rng=np.random.default_rng(RANDOM_SEED),
        )
    low, high = (np.asarray(bound, dtype=np.float64) for bound in result.confidence_interval)
    # "inverted_cdf" does not interpolate, because values may be infinite.
    tails = np.quantile(
        result.bootstrap_distribution, [(1 - level) / 2, (1 + level) / 2], axis=-1, method="inverted_cdf"
    )
    undefined = np.isnan(low) | np.isnan(high)
    return np.where(undefined, tails[0], low), np.where(undefined, tails[1], high)


def min_seeds(confidence: float = CONFIDENCE) -> int:
    """Return the minimum number of seeds for a distribution-free interval of this level.

    A bootstrap interval of a mean lies within the range of the values. All n values are on one side of the
    median with probability 2^(1 − n), which must not exceed 1 − confidence: six seeds for 95 %.
    """
    check_confidence(confidence)
    return math.ceil(1 - math.log2(1 - confidence))


def check_seeds(samples: Values, minimum: int) -> int:
    """Return the number of seeds of samples, shape (seeds, …); `InputError` if below `minimum`."""
    if len(samples) < minimum:
        raise InputError("seeds", len(samples), f"must be at least {minimum}")
    return len(samples)


def check_confidence(confidence: float) -> None:
    """Raise `InputError` unless the level is between 0 and 1."""
    if not 0 < confidence < 1:
        raise InputError("confidence", confidence, "must be between 0 and 1")
