"""Verdicts: what results say of a finding, and the region in which its claim is true."""

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
    """What results say of a finding.

    Attributes
    ----------
    finding, statement : str
        Id and sentence of the finding.
    verdict : str
        ``holds``, ``fails``, ``undecided`` or ``no data``.
    effect, low, high : float or None
        The number that decides and its interval; None where there is none, or where it is infinite.
    unit : str
        Of these.
    seeds : int
        Fewest seeds that went into it at any density.
    note : str
        Which densities, what is missing, what would help.
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
        """Return the verdict in a line: what a failing test, or a reader, wants to know."""
        number = "" if self.effect is None else f": {self.effect:.4g} {self.unit} ({self.interval})"
        return f"{self.finding} {self.verdict}{number}; {self.seeds} seeds; {self.note}"

    @property
    def interval(self) -> str:
        """The interval in words, without its unit; – where there is no bound."""
        low, high = ("–" if bound is None else f"{bound:.4g}" for bound in (self.low, self.high))
        return f"{low} … {high}"


@dataclass(frozen=True)
class Region:
    """Where a claim is true: from `low` to `high`, these included if it is closed."""

    low: float
    high: float
    closed: bool = True

    def verdict(self, interval: Interval) -> str:
        """Say whether an interval lies inside, outside or across."""
        if self.closed:
            inside = self.low <= interval.low and interval.high <= self.high
            outside = interval.high < self.low or self.high < interval.low
        else:
            inside = self.low < interval.low and interval.high < self.high
            outside = interval.high <= self.low or self.high <= interval.low
        return HOLDS if inside else FAILS if outside else UNDECIDED

    def depth(self, interval: Interval) -> float:
        """Return how far inside an interval lies; below 0: how far its farther bound is outside."""
        depths = [interval.low - self.low] if math.isfinite(self.low) else []
        depths += [self.high - interval.high] if math.isfinite(self.high) else []
        return min(depths)

    def nearest_bound(self, value: float) -> float:
        """Return the bound that is nearest to a value."""
        return self.low if abs(value - self.low) <= abs(value - self.high) else self.high


@dataclass(frozen=True)
class Outcome:
    """What a claim comes to.

    Attributes
    ----------
    verdict : str
        As in `Verdict`.
    interval : Interval
        The number that decides, in `unit`.
    unit : str
        Its unit.
    seeds : int
        Fewest seeds that went into it at any density.
    notes : list of str
        What stands in the note; empty ones are left out.
    """

    verdict: str
    interval: Interval
    unit: str
    seeds: int
    notes: list[str]
