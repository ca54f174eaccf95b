"""Means over the seeds with intervals, for curves and tables."""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from kswarms.analysis.statistics.intervals import intervals_of_means, min_seeds
from kswarms.analysis.text_tables import span


def mean_by_group(rows: pd.DataFrame, key: Sequence[str], quantity: str) -> pd.DataFrame:
    """Return the mean of a column in each group of rows, with its 95 % interval.

    `rows` has one row for each group and seed, in any order; the columns `key` identify a group. Missing
    values are skipped. The result has one row for each group, sorted by `key`, with the columns `key`,
    ``seeds`` (int64), ``mean``, ``low`` and ``high`` (float64). Bounds are NaN for fewer than six seeds.
    """
    # Sort by value too: resamples depend on the order of the seeds.
    ordered = rows.sort_values([*key, quantity])
    groups = ordered.groupby(list(key))[quantity].agg(seeds="count", mean="mean").reset_index()
    values = ordered[quantity].dropna().to_numpy(np.float64)
    seeds = groups["seeds"].to_numpy()
    starts = np.cumsum(seeds) - seeds
    low, high = np.full(len(groups), np.nan), np.full(len(groups), np.nan)
    for count in np.unique(seeds[seeds >= min_seeds()]):
        (same,) = np.nonzero(seeds == count)
        samples = values[starts[same, np.newaxis] + np.arange(count)]
        low[same], high[same] = intervals_of_means(samples)
    return groups.assign(low=low, high=high)


def describe_seeds(low: int, high: int) -> str:
    """Return caption text for means of `low` to `high` seeds and their intervals."""
    if high == 1:
        return "one seed"
    enough = min_seeds()
    where = f" of {enough} seeds or more" if low < enough else ""
    return f"mean of {span(low, high)} seeds" + (f" (95 % interval{where})" if high >= enough else "")
