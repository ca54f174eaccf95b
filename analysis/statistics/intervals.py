"""Statistics over seeds: intervals, paired comparisons, correction for many of them, seeds still needed.

SciPy and statsmodels do the statistics. What is fixed here is the unit, one value for each seed; the number
of resamples and their random numbers, so that the same results give the same interval; and what is said of
data that a method has no answer for.
"""

import math
import warnings
from bisect import bisect_left
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import stats
from statsmodels.stats.multitest import multipletests
from statsmodels.stats.power import TTestPower

from kswarms.agents.common.errors import InputError

Values = NDArray[np.float64]
Statistic = Callable[[Values], Values]
"""Maps samples of shape (resamples, seeds, …) to one number for each resample, shape (resamples,)."""

CONFIDENCE: Final = 0.95
RESAMPLES: Final = 9999
# Fixed: a verdict must not change when it is asked for twice.
_RANDOM_SEED: Final = 0
# Numbers resampled at a time: 200 seeds at ten densities stay below 20 MB.
_BATCH: Final = 2_000_000
_MOST_SEEDS: Final = 1_000_000


@dataclass(frozen=True)
class Interval:
    """A number estimated from seeds, and between which bounds it lies.

    Attributes
    ----------
    estimate : float
        From all seeds.
    low, high : float
        Bounds of the confidence interval, in the unit of the estimate.
    """

    estimate: float
    low: float
    high: float


@dataclass(frozen=True)
class PairedComparison:
    """Two samples on common seeds.

    Attributes
    ----------
    difference : Interval
        Mean of first − second, in their unit.
    d_z : float
        Cohen's d_z, the mean of the differences by their standard deviation; ±inf where every seed has the
        same difference, 0 where it is 0.
    cliffs_delta : float
        Odds that a value of the first is larger than one of the second, less those of the reverse: −1 … 1.
    p_value : float
        Two-sided, of the permutation test that exchanges the two values of a seed; exact up to 13 seeds.
    seeds : int
        Pairs.
    """

    difference: Interval
    d_z: float
    cliffs_delta: float
    p_value: float
    seeds: int


def mean_over_seeds(samples: Values) -> Values:
    """Return the mean of each resample: the statistic unless another is asked for."""
    means: Values = samples.mean(axis=1)
    return means


