"""Judging findings: comparing an interval over seeds with the region where the claim is true.

A claim holds if the whole interval is inside the region, and fails if the whole interval is outside. It is
undecided if the interval contains a bound of the region, or if there are too few seeds for an interval.
"""

import math

from kswarms.agents.common.errors import require_type
from kswarms.analysis.findings.claims import Agreement, Claim, Compare, Overtake, Peak, Share, Trend
from kswarms.analysis.findings.data import ClaimData, NoDataError
from kswarms.analysis.findings.finding import Finding
from kswarms.analysis.findings.judges.comparing import judge_at_each, judge_over_all
from kswarms.analysis.findings.judges.curve_claims import judge_overtaking, judge_peak, judge_trend
from kswarms.analysis.findings.judges.learned_claims import judge_agreement, judge_share
from kswarms.analysis.findings.verdicts import NO_DATA, Outcome, Verdict
from kswarms.analysis.results.runs import Results


def judge(finding: Finding, results: Results) -> Verdict:
    """Judge a finding, one of `FINDINGS` or a user-defined one, by results of `read_results`.

    Raises
    ------
    InputError
        The results have a game twice, or policies without games; or the claim does not name one of several
        opponents.
    """
    require_type("finding", finding, Finding, "must be a kswarms.Finding")
    require_type("results", results, Results, "must be a kswarms.Results, see read_results")
    try:
        outcome = _judge_claim(finding.claim, ClaimData(finding.claim, results), finding.confidence)
    except NoDataError as missing:
        return Verdict(finding.id, finding.statement, NO_DATA, note=str(missing))
    return Verdict(
        finding.id,
        finding.statement,
        outcome.verdict,
        effect=_finite(outcome.interval.estimate),
        low=_finite(outcome.interval.low),
        high=_finite(outcome.interval.high),
        unit=outcome.unit,
        seeds=outcome.seeds,
        note="; ".join(note for note in outcome.notes if note),
    )


def _judge_claim(claim: Claim, data: ClaimData, confidence: float) -> Outcome:
    match claim:
        case Compare(over="each N"):
            return judge_at_each(claim, data, confidence)
        case Compare():
            return judge_over_all(claim, data, confidence)
        case Overtake():
            return judge_overtaking(claim, data, confidence)
        case Peak():
            return judge_peak(claim, data, confidence)
        case Trend():
            return judge_trend(claim, data, confidence)
        case Share():
            return judge_share(claim, data, confidence)
        case Agreement():
            return judge_agreement(claim, data, confidence)


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
