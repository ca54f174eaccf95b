"""Confidence levels and notes for all kinds of claims."""

from typing import Final

from kswarms.analysis.findings.verdicts import HOLDS, Region
from kswarms.analysis.statistics.comparisons import additional_seeds
from kswarms.analysis.statistics.intervals import Interval, Values, min_seeds

_POWER: Final = 0.8


def joint_level(confidence: float, cases: int) -> float:
    """Return the level of each interval for a joint level of `confidence` (Bonferroni's correction)."""
    return 1 - (1 - confidence) / cases


def too_few_note(seeds: int, confidence: float) -> str:
    """Return a note if an interval of this level needs more seeds, else ``""``."""
    minimum = min_seeds(confidence)
    return f"needs at least {minimum} seeds" if seeds < minimum else ""


def additional_seeds_note(values: Values, region: Region, to_hold: float, to_fail: float) -> str:
    """Return a note on the additional seeds for a decision, if the mean of the values is the true mean.

    `to_hold` and `to_fail` are the levels of the intervals for the two verdicts.
    """
    mean = float(values.mean())
    level = to_hold if region.verdict(Interval(mean, mean, mean)) == HOLDS else to_fail
    if few := too_few_note(len(values), level):
        return few
    more = additional_seeds(values - region.nearest_bound(mean), _POWER, level)
    if more is None:
        return "if this effect is true, no number of seeds decides"
    return f"if this effect is true, {max(1, more)} more seeds decide (power {_POWER:.0%})"
