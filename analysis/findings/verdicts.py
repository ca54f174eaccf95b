"""Verdicts, and regions of numbers where claims are true."""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from kswarms.analysis.statistics.intervals import Interval, Values

HOLDS: Final = "holds"
FAILS: Final = "fails"
UNDECIDED: Final = "undecided"
NO_DATA: Final = "no data"


@dataclass(frozen=True)
class Verdict:
    """The verdict on a finding.

    Attributes
    ----------
    finding, statement : str
        Id and statement of the finding.
    verdict : str
        ``holds``, ``fails``, ``undecided`` or ``no data``.
    effect, low, high : float or None
        Estimated effect and its interval; None if missing or infinite.
    unit : str
        Unit of the effect.
    seeds : int
        Minimum number of seeds at any density.
    note : str
        Densities, missing data, and the number of additional seeds for a decision.
    """

    finding: str
    statement: str
    verdict: str
    effect: float | None = None
    low: float | None = None
    high: float | None = None
    unit: str = ""
    seeds: int = 0
    note: str = ""

    def __str__(self) -> str:
        number = "" if self.effect is None else f": {self.effect:.4g} {self.unit} ({self.interval})"
        return f"{self.finding} {self.verdict}{number}; {self.seeds} seeds; {self.note}"

    @property
    def interval(self) -> str:
        """The interval as text without unit; a missing bound is –."""
        low, high = ("–" if bound is None else f"{bound:.4g}" for bound in (self.low, self.high))
        return f"{low} … {high}"


@dataclass(frozen=True)
class Region:
    """Numbers for which a claim is true: `low` to `high`, including both bounds if `closed`."""

    low: float
    high: float
    closed: bool = True

    def verdict(self, interval: Interval) -> str:
        """Return ``holds`` if an interval is inside the region, ``fails`` if outside, else ``undecided``."""
        if self.closed:
            inside = self.low <= interval.low and interval.high <= self.high
            outside = interval.high < self.low or self.high < interval.low
        else:
            inside = self.low < interval.low and interval.high < self.high
            outside = interval.high <= self.low or self.high <= interval.low
        return HOLDS if inside else FAILS if outside else UNDECIDED

    def depth(self, interval: Interval) -> float:
        """Return the distance of an interval to the nearest finite bound, negative if it extends outside."""
        depths = [interval.low - self.low] if math.isfinite(self.low) else []
        depths += [self.high - interval.high] if math.isfinite(self.high) else []
        return min(depths)

    def distance(self, values: Values) -> Values:
        """Return the distance of each value from the region, 0 inside."""
        return np.maximum(0.0, np.maximum(self.low - values, values - self.high))

    def nearest_bound(self, value: float) -> float:
        """Return the bound nearest to a value."""
        return self.low if abs(value - self.low) <= abs(value - self.high) else self.high


@dataclass(frozen=True)
class Outcome:
    """Verdict on a claim, with the interval of its effect, and notes (empty notes are ignored)."""

    verdict: str
    interval: Interval
    unit: str
    seeds: int
    notes: list[str]
