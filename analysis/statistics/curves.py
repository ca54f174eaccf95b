"""Statistics of curves over the number of robots: where one overtakes another, and whether it rises with N.

A curve is the mean over the seeds at each density, straight lines between densities. Seeds are drawn again
whole, with their values at every density, so samples here have the shape (seeds, densities).
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
    """Where a curve overtakes another one.

    Attributes
    ----------
    crossings : tuple of float
        Every N at which the difference of the mean curves changes its sign, in either direction.
    for_good : Interval
        The N from which on the difference stays above 0 up to the last density. −inf: it is above 0 from the
        first density on. +inf: it is not above 0 at the last one.
    """

    crossings: tuple[float, ...]
    for_good: Interval


def crossings(densities: ArrayLike, differences: ArrayLike) -> tuple[float, ...]:
    """Return where a curve changes its sign, in ascending order.

    Parameters
    ----------
    densities, differences : array_like
        Shape (densities,): N, ascending, and the curve's value there. Between them it is a straight line; a
        stretch of zeros between two signs is crossed in its middle, one between equal signs not at all.
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
    """Say at which N one curve overtakes another, with a bootstrap interval over the seeds.

    Noise lets curves that run together cross often, so the interval is of the last crossing, after which the
    one stays ahead. It exists in every resample, if ±inf counts: no resample is left out.

    Parameters
    ----------
    densities : sequence of int
        N, ascending.
    differences : array_like
        Shape (seeds, densities): the overtaking curve's value less the other's, seed by seed.
    confidence : float
        Level of the interval.

    Raises
    ------
    InputError
        Fewer than two densities, no seed, or shapes that do not fit.
    """
    n, values = _samples(densities, differences)
    return Overtaking(
        crossings(n, values.mean(axis=0)),
        bootstrap_interval(values, lambda samples: _last_rise(n, samples.mean(axis=1)), confidence),
    )


def rank_correlation(
    densities: Sequence[int], samples: ArrayLike, confidence: float = CONFIDENCE
) -> Interval:
    """Return Spearman's rank correlation of a mean curve with N, with a bootstrap interval over the seeds.

    Parameters
    ----------
    densities : sequence of int
        N, ascending.
    samples : array_like
        Shape (seeds, densities).
    confidence : float
        Level of the interval.

    Returns
    -------
    Interval
        −1 … 1; a curve that is level has no ranks and counts as 0.

    Raises
    ------
    InputError
        Fewer than two densities, no seed, or shapes that do not fit.
    """
    _, values = _samples(densities, samples)
    ranks = stats.rankdata(densities)
    ranks -= ranks.mean()

    def statistic(resampled: Values) -> Values:
        of_curve = stats.rankdata(resampled.mean(axis=1), axis=-1)
        of_curve -= of_curve.mean(axis=-1, keepdims=True)
        length = np.sqrt((ranks @ ranks) * (of_curve**2).sum(axis=-1))
        result: Values = np.divide(of_curve @ ranks, length, out=np.zeros_like(length), where=length > 0)
        return result

    return bootstrap_interval(values, statistic, confidence)


def _last_rise(n: Values, curves: Values) -> Values:
    """Return where each curve, shape (resamples, densities), rises above 0 for the last time."""
    above = curves > 0
    # Densities at the end of the curve that are above 0 without a gap.
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
        raise InputError("densities", n.tolist(), "must be two or more that ascend")
    if curve.shape[-1:] != n.shape:
        raise InputError("values", curve.shape, f"must have {n.size} densities along the last axis")
    return n, curve


def _samples(densities: ArrayLike, samples: ArrayLike) -> tuple[Values, Values]:
    n, values = _curve(densities, samples)
    if values.ndim != 2:
        raise InputError("samples", values.shape, "must be of the shape (seeds, densities)")
    return n, values
