"""Summaries of a ledger: progress, failures and the code that played."""

import shlex
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from kswarms.scenarios.study.ledger import Ledger, Point


class FailedRun(NamedTuple):
    """A failed run: one of its points, the error and its traceback."""

    point: Point
    error: str
    trace: str


def points_by_scenario(ledger: Ledger) -> dict[str, dict[str, tuple[int, float]]]:
    """Return the number of points and the CPU time of their runs (s), by scenario and status.

    A run counts in each scenario that contains it.
    """
    counts: dict[str, dict[str, tuple[int, float]]] = {}
    for scenario, status, points, seconds in ledger.query(
        "SELECT scenario, status, COUNT(*), TOTAL(seconds) FROM points JOIN runs USING (run)"
        " GROUP BY scenario, status ORDER BY scenario"
    ):
        counts.setdefault(scenario, {})[status] = (points, seconds)
    return counts


def runs_by_status(ledger: Ledger) -> dict[str, tuple[int, float]]:
    """Return the number of runs and their CPU time (s), by status."""
    rows = ledger.query("SELECT status, COUNT(*), TOTAL(seconds) FROM runs GROUP BY status")
    return {status: (runs, seconds) for status, runs, seconds in rows}


def runs_by_code(ledger: Ledger) -> dict[str, int]:
    """Return the number of runs, by the version of the code that played them."""
    return dict(ledger.query("SELECT code, COUNT(*) FROM runs WHERE code NOT NULL GROUP BY code"))


def failed_runs(ledger: Ledger) -> Iterator[FailedRun]:
    """Yield the runs whose last attempt failed, each with its first scenario."""
    for *point, error, trace in ledger.query(
        "SELECT run, MIN(scenario), condition, n, points.seed, error, traceback"
        " FROM points JOIN runs USING (run) WHERE error NOT NULL"
        " GROUP BY run ORDER BY MIN(scenario), condition, n, points.seed"
    ):
        yield FailedRun(Point(*point), error, trace)


def replay_command(directory: Path, run: str) -> str:
    """Return the command that replays a run of a directory."""
    return f"kswarms replay {shlex.quote(str(directory))} {run}"
