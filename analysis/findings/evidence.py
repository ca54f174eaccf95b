"""Confidence levels and notes that the kinds of claims share."""

from typing import Final

from kswarms.analysis.findings.verdicts import HOLDS, Region
from kswarms.analysis.statistics.comparisons import more_seeds
from kswarms.analysis.statistics.intervals import Interval, Values, fewest_seeds

_POWER: Final = 0.8


def joint_level(confidence: float, cases: int) -> float:
    """Return the level of each of several intervals that have a level together (Bonferroni)."""
    return 1 - (1 - confidence) / cases


def too_few(seeds: int, confidence: float) -> str:
    """Return a note if an interval of this level needs more seeds, else nothing."""
    fewest = fewest_seeds(confidence)
    return f"needs at least {fewest} seeds" if seeds < fewest else ""


def seeds_needed(values: Values, region: Region, to_hold: float, to_fail: float) -> str:
    """Return a note on how many more seeds would decide, if the mean of the values is the true one.

    `to_hold` and `to_fail` are the levels of the intervals for the two verdicts.
    """
    mean = float(values.mean())
    level = to_hold if region.verdict(Interval(mean, mean, mean)) == HOLDS else to_fail
    if few := too_few(len(values), level):
        return few
    more = more_seeds(values - region.nearest_bound(mean), _POWER, level)
    if more is None:
        return "if this effect is true, no number of seeds decides"
    return f"if this effect is true, {max(1, more)} more seeds decide (power {_POWER:.0%})"
