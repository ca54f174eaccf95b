"""Means over the seeds with their intervals: the numbers of every curve and table."""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from kswarms.analysis.statistics.intervals import fewest_seeds, intervals_of_means
from kswarms.analysis.text_tables import span

CURVE = ("condition", "swarm")
"""Columns that identify a curve of a scenario."""


def mean_by_n(rows: pd.DataFrame, quantity: str, by: Sequence[str] = CURVE) -> pd.DataFrame:
    """Return the mean of a quantity at each density of each curve.

    `rows` has one row for each seed; the columns `by` identify a curve. The result is that of
    `with_intervals` for the groups of `by` and ``n``.
    """
    return with_intervals(rows, [*by, "n"], quantity)


def with_intervals(rows: pd.DataFrame, key: Sequence[str], quantity: str) -> pd.DataFrame:
    """Return the mean of a column in each group of rows, with its 95 % interval.

    Parameters
    ----------
    rows : pandas.DataFrame
        One row for each seed of a group.
    key : sequence of str
        Columns that identify a group.
    quantity : str
        Column to average; missing values are left out.

    Returns
    -------
    pandas.DataFrame
        One row for each group, sorted: `key`, ``seeds`` (int64), ``mean``, ``low``, ``high`` (float64). The
        bounds are NaN for fewer than six seeds. The order of `rows` does not matter.
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
