"""How far results are from what a claim states, as one number for calibration."""

from collections.abc import Sequence

import numpy as np

from kswarms.analysis.findings.claims import Agreement, Claim, Compare, Overtake, Peak, Share, Trend
from kswarms.analysis.findings.data import ClaimData
from kswarms.analysis.findings.judges.comparing import region_of
from kswarms.analysis.findings.judges.learned_claims import cells_of
from kswarms.analysis.findings.verdicts import Region
from kswarms.analysis.results.runs import Results
from kswarms.analysis.statistics.curves import last_rise, spearman
from kswarms.analysis.statistics.intervals import Values


def discrepancy(claim: Claim, results: Results) -> float:
    """Return how far the means over the seeds are from a claim, in the unit of the claim.

    For `Agreement` it is the mean absolute error. For other claims it is the distance from the region in
    which the claim is true, 0 inside. `NoDataError` if games are missing.
    """
    data = ClaimData(claim, results)
    return float(discrepancy_of_means(claim, data.densities, means_of(data)[None])[0])


def means_of(data: ClaimData) -> Values:
    """Return the means over the seeds, shape (quantities, densities)."""
    return np.stack([table.to_numpy(dtype=np.float64).mean(axis=0) for table in data.complete()])


def discrepancy_of_means(claim: Claim, densities: Sequence[int], means: Values) -> Values:
    """Return the discrepancy of several sets of means, shape (sets, quantities, densities)."""
    n = np.asarray(densities, dtype=np.float64)
    match claim:
        case Agreement():
            errors = np.abs(means - cells_of(claim, densities).T)
            found = np.nanmean(errors, axis=(1, 2))
        case Compare():
            values = means[:, 0] - means[:, 1] if means.shape[1] > 1 else means[:, 0]
            over = {"each N": values, "mean over N": values.mean(axis=1), "sum over N": values.sum(axis=1)}
            off = region_of(claim).distance(over[claim.over])
            found = off.max(axis=1) if off.ndim > 1 else off
        case Overtake():
            at = last_rise(n, means[:, 0] - means[:, 1])
            found = Region(*claim.between).distance(np.clip(at, n[0], n[-1]))
        case Peak():
            found = np.maximum(0.0, -_height(means[:, 0]))
        case Trend():
            n = np.broadcast_to(n, means[:, 0].shape)
            found = np.maximum(0.0, claim.above - np.nan_to_num(spearman(means[:, 0], n)))
        case Share():
            found = np.maximum(0.0, claim.above - means[:, 0].mean(axis=1))
    return np.asarray(found, dtype=np.float64)


def _height(curves: Values) -> Values:
    """Return how far each curve is at some inner density above the higher one of its ends."""
    height: Values = curves[:, 1:-1].max(axis=1) - np.maximum(curves[:, 0], curves[:, -1])
    return height
