"""Games for tests of outcomes, as the results of `kswarms run`."""

from collections.abc import Callable
from functools import cache

import pytest

from kswarms.analysis.results.runs import Results
from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.runs.run import expand
from kswarms.scenarios.runs.sweep import play_all
from tests.helpers.played_runs import result_table

Play = Callable[[tuple[str, ...], tuple[int, ...], int, int], Results]


@pytest.fixture(scope="session")
def played() -> Play:
    """Return a function that plays scenarios (ids, densities, seeds, first seed) and caches the results."""
    return cache(play)


def play(ids: tuple[str, ...], densities: tuple[int, ...], seeds: int, first_seed: int) -> Results:
    scenarios = [CATALOGUE[name].replace(densities=densities, seeds=seeds) for name in ids]
    planned = expand(scenarios, first_seed)
    # For few games, the start of worker processes takes longer than they save.
    games = list(play_all(planned, jobs=2 if len(planned) > 100 else 1))
    runs = result_table(games)
    assert len(runs.drop_duplicates(["scenario", "n", "seed"])) == len(ids) * len(densities) * seeds
    learned = result_table(games, "policies")
    return Results(runs, None if learned.empty else learned)
