"""Statistics of curves over the number of robots: crossings and trend.

A curve is the mean over the seeds at each density, linear between densities. Samples have the shape (seeds,
densities); resampling draws seeds with their values at all densities.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike
from scipy import stats

from kswarms.agents.common.errors import InputError
from kswarms.analysis.statistics.intervals import CONFIDENCE, Interval, Values, bootstrap_interval


@dataclass(frozen=True)
class Overtaking:
    """Crossings of two curves, and the last of them.

    Attributes
    ----------
    crossings : tuple of float
        Each N where the difference of the mean curves changes sign, in either direction.
    last_crossing : Interval
        N from which the difference is above 0 up to the last density; −inf if it is above 0 at every density,
        +inf if it is not above 0 at the last density.
    """

    crossings: tuple[float, ...]
    last_crossing: Interval


def crossings(densities: ArrayLike, differences: ArrayLike) -> tuple[float, ...]:
    """Return each N where a curve changes sign, in ascending order.

    Both arguments have the shape (densities,): ascending N, and the values of the curve. Zeros between
    different signs are one crossing in their middle; zeros between equal signs are no crossing.
    """
    n, values = _curve(densities, differences)
    (nonzero,) = np.nonzero(values)
    found = []
    for left, right in pairwise(nonzero):
        if values[left] * values[right] < 0:
            if right - left > 1:
                found.append((n[left + 1] + n[right - 1]) / 2)
            else:
                weight = values[left] / (values[left] - values[right])
                found.append(n[left] + weight * (n[right] - n[left]))
    return tuple(map(float, found))


def overtaking(
    densities: Sequence[int], differences: ArrayLike, confidence: float = CONFIDENCE
) -> Overtaking:
    """Return where one curve overtakes another, with an interval over the seeds.

    `differences`, shape (seeds, densities), are first curve − second curve at two or more ascending
    `densities`. Similar curves cross often because of noise, so the interval is that of the last crossing,
    after which the first curve stays ahead. Resamples without such a crossing count as ±inf.
    """
    n, values = _samples(densities, differences)
    last = bootstrap_interval(values, lambda means: last_rise(n, means), confidence)
    return Overtaking(crossings(n, values.mean(axis=0)), last)


def rank_correlation_with_n(
    densities: Sequence[int], samples: ArrayLike, confidence: float = CONFIDENCE
) -> Interval:
    """Return Spearman's rank correlation of a mean curve with N, with its interval; 0 for a constant curve.

    `samples`, shape (seeds, densities), are the values of the curve.
    """
    n, values = _samples(densities, samples)
    return bootstrap_interval(
        values, lambda means: np.nan_to_num(spearman(means, n)), confidence, smooth=False
    )


def spearman(first: Values, second: Values) -> Values:
    """Return Spearman's rank correlation along the last axis, NaN where either is constant."""
    ranks, others = (stats.rankdata(values, axis=-1) for values in (first, second))
    ranks -= ranks.mean(axis=-1, keepdims=True)
    others -= others.mean(axis=-1, keepdims=True)
    length = np.sqrt((ranks**2).sum(axis=-1) * (others**2).sum(axis=-1))
    products: Values = (ranks * others).sum(axis=-1)
    correlation: Values = np.divide(products, length, out=np.full_like(length, np.nan), where=length > 0)
    return correlation


def last_rise(n: Values, curves: Values) -> Values:
    """Return the N where each curve last rises above 0; `curves` has the shape (resamples, densities)."""
    above = curves > 0
    # Number of consecutive densities above 0 at the end of each curve.
    ahead = np.cumprod(above[:, ::-1], axis=1).sum(axis=1)
    rows = np.arange(len(curves))
    right = np.clip(len(n) - ahead, 1, len(n) - 1)
    low, high = curves[rows, right - 1], curves[rows, right]
    rise = high - low
    weight = np.divide(-low, rise, out=np.zeros_like(rise), where=rise != 0)
    at: Values = n[right - 1] + weight * (n[right] - n[right - 1])
    at[ahead == 0] = np.inf
    at[ahead == len(n)] = -np.inf
    return at


def _curve(densities: ArrayLike, values: ArrayLike) -> tuple[Values, Values]:
    n, curve = np.asarray(densities, dtype=np.float64), np.asarray(values, dtype=np.float64)
    if n.ndim != 1 or n.size < 2 or (np.diff(n) <= 0).any():
        raise InputError("densities", n.tolist(), "must be two or more, in ascending order")
    if curve.shape[-1:] != n.shape:
        raise InputError("values", curve.shape, f"must have {n.size} densities along the last axis")
    return n, curve


def _samples(densities: ArrayLike, samples: ArrayLike) -> tuple[Values, Values]:
    n, values = _curve(densities, samples)
    if values.ndim != 2:
        raise InputError("samples", values.shape, "must have the shape (seeds, densities)")
    return n, values
