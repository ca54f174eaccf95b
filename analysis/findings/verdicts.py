"""Verdicts, and the regions of numbers in which claims are true."""

import math
from dataclasses import dataclass
from typing import Final

from kswarms.analysis.statistics.intervals import Interval

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
        Deciding number and its interval; None if there is none, or if it is infinite.
    unit : str
        Their unit.
    seeds : int
        Smallest number of seeds at any density.
    note : str
        Densities, missing data, and the number of seeds that would decide.
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
        """The interval as text without its unit; – for a missing bound."""
        low, high = ("–" if bound is None else f"{bound:.4g}" for bound in (self.low, self.high))
        return f"{low} … {high}"


@dataclass(frozen=True)
class Region:
    """Numbers for which a claim is true: from `low` to `high`, with these if `closed`."""

    low: float
    high: float
    closed: bool = True

    def verdict(self, interval: Interval) -> str:
        """Return ``holds`` for an interval inside the region, ``fails`` outside, else ``undecided``."""
        if self.closed:
            inside = self.low <= interval.low and interval.high <= self.high
            outside = interval.high < self.low or self.high < interval.low
        else:
            inside = self.low < interval.low and interval.high < self.high
            outside = interval.high <= self.low or self.high <= interval.low
        return HOLDS if inside else FAILS if outside else UNDECIDED

    def depth(self, interval: Interval) -> float:
        """Return the distance of an interval from the border, negative if a bound is outside."""
        depths = [interval.low - self.low] if math.isfinite(self.low) else []
        depths += [self.high - interval.high] if math.isfinite(self.high) else []
        return min(depths)

    def nearest_bound(self, value: float) -> float:
        """Return the bound nearest to a value."""
        return self.low if abs(value - self.low) <= abs(value - self.high) else self.high


@dataclass(frozen=True)
class Outcome:
    """Verdict on a claim, its deciding number, and notes (empty notes are left out)."""

    verdict: str
    interval: Interval
    unit: str
    seeds: int
    notes: list[str]
