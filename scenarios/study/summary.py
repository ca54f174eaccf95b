"""What a ledger says at a glance: how much is done, what failed, by which code it was played."""

from collections.abc import Iterator
from typing import NamedTuple

from kswarms.scenarios.study.ledger import Ledger, Point


class FailedRun(NamedTuple):
    """A run that failed: what it is, and how to see it fail again."""

    point: Point
    error: str
    trace: str
    replay: str


def by_scenario(ledger: Ledger) -> dict[str, dict[str, tuple[int, float]]]:
    """Return for each scenario and status the number of points, and the CPU time of their runs (s).

    A run that several scenarios share counts in each of them.
    """
    found: dict[str, dict[str, tuple[int, float]]] = {}
    for scenario, status, points, seconds in ledger.query(
        "SELECT scenario, status, COUNT(*), TOTAL(seconds) FROM points JOIN runs USING (run)"
        " GROUP BY scenario, status ORDER BY scenario"
    ):
        found.setdefault(scenario, {})[status] = (points, seconds)
    return found


def in_all(ledger: Ledger) -> dict[str, tuple[int, float]]:
    """Return for each status the number of runs, each once, and their CPU time (s)."""
    rows = ledger.query("SELECT status, COUNT(*), TOTAL(seconds) FROM runs GROUP BY status")
    return {status: (runs, seconds) for status, runs, seconds in rows}


def codes(ledger: Ledger) -> dict[str, int]:
    """Return how many runs each state of the code has played."""
    return dict(ledger.query("SELECT code, COUNT(*) FROM runs WHERE code NOT NULL GROUP BY code"))


def failures(ledger: Ledger) -> Iterator[FailedRun]:
    """Yield the runs that failed when last played, each under one of its labels."""
    for *point, error, trace, replay in ledger.query(
        "SELECT run, MIN(scenario), condition, n, points.seed, error, traceback, replay"
        " FROM points JOIN runs USING (run) WHERE error NOT NULL"
        " GROUP BY run ORDER BY MIN(scenario), condition, n, points.seed"
    ):
        yield FailedRun(Point(*point), error, trace, replay)
