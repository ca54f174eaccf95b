"""Games played for tests of outcomes, as the results that a directory of `kswarms run` would hold."""

from collections.abc import Callable, Iterable
from functools import cache

import pandas as pd
import pytest

from kswarms.analysis.results.runs import Results
from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.runs.run import expand
from kswarms.scenarios.runs.sweep import play_all
from kswarms.scenarios.study.parquet import tabulate

Play = Callable[[tuple[str, ...], tuple[int, ...], int, int], Results]


@pytest.fixture(scope="session")
def played() -> Play:
    """Return a player of scenarios: ids, densities, seeds, first seed. What was played once is kept."""
    return cache(play)


def play(ids: tuple[str, ...], densities: tuple[int, ...], seeds: int, first_seed: int) -> Results:
    asked = [CATALOGUE[name].replace(densities=densities, seeds=seeds) for name in ids]
    tables = [tabulate(run, outcome) for run, outcome in play_all(expand(asked, first_seed), jobs=2)]
    runs = joined(table["runs"].to_pandas() for table in tables)
    assert len(runs.drop_duplicates(["scenario", "n", "seed"])) == len(ids) * len(densities) * seeds
    learned = [table["policies"].to_pandas() for table in tables if "policies" in table]
    return Results(runs, joined(learned) if learned else None)


def joined(frames: Iterable[pd.DataFrame]) -> pd.DataFrame:
    return pd.concat(frames, ignore_index=True)
