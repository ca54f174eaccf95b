"""Short runs, and the results of a sweep."""

from collections.abc import Iterable

from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.runs.outcome import Failure, Outcome, Result
from kswarms.scenarios.runs.run import Run, expand


def short_runs(name: str, densities: tuple[int, ...] = (6, 10), seeds: int = 2) -> list[Run]:
    """Return runs of a scenario, shortened to games of 20 s and at most as much learning."""
    scenario = CATALOGUE[name].replace(densities=densities, seeds=seeds)
    conditions = tuple(
        condition.replace(duration=20.0, learning=min(20.0, condition.learning))
        for condition in scenario.conditions
    )
    return expand([scenario.replace(conditions=conditions)])


def failing_run(run: Run) -> Run:
    """Return a run whose seed is not allowed."""
    return Run("bad", run.game, -1, run.labels)


def by_digest(results: Iterable[Result]) -> dict[str, Outcome | Failure]:
    """Return results by the digests of their runs."""
    return {run.digest: result for run, result, _ in results}
