"""Judging claims about learned policies: shares of robots, and agreement with published tables."""

import math
from collections.abc import Sequence

import numpy as np
import pandas as pd
from scipy import stats

from kswarms.agents.common.errors import InputError
from kswarms.analysis.findings.claims import Agreement, Share
from kswarms.analysis.findings.data import ClaimData, NoDataError, format_densities, sizes
from kswarms.analysis.findings.judges.evidence import too_few_note
from kswarms.analysis.findings.verdicts import Outcome, Region
from kswarms.analysis.results.published import published_cells
from kswarms.analysis.statistics.intervals import Interval, Values, bootstrap_interval


def judge_share(claim: Share, data: ClaimData, confidence: float) -> Outcome:
    """Judge a share of all robots by an interval that covers two intervals.

    Robots of one game are not independent, so the first interval resamples games. It has width 0 if all
    robots learned the same action; the second interval is the exact binomial interval over the robots.
    """
    (shares,) = data.complete()
    robots = sizes(data.results, claim.quantity).reindex_like(shares)
    if robots.isna().any(axis=None):
        raise InputError("runs", claim.quantity.scenario, "must have the games of all policies")
    counts = np.stack([shares / 100 * robots, robots], axis=-1)

    def pooled(means: Values) -> Values:
        sums: Values = means.sum(axis=1)
        return 100 * sums[:, 0] / sums[:, 1]

    by_game = bootstrap_interval(counts, pooled, confidence)
    learned, total = (round(float(count)) for count in counts.sum(axis=(0, 1)))
    by_robot = stats.binomtest(learned, total).proportion_ci(confidence, method="exact")
    low, high = min(by_game.low, 100 * by_robot.low), max(by_game.high, 100 * by_robot.high)
    interval = Interval(by_game.estimate, low, high)
    verdict = Region(claim.above, math.inf, closed=False).verdict(interval)
    notes = [*data.notes, f"{learned} of {total} robots", too_few_note(len(counts), confidence)]
    return Outcome(verdict, interval, claim.quantity.unit, len(counts), notes)


def judge_agreement(claim: Agreement, data: ClaimData, confidence: float) -> Outcome:
    """Judge the mean absolute error of the cells of a published table."""
    published = cells_of(claim, data.densities)
    if np.isnan(published).all():
        raise NoDataError(f"nothing published at {format_densities(data.densities)}")
    values = np.stack([table.to_numpy() for table in data.complete()], axis=-1)

    def mean_absolute_error(means: Values) -> Values:
        return np.asarray(np.nanmean(np.abs(means - published), axis=(1, 2)), dtype=np.float64)

    interval = bootstrap_interval(values, mean_absolute_error, confidence)
    verdict = Region(-math.inf, claim.margin).verdict(interval)
    notes = [*data.notes, f"{np.isfinite(published).sum()} cells", too_few_note(len(values), confidence)]
    return Outcome(verdict, interval, claim.cells[0].unit_of_difference, len(values), notes)


def cells_of(claim: Agreement, densities: Sequence[int]) -> Values:
    """Return the published cells, shape (densities, columns), NaN where there is none."""
    table = published_cells()
    columns = []
    for cell in claim.cells:
        keys = [(cell.scenario, cell.condition, cell.swarm, cell.measure, n) for n in densities]
        columns.append(table.reindex(pd.MultiIndex.from_tuples(keys)).to_numpy(dtype=np.float64))
    return np.stack(columns, axis=-1)
