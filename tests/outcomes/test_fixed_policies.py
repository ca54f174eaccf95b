"""Findings of the source on fixed policies (specification, section 3.4, figures 6.1 to 6.3)."""

from collections.abc import Callable

import pandas as pd
import pytest

from kswarms.analysis.findings import FAILS, FINDINGS, HOLDS, judge
from kswarms.analysis.results.runs import Results

pytestmark = pytest.mark.slow

BY_ID = {finding.id: finding for finding in FINDINGS}
FINDINGS_THAT_HOLD = ("6.1a-rise-and-fall", "6.1b-below-6.1a", "6.1b-below-6.1c", "6.1c-together")
FINDINGS_THAT_HOLD += ("6.3-attackers-in-conflict", "6.3-mostly-inter-swarm")


@pytest.fixture(
    scope="module",
    params=[
        pytest.param(((6, 16, 50), 8), id="few"),
        pytest.param(((6, 10, 16, 20, 26, 30, 36, 40, 46, 50), 20), id="whole", marks=pytest.mark.full),
    ],
)
def results(request: pytest.FixtureRequest, played: Callable[..., Results]) -> Results:
    densities, seeds = request.param
    return played(("fig-6.1a", "fig-6.1b", "fig-6.1c", "fig-6.3"), densities, seeds, 0)


@pytest.mark.parametrize("finding", FINDINGS_THAT_HOLD)
def test_the_finding_holds(finding: str, results: Results) -> None:
    verdict = judge(BY_ID[finding], results)
    assert verdict.verdict == HOLDS, str(verdict)


def test_attackers_lead_at_high_densities(results: Results, played: Callable[..., Results]) -> None:
    # All densities of the finding; at a single one, eight seeds leave the verdict open.
    seeds = results.runs["seed"].nunique()
    missing = tuple(n for n in (40, 46, 50) if n not in set(results.runs["n"]))
    runs = [results.runs, *(played(("fig-6.1c",), (n,), seeds, 0).runs for n in missing)]
    verdict = judge(BY_ID["6.1c-attack-at-high-n"], Results(pd.concat(runs)))
    assert verdict.verdict == HOLDS, str(verdict)


def test_two_avoiding_swarms_score_alike(results: Results) -> None:
    # Without the margin: eight seeds show no difference.
    finding = BY_ID["6.1a-alike"]
    verdict = judge(finding.replace(claim=finding.claim.replace(margin=0.0)), results)
    assert verdict.verdict != FAILS, str(verdict)


def test_a_puck_limited_game_ends_at_fifty_pucks(results: Results) -> None:
    games = results.runs[results.runs["scenario"] == "fig-6.3"]
    assert (games["ended"] == "pucks").all()
    assert (games.groupby(["n", "seed"])["pucks"].sum() == 50).all()
