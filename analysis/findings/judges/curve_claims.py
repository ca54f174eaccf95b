"""Judging claims about curves over N: overtaking, rise and fall, trend."""

import math

from kswarms.analysis.findings.claims import Overtake, Peak, Trend
from kswarms.analysis.findings.data import ClaimData, NoDataError, difference, format_densities
from kswarms.analysis.findings.judges.evidence import joint_level, too_few_note
from kswarms.analysis.findings.verdicts import FAILS, HOLDS, UNDECIDED, Outcome, Region
from kswarms.analysis.statistics.curves import overtaking, rank_correlation_with_n
from kswarms.analysis.statistics.intervals import Interval, bootstrap_interval


def judge_overtaking(claim: Overtake, data: ClaimData, confidence: float) -> Outcome:
    """Judge where one curve overtakes another and stays ahead."""
    absent = [n for n in claim.between if n not in data.densities]
    if absent:
        raise NoDataError(f"no runs at {format_densities(absent)}")
    differences = difference(data.complete())
    found = overtaking(data.densities, differences, confidence)
    if few := too_few_note(len(differences), confidence):
        verdict, doubts = UNDECIDED, [few]
    else:
        verdict = Region(*claim.between).verdict(found.last_crossing)
        first, *_, last = data.densities
        doubts = [f"possibly ahead from N = {first} on"] if found.last_crossing.low == -math.inf else []
        doubts += [f"possibly not ahead at N = {last}"] if found.last_crossing.high == math.inf else []
    at = ", ".join(f"{n:.1f}" for n in found.crossings)
    crossed = f"the mean curves cross at N = {at}" if at else "the mean curves do not cross"
    return Outcome(verdict, found.last_crossing, "robots", len(differences), [*data.notes, crossed, *doubts])


def judge_peak(claim: Peak, data: ClaimData, confidence: float) -> Outcome:
    """Judge whether a curve is higher at some inner density than at the first and the last.

    It holds if both differences are above 0 at one of k inner densities, with Bonferroni's correction for k.
    It fails if, at each inner density, one of the two differences is not above 0, with the correction for 2.
    """
    if len(data.densities) < 3:
        raise NoDataError(f"{format_densities(data.densities)}: rise and fall need three densities")
    (table,) = data.complete()
    values = table.to_numpy()
    region = Region(0, math.inf, closed=False)
    inner = range(1, values.shape[1] - 1)

    def differences_to_ends(at: int, cases: int) -> list[Interval]:
        level = joint_level(confidence, cases)
        return [bootstrap_interval(values[:, at] - values[:, end], confidence=level) for end in (0, -1)]

    smaller = {at: min(differences_to_ends(at, len(inner)), key=region.depth) for at in inner}
    best = max(inner, key=lambda at: (region.depth(smaller[at]), values[:, at].mean()))
    verdict = region.verdict(smaller[best])
    if verdict != HOLDS:
        refuted = all(FAILS in map(region.verdict, differences_to_ends(at, 2)) for at in inner)
        verdict = FAILS if refuted else UNDECIDED
    notes = [
        *data.notes,
        f"smaller of the differences of N = {data.densities[best]} to the first and the last N",
        too_few_note(len(values), joint_level(confidence, len(inner))),
    ]
    return Outcome(verdict, smaller[best], claim.quantity.unit_of_difference, len(values), notes)


def judge_trend(claim: Trend, data: ClaimData, confidence: float) -> Outcome:
    """Judge whether the rank correlation of a mean curve with N exceeds a number."""
    if len(data.densities) < 3:
        raise NoDataError(f"{format_densities(data.densities)}: a trend needs three densities")
    (table,) = data.complete()
    interval = rank_correlation_with_n(data.densities, table.to_numpy(), confidence)
    verdict = Region(claim.above, math.inf, closed=False).verdict(interval)
    notes = [*data.notes, too_few_note(len(table), confidence)]
    return Outcome(verdict, interval, "rank correlation with N", len(table), notes)
