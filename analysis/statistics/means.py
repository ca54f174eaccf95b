"""Means over the seeds with their intervals: the numbers of every curve and table."""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from kswarms.analysis.statistics.intervals import fewest_seeds, intervals_of_means
from kswarms.analysis.text_tables import span


def with_intervals(rows: pd.DataFrame, key: Sequence[str], quantity: str) -> pd.DataFrame:
    """Return the mean of a column in each group of rows, with its 95 % interval.

    `rows` has one row for each seed of a group, in any order; the columns `key` identify a group. Missing
    values are left out. The result has one row for each group, sorted: `key`, ``seeds`` (int64), ``mean``,
    ``low``, ``high`` (float64). The bounds are NaN for fewer than six seeds.
    """
    # Sorted by value too, because resamples depend on the order of the seeds.
    ordered = rows.sort_values([*key, quantity])
    groups = ordered.groupby(list(key))[quantity].agg(seeds="count", mean="mean").reset_index()
    values = ordered[quantity].dropna().to_numpy(np.float64)
    seeds = groups["seeds"].to_numpy()
    starts = np.cumsum(seeds) - seeds
    low, high = np.full(len(groups), np.nan), np.full(len(groups), np.nan)
    for count in np.unique(seeds[seeds >= fewest_seeds()]):
        (same,) = np.nonzero(seeds == count)
        samples = values[starts[same, np.newaxis] + np.arange(count)]
        low[same], high[same] = intervals_of_means(samples)
    return groups.assign(low=low, high=high)


def describe_seeds(few: int, many: int) -> str:
    """Return the part of a caption that names the fewest and most seeds of a mean, and its interval."""
    if many == 1:
        return "one seed"
    enough = fewest_seeds()
    where = f" of {enough} seeds or more" if few < enough else ""
    return f"mean of {span(few, many)} seeds" + (f" (95 % interval{where})" if many >= enough else "")
