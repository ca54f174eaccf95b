"""How results decide a finding: an interval over seeds beside the region in which the claim is true.

A claim holds if the whole interval lies in its region, fails if the whole interval lies outside, and is
undecided if the interval lies in both, or if there are too few seeds for an interval of that level.
A claim about every density is true if it is at each, so it holds if each interval says so, without a
correction; it is false if it is at any, so to fail it takes an interval at the level 1 − (1 − c) / k, k being
the number of densities (Bonferroni, which for "any at all" is what Holm's correction comes to).
"""

import math
from collections.abc import Sequence
from typing import Final

import numpy as np
import pandas as pd
from scipy import stats

from kswarms.agents.common.errors import InputError
from kswarms.analysis.findings.claims import (
    Agreement,
    Claim,
    Compare,
    Finding,
    Overtake,
    Peak,
    Quantity,
    Share,
    Trend,
)
from kswarms.analysis.findings.data import Data, NoDataError, complete, listed, sizes
from kswarms.analysis.findings.verdicts import FAILS, HOLDS, NO_DATA, UNDECIDED, Outcome, Region, Verdict
from kswarms.analysis.results.published import learned_percentages
from kswarms.analysis.results.runs import Results
from kswarms.analysis.statistics.comparisons import more_seeds
from kswarms.analysis.statistics.curves import overtaking, rank_correlation_with_n
from kswarms.analysis.statistics.intervals import Interval, Values, bootstrap_interval, fewest_seeds

_POWER: Final = 0.8


def judge(finding: Finding, results: Results) -> Verdict:
    """Say whether a finding holds in some results.

    Parameters
    ----------
    finding : Finding
        One of `kswarms.analysis.findings.FINDINGS`, or of a file of one's own.
    results : Results
        As `kswarms.analysis.results.runs.read_results` returns them.

    Raises
    ------
    InputError
        The results hold a game twice, policies without their games, or several opponents of which the claim
        names none.
    """
    claim = finding.claim
    try:
        outcome = _judge_claim(claim, Data(claim, results), finding.confidence)
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


def _judge_claim(claim: Claim, data: Data, confidence: float) -> Outcome:
    match claim:
        case Compare(over="each N"):
            return _compare_at_each(claim, data, confidence)
        case Compare():
            return _compare_over_all(claim, data, confidence)
        case Overtake():
            return _overtake(claim, data, confidence)
        case Peak():
            return _peak(data, confidence, _unit_of_difference(claim.quantity))
        case Trend():
            return _trend(claim, data, confidence)
        case Share():
            return _share(claim, data, confidence)
        case Agreement():
            return _agreement(claim, data, confidence)


def _region(claim: Compare) -> Region:
    """Return where the difference, or the left side if the right is a number, has to lie."""
    at = 0.0 if isinstance(claim.right, Quantity) else claim.right
    margin = claim.margin
    return {
        ">": Region(at + margin, math.inf, closed=False),
        ">=": Region(at - margin, math.inf),
        "<": Region(-math.inf, at - margin, closed=False),
        "<=": Region(-math.inf, at + margin),
        "within": Region(at - margin, at + margin),
    }[claim.relation]


def _compare_at_each(claim: Compare, data: Data, confidence: float) -> Outcome:
    region = _region(claim)
    samples = {}
    for n in data.densities:
        tables = complete(data.tables, [n])
        if len(tables[0]):
            samples[n] = _difference(tables)[:, 0]
    if not samples:
        raise NoDataError(f"no seed has been played on both sides at {listed(data.densities)}")
    single = {n: bootstrap_interval(values, confidence=confidence) for n, values in samples.items()}
    for_all = _joint(confidence, len(samples))
    joint = {n: bootstrap_interval(values, confidence=for_all) for n, values in samples.items()}
    holds = [n for n in samples if region.verdict(single[n]) == HOLDS]
    fails = [n for n in samples if region.verdict(joint[n]) == FAILS]
    shown = joint if fails else single
    verdict = FAILS if fails else HOLDS if len(holds) == len(samples) else UNDECIDED
    worst = min(fails or samples, key=lambda n: region.depth(shown[n]))
    notes = [
        *(data.notes if len(samples) == len(data.densities) else [listed(list(samples))]),
        f"the numbers are of N = {worst}, where it is least so" if len(samples) > 1 else "",
    ]
    if verdict == FAILS:
        notes.append(f"false at {listed(fails)}")
    elif verdict == UNDECIDED:
        notes += [
            f"sure at {listed(holds)}" if holds else "",
            _what_would_help(samples[worst], region, confidence, for_all),
        ]
    return Outcome(verdict, shown[worst], _unit(claim), min(map(len, samples.values())), notes)