def bootstrap_interval(
    samples: ArrayLike, statistic: Statistic = mean_over_seeds, confidence: float = CONFIDENCE
) -> Interval:
    """Return a statistic of seeds with its bootstrap interval: seeds are drawn again, with replacement.

    The method is BCa (`scipy.stats.bootstrap`), or percentiles where BCa has no answer, for one seed left out
    changes nothing or a resample is infinite. As a bootstrap of few seeds is too narrow, its level is raised
    to 2Φ(√(n / (n − 1)) t) − 1, t being the quantile of Student's law with n − 1 degrees of freedom
    (Hesterberg 2015, "expanded percentile"). Seeds that are all alike give an interval of no width; too few
    for the level (`fewest_seeds`) give one without bounds, −inf … inf.

    Parameters
    ----------
    samples : array_like
        Shape (seeds, …): what belongs to one seed is drawn together.
    statistic : callable
        Maps (resamples, seeds, …) to (resamples,).
    confidence : float
        Level of the interval, 0 … 1.

    Raises
    ------
    InputError
        There is no seed, or the confidence is none.
    """
    values = np.asarray(samples, dtype=np.float64)
    _at_least(1, len(values))
    estimate = float(statistic(values[np.newaxis])[0])
    if len(values) < fewest_seeds(confidence):
        return Interval(estimate, -math.inf, math.inf)
    if (values == values[0]).all():
        return Interval(estimate, estimate, estimate)

    # SciPy resamples lists of numbers, so seeds go by their place; its `axis` is always the last.
    def of_seeds(chosen: NDArray[np.int64], axis: int = -1) -> Values:
        resampled = chosen.reshape(-1, chosen.shape[-1])
        return statistic(values[resampled]).reshape(chosen.shape[:-1])

    level = expanded(confidence, len(values))
    with warnings.catch_warnings(), np.errstate(invalid="ignore"):
        # Where BCa has no answer; what is done about it stands below.
        warnings.simplefilter("ignore", stats.DegenerateDataWarning)
        warnings.simplefilter("ignore", RuntimeWarning)
        result = stats.bootstrap(
            (np.arange(len(values)),),
            of_seeds,
            n_resamples=RESAMPLES,
            batch=max(1, _BATCH // values.size),
            vectorized=True,
            confidence_level=level,
            method="BCa",
            rng=np.random.default_rng(_RANDOM_SEED),
        )
    bounds = result.confidence_interval
    if math.isnan(bounds.low) or math.isnan(bounds.high):
        tail = (1 - level) / 2
        # A value that was drawn, not one between two: these may be infinite.
        low, high = np.quantile(result.bootstrap_distribution, [tail, 1 - tail], method="inverted_cdf")
        return Interval(estimate, float(low), float(high))
    return Interval(estimate, float(bounds.low), float(bounds.high))


def fewest_seeds(confidence: float = CONFIDENCE) -> int:
    """Return from how many seeds on an interval that assumes no law can have this level.

    A bootstrap interval of a mean lies within the values drawn. All n of them fall on one side of a median
    with odds of 2^(1 − n), which must not exceed 1 − confidence: six seeds for 95 %.
    """
    _check_confidence(confidence)
    return math.ceil(1 - math.log2(1 - confidence))


def compare_paired(first: ArrayLike, second: ArrayLike, confidence: float = CONFIDENCE) -> PairedComparison:
    """Compare two samples of the same seeds, seed by seed.

    Parameters
    ----------
    first, second : array_like
        Shape (seeds,), in the same order of seeds.
    confidence : float
        Level of the difference's interval.

    Raises
    ------
    InputError
        The samples are of different lengths or hold fewer than two seeds.
    """
    one, other = np.asarray(first, dtype=np.float64), np.asarray(second, dtype=np.float64)
    if one.ndim != 1 or one.shape != other.shape:
        raise InputError("second", other.shape, f"must have the shape {one.shape}, one value for each seed")
    _at_least(2, one.size)
    difference = bootstrap_interval(one - other, confidence=confidence)
    test = stats.permutation_test(
        (one, other),
        lambda x, y, axis: np.mean(x - y, axis=axis),
        permutation_type="samples",
        vectorized=True,
        n_resamples=RESAMPLES,
        rng=np.random.default_rng(_RANDOM_SEED),
    )
    larger = stats.mannwhitneyu(one, other).statistic / one.size**2
    return PairedComparison(
        difference=difference,
        d_z=effect_size(one - other),
        cliffs_delta=float(2 * larger - 1),
        p_value=float(test.pvalue),
        seeds=one.size,
    )


def effect_size(differences: ArrayLike) -> float:
    """Return Cohen's d_z of paired differences; ±inf where all are the same, 0 where all are 0."""
    values = np.asarray(differences, dtype=np.float64)
    mean, deviation = float(values.mean()), float(values.std(ddof=1))
    if (values == values[0]).all():
        return math.copysign(math.inf, mean) if mean else 0.0
    return mean / deviation


def adjusted(
    p_values: Sequence[float], method: Literal["holm", "benjamini-hochberg"] = "holm"
) -> list[float]:
    """Correct p-values for their number.

    Parameters
    ----------
    p_values : sequence of float
        Of all comparisons that were made, not only of those that came out.
    method : str
        ``holm`` bounds the odds of any false finding, ``benjamini-hochberg`` the expected share of false
        ones among those found.

    Returns
    -------
    list of float
        In the same order; each is to be compared with the level for all.

    Raises
    ------
    InputError
        A p-value is none, or the method is unknown.
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


def more_seeds(differences: ArrayLike, power: float = 0.8, confidence: float = CONFIDENCE) -> int | None:
    """Return how many seeds more would tell the mean of differences from 0, if it is what it seems.

    Parameters
    ----------
    differences : array_like
        Shape (seeds,).
    power : float
        Odds of telling it, 0 … 1.
    confidence : float
        Level of the two-sided test (Student's t, statsmodels' `TTestPower`).

    Returns
    -------
    int or None
        0 if there are enough; None where a million would not do.

    Raises
    ------
    InputError
        There are fewer than two seeds, or a power or confidence that is none.
    """
    values = np.asarray(differences, dtype=np.float64)
    _at_least(2, len(values))
    _check_confidence(confidence)
    if not 0 < power < 1:
        raise InputError("power", power, "must be between 0 and 1")
    size = abs(effect_size(values))
    law = TTestPower()

    def enough(seeds: int) -> bool:
        # NaN where the effect is so large that the law has no number for it.
        return not law.power(size, seeds, 1 - confidence) < power

    # statsmodels' own search stops without an answer at large effects.
    more = bisect_left(range(len(values), _MOST_SEEDS), True, key=enough)
    return more if len(values) + more < _MOST_SEEDS else None


def student_reach(deviation: ArrayLike, seeds: ArrayLike) -> Values:
    """Return half the width of Student's interval of means at the level `CONFIDENCE`, NaN for one seed.

    Parameters
    ----------
    deviation : array_like
        Standard error of each mean.
    seeds : array_like
        What each is the mean of.
    """
    reach: Values = stats.t.ppf(0.5 + CONFIDENCE / 2, np.asarray(seeds) - 1) * np.asarray(deviation)
    return reach


def expanded(confidence: float, seeds: int) -> float:
    """Return the level at which percentiles of the resampled mean of a few seeds keep a confidence.

    Bootstrap intervals of few seeds are too narrow (Hesterberg 2015, "expanded percentile").
    """
    quantile = stats.t.ppf((1 + confidence) / 2, seeds - 1)
    return float(2 * stats.norm.cdf(math.sqrt(seeds / (seeds - 1)) * quantile) - 1)


def _at_least(fewest: int, seeds: int) -> None:
    if seeds < fewest:
        raise InputError("seeds", seeds, f"must be at least {fewest}")


def _check_confidence(confidence: float) -> None:
    if not 0 < confidence < 1:
        raise InputError("confidence", confidence, "must be between 0 and 1")
