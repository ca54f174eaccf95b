"""How far results are from what a claim states, as one number for calibration."""

import numpy as np

from kswarms.analysis.findings.claims import Agreement, Claim, Compare, Overtake, Peak, Share, Trend
from kswarms.analysis.findings.data import ClaimData, difference
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
    densities = np.asarray(data.densities, dtype=np.float64)
    means = [table.to_numpy(dtype=np.float64).mean(axis=0) for table in data.complete()]
    match claim:
        case Agreement():
            errors = np.stack(means, axis=-1) - cells_of(claim, data.densities)
            return float(np.nanmean(np.abs(errors)))
        case Compare():
            values = difference(data.complete()).mean(axis=0)
            over = {"each N": values, "mean over N": [values.mean()], "sum over N": [values.sum()]}
            return max(region_of(claim).distance(float(value)) for value in over[claim.over])
        case Overtake():
            at = last_rise(densities, (means[0] - means[1])[None])[0]
            return Region(*claim.between).distance(float(np.clip(at, densities[0], densities[-1])))
        case Peak():
            return max(0.0, -_height(means[0]))
        case Trend():
            return max(0.0, claim.above - float(np.nan_to_num(spearman(means[0], densities))))
        case Share():
            return max(0.0, claim.above - float(means[0].mean()))


def _height(curve: Values) -> float:
    """Return how far a curve is at some inner density above the higher one of its ends."""
    return float(curve[1:-1].max() - max(curve[0], curve[-1]))