def _compare_over_all(claim: Compare, data: Data, confidence: float) -> Outcome:
    region = _region(claim)
    differences = _difference(data.complete())
    values = differences.mean(axis=1) if claim.over == "mean over N" else differences.sum(axis=1)
    interval = bootstrap_interval(values, confidence=confidence)
    verdict = region.verdict(interval)
    notes = [*data.notes, claim.over]
    if verdict == UNDECIDED:
        notes.append(_what_would_help(values, region, confidence, confidence))
    return Outcome(verdict, interval, _unit(claim), len(values), notes)


def _overtake(claim: Overtake, data: Data, confidence: float) -> Outcome:
    absent = [n for n in claim.between if n not in data.densities]
    if absent:
        raise NoDataError(f"nothing played at {listed(absent)}")
    differences = _difference(data.complete())
    found = overtaking(data.densities, differences, confidence)
    low, high = found.for_good.low, found.for_good.high
    if few := _too_few(len(differences), confidence):
        verdict, doubts = UNDECIDED, [few]
    else:
        verdict = Region(*claim.between).verdict(found.for_good)
        doubts = [f"perhaps ahead from N = {data.densities[0]} on"] if low == -math.inf else []
        doubts += [f"perhaps not ahead at N = {data.densities[-1]}"] if high == math.inf else []
    crossed = ", ".join(f"{n:.1f}" for n in found.crossings)
    crossed = f"the mean curves cross at N = {crossed}" if crossed else "the mean curves do not cross"
    return Outcome(verdict, found.for_good, "robots", len(differences), [*data.notes, crossed, *doubts])


def _peak(data: Data, confidence: float, unit: str) -> Outcome:
    """Judge "at some density between, more than at the first and than at the last".

    To hold it takes both differences at one of k densities, at the level for k. To fail it takes that at each
    density one of the two differences is not above 0, at the level for 2.
    """
    if len(data.densities) < 3:
        raise NoDataError(f"{listed(data.densities)}: a rise and a fall take three densities")
    (table,) = data.complete()
    values = table.to_numpy()
    region = Region(0, math.inf, closed=False)
    between = range(1, values.shape[1] - 1)

    def two(at: int, cases: int) -> list[Interval]:
        ends = (values[:, at] - values[:, end] for end in (0, -1))
        return [bootstrap_interval(differences, confidence=_joint(confidence, cases)) for differences in ends]

    lesser = {at: min(two(at, len(between)), key=region.depth) for at in between}
    best = max(between, key=lambda at: (region.depth(lesser[at]), values[:, at].mean()))
    verdict = region.verdict(lesser[best])
    if verdict != HOLDS:
        refuted = all(any(region.verdict(each) == FAILS for each in two(at, 2)) for at in between)
        verdict = FAILS if refuted else UNDECIDED
    notes = [
        *data.notes,
        f"the lesser of the differences of N = {data.densities[best]} to the first and the last N",
        _too_few(len(values), _joint(confidence, len(between))),
    ]
    return Outcome(verdict, lesser[best], unit, len(values), notes)


def _trend(claim: Trend, data: Data, confidence: float) -> Outcome:
    if len(data.densities) < 3:
        raise NoDataError(f"{listed(data.densities)}: a trend takes three densities")
    (table,) = data.complete()
    interval = rank_correlation_with_n(data.densities, table.to_numpy(), confidence)
    verdict = Region(claim.above, math.inf, closed=False).verdict(interval)
    notes = [*data.notes, _too_few(len(table), confidence)]
    return Outcome(verdict, interval, "rank correlation with N", len(table), notes)


