"""Means over the seeds with bootstrap intervals: the numbers behind every curve and every table of one.

The interval is the percentile bootstrap's (`scipy.stats.bootstrap`): the seeds of a point are drawn anew,
with replacement, and the mean taken, a thousand times; its level is raised for few seeds as that of the
findings (`bootstrap_interval`, which draws ten times as often, for a verdict hangs on it).
"""

from collections.abc import Sequence

import numpy as np
import pandas as pd
from scipy import stats

from kswarms.analysis.statistics.intervals import CONFIDENCE, expanded

_RESAMPLES = 1000
_BOOTSTRAP_SEED = 0

CURVE = ("condition", "swarm")
"""Columns that tell the curves of a scenario apart."""


def summary(rows: pd.DataFrame, quantity: str, by: Sequence[str] = CURVE) -> pd.DataFrame:
    """Summarise a quantity at each density of each curve.

    Parameters
    ----------
    rows : pandas.DataFrame
        One row for each seed, with the columns `by`, ``n`` and `quantity`.
    quantity : str
        Column to take the mean of.
    by : sequence of str
        Columns that tell the curves apart.

    Returns
    -------
    pandas.DataFrame
        One row for each curve and density, sorted by `by` and ``n``: these columns, and ``seeds`` (int64),
        ``mean``, ``low``, ``high`` (float64, unit of the quantity): the 95 % bootstrap interval of the mean,
        NaN where there is one seed. It depends on the rows alone, not on their order.
    """
    key = [*by, "n"]
    # Sorted by value too: the bootstrap then does not depend on the order of rows.
    ordered = rows.sort_values([*key, quantity])
    points = ordered.groupby(key)[quantity].agg(seeds="size", mean="mean").reset_index()
    values = ordered[quantity].to_numpy(np.float64)
    seeds = points["seeds"].to_numpy()
    starts = np.cumsum(seeds) - seeds
    low, high = np.full(len(points), np.nan), np.full(len(points), np.nan)
    for count in np.unique(seeds[seeds > 1]):
        # Points of as many seeds each share a call: the draws cost more than the means.
        these = np.flatnonzero(seeds == count)
        low[these], high[these] = _intervals(values[starts[these, None] + np.arange(count)])
    return points.assign(low=low, high=high)


def _intervals(samples: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the ends of the intervals of the means of samples, shape (points, seeds)."""
    interval = stats.bootstrap(
        (samples,),
        np.mean,
        axis=1,
        n_resamples=_RESAMPLES,
        confidence_level=expanded(CONFIDENCE, samples.shape[1]),
        method="percentile",
        batch=100,  # at most 100 × points × seeds numbers in memory
        rng=np.random.default_rng(_BOOTSTRAP_SEED),
    ).confidence_interval
    return np.asarray(interval.low), np.asarray(interval.high)
