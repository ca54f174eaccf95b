"""The physics against ARGoS: the same controller has the same time in conflict and the same scores."""

from collections.abc import Iterable
from typing import Final

import pandas as pd
import pytest

from kswarms.analysis.tables.fidelity import compare_with_argos
from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.catalogue.argos import DENSITIES
from kswarms.scenarios.description.scenario import Scenario
from kswarms.scenarios.runs.run import expand
from kswarms.scenarios.runs.sweep import play_all
from tests.helpers.played_runs import result_table

pytestmark = pytest.mark.slow

SCENARIOS: Final = [CATALOGUE[f"argos-{pair}"] for pair in ("avoid-avoid", "attack-attack", "avoid-attack")]


def compared(scenarios: Iterable[Scenario], densities: tuple[int, ...], seeds: int) -> pd.DataFrame:
    """Play scenarios and compare them with ARGoS."""
    planned = [scenario.replace(densities=densities, seeds=seeds) for scenario in scenarios]
    return compare_with_argos(result_table(play_all(expand(planned))))


@pytest.fixture(
    scope="module",
    params=[
        pytest.param(((6, 16, 46), 20), id="three densities"),
        pytest.param((DENSITIES, 20), id="all", marks=pytest.mark.full),
    ],
)
def comparison(request: pytest.FixtureRequest) -> pd.DataFrame:
    densities, seeds = request.param
    frame = compared(SCENARIOS, densities, seeds)
    assert len(frame) == len(SCENARIOS) * len(densities) * 2
    assert set(frame["seeds_ours"]) == {seeds}
    return frame


def test_the_share_of_time_in_conflict_agrees(comparison: pd.DataFrame) -> None:
    assert comparison["share_fits"].all(), comparison.to_string()


def test_the_scores_agree(comparison: pd.DataFrame) -> None:
    assert comparison["score_fits"].all(), comparison.to_string()


@pytest.mark.parametrize(
    ("scenario", "change", "n", "verdict"),
    [
        ("argos-attack-attack", "friction=0", 46, "score_fits"),  # attackers slide past each other
        ("argos-avoid-avoid", "conflict_distance=0.05", 26, "share_fits"),  # fewer conflicts
    ],
)
def test_other_parameters_do_not_agree(scenario: str, change: str, n: int, verdict: str) -> None:
    original = CATALOGUE[scenario]
    (condition,) = original.conditions
    changed = original.replace(conditions=(condition.replace(parameters=f"argos, {change}"),))
    frame = compared([changed], (n,), 20)
    assert not frame[verdict].any(), frame.to_string()