def _share(claim: Share, data: Data, confidence: float) -> Outcome:
    """Judge a share of all robots by the wider bounds of two intervals.

    Robots of a game are not independent, so games are drawn again (bootstrap); but where nobody, or hardly
    anyone, is an exception, the bootstrap has nothing to draw from, and the exact binomial interval is wider.
    """
    (shares,) = data.complete()
    robots = sizes(data.results, claim.quantity).reindex_like(shares)
    if robots.isna().any(axis=None):
        raise InputError("runs", claim.quantity.scenario, "must have the games of which there are policies")
    counts = np.stack([shares / 100 * robots, robots], axis=-1)

    def pooled(means: Values) -> Values:
        sums: Values = means.sum(axis=1)
        return 100 * sums[:, 0] / sums[:, 1]

    by_game = bootstrap_interval(counts, pooled, confidence)
    learned, of_all = (round(float(total)) for total in counts.sum(axis=(0, 1)))
    by_robot = stats.binomtest(learned, of_all).proportion_ci(confidence, method="exact")
    interval = Interval(
        by_game.estimate, min(by_game.low, 100 * by_robot.low), max(by_game.high, 100 * by_robot.high)
    )
    verdict = Region(claim.above, math.inf, closed=False).verdict(interval)
    notes = [*data.notes, f"{learned} of {of_all} robots", _too_few(len(counts), confidence)]
    return Outcome(verdict, interval, claim.quantity.unit, len(counts), notes)


def _agreement(claim: Agreement, data: Data, confidence: float) -> Outcome:
    published = _published(claim, data.densities)
    if np.isnan(published).all():
        raise NoDataError(f"nothing published of {listed(data.densities)}")
    values = np.stack([table.to_numpy() for table in data.complete()], axis=-1)

    def mean_absolute_error(means: Values) -> Values:
        errors = np.abs(means - published)
        return np.asarray(np.nanmean(errors, axis=(1, 2)), dtype=np.float64)

    interval = bootstrap_interval(values, mean_absolute_error, confidence)
    verdict = Region(-math.inf, claim.margin).verdict(interval)
    notes = [*data.notes, f"{np.isfinite(published).sum()} cells", _too_few(len(values), confidence)]
    return Outcome(verdict, interval, "percentage points", len(values), notes)


def _published(claim: Agreement, densities: Sequence[int]) -> Values:
    """Return the published cells, shape (densities, columns), NaN where there is none."""
    table = learned_percentages().set_index(["scenario", "learned", "n"])["published"]
    columns = []
    for cell in claim.cells:
        learned = "attack" if cell.measure == "learned_attack" else "flight within"
        keys = [(cell.scenario, learned, n) for n in densities]
        columns.append(table.reindex(pd.MultiIndex.from_tuples(keys)).to_numpy(dtype=np.float64))
    return np.stack(columns, axis=-1)


def _difference(tables: Sequence[pd.DataFrame]) -> Values:
    """Return left − right seed by seed, or the left alone; shape (seeds, densities)."""
    left, *right = (table.to_numpy(dtype=np.float64) for table in tables)
    return left - right[0] if right else left


def _joint(confidence: float, cases: int) -> float:
    """Return the level of each of several intervals that are right all at once (Bonferroni)."""
    return 1 - (1 - confidence) / cases


def _what_would_help(values: Values, region: Region, to_hold: float, to_fail: float) -> str:
    """Say how many seeds would decide a mean that is undecided; the arguments are the two levels it takes."""
    mean = float(values.mean())
    level = to_hold if region.verdict(Interval(mean, mean, mean)) == HOLDS else to_fail
    if few := _too_few(len(values), level):
        return few
    more = more_seeds(values - region.nearest_bound(mean), _POWER, level)
    if more is None:
        return "no number of seeds would decide it, as it looks"
    return f"if it is as it looks, {max(1, more)} more seeds decide it (power {_POWER:.0%})"


def _too_few(seeds: int, confidence: float) -> str:
    fewest = fewest_seeds(confidence)
    return f"takes {fewest} seeds at least" if seeds < fewest else ""


def _unit(claim: Compare) -> str:
    return _unit_of_difference(claim.left) if isinstance(claim.right, Quantity) else claim.left.unit


def _unit_of_difference(quantity: Quantity) -> str:
    return "percentage points" if quantity.unit.startswith("%") else quantity.unit


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
