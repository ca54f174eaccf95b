"""Judging comparisons, at each density and over all densities."""

import math

from kswarms.analysis.findings.claims import Compare
from kswarms.analysis.findings.data import ClaimData, NoDataError, difference, format_densities
from kswarms.analysis.findings.judges.evidence import additional_seeds_note, joint_level
from kswarms.analysis.findings.quantity import Quantity
from kswarms.analysis.findings.verdicts import FAILS, HOLDS, UNDECIDED, Outcome, Region
from kswarms.analysis.statistics.intervals import bootstrap_interval


def judge_at_each(claim: Compare, data: ClaimData, confidence: float) -> Outcome:
    """Judge a claim about every density.

    It holds if the interval at each of k densities is inside the region, without correction. It fails if any
    interval with Bonferroni's correction for k is outside; Holm's correction rejects in the same cases.
    """
    region = region_of(claim)
    tables = {n: data.at([n]) for n in data.densities}
    samples = {n: difference(table)[:, 0] for n, table in tables.items() if len(table[0])}
    if not samples:
        raise NoDataError(f"no seed with both sides at {format_densities(data.densities)}")
    joint_confidence = joint_level(confidence, len(samples))
    single = {n: bootstrap_interval(values, confidence=confidence) for n, values in samples.items()}
    joint = {n: bootstrap_interval(values, confidence=joint_confidence) for n, values in samples.items()}
    holds = [n for n in samples if region.verdict(single[n]) == HOLDS]
    fails = [n for n in samples if region.verdict(joint[n]) == FAILS]
    shown = joint if fails else single
    verdict = FAILS if fails else HOLDS if len(holds) == len(samples) else UNDECIDED
    worst = min(fails or samples, key=lambda n: region.depth(shown[n]))
    notes = data.notes if len(samples) == len(data.densities) else [format_densities(samples)]
    if len(samples) > 1:
        notes = [*notes, f"effect at N = {worst}, where the claim is weakest"]
    if verdict == FAILS:
        notes = [*notes, f"false at {format_densities(fails)}"]
    elif verdict == UNDECIDED:
        true_at = f"true at {format_densities(holds)}" if holds else ""
        notes = [*notes, true_at, additional_seeds_note(samples[worst], region, confidence, joint_confidence)]
    return Outcome(verdict, shown[worst], _unit(claim), min(map(len, samples.values())), notes)


def judge_over_all(claim: Compare, data: ClaimData, confidence: float) -> Outcome:
    """Judge a claim about the mean or the sum over the densities."""
    region = region_of(claim)
    differences = difference(data.complete())
    values = differences.mean(axis=1) if claim.over == "mean over N" else differences.sum(axis=1)
    interval = bootstrap_interval(values, confidence=confidence)
    verdict = region.verdict(interval)
    notes = [*data.notes, claim.over]
    if verdict == UNDECIDED:
        notes.append(additional_seeds_note(values, region, confidence, confidence))
    return Outcome(verdict, interval, _unit(claim), len(values), notes)


def region_of(claim: Compare) -> Region:
    """Return the region of the difference, or of the left side if the right side is a number."""
    at = 0.0 if isinstance(claim.right, Quantity) else claim.right
    margin = claim.margin
    return {
        ">": Region(at + margin, math.inf, closed=False),
        ">=": Region(at - margin, math.inf),
        "<": Region(-math.inf, at - margin, closed=False),
        "<=": Region(-math.inf, at + margin),
        "within": Region(at - margin, at + margin),
    }[claim.relation]


def _unit(claim: Compare) -> str:
    return claim.left.unit_of_difference if isinstance(claim.right, Quantity) else claim.left.unit
