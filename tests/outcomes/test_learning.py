"""Findings of the source on learners in chapter 6, and Table 6.1, with seeds that were not used for fitting.

A few densities and seeds run by default, all of them with the marker `full`. A game has a learning phase of
3000 s and a measured game of 600 s (specification, sections 3.1 and 3.4).
"""

from collections.abc import Callable
from typing import Any, Final, NamedTuple

import pytest

from kswarms.analysis.findings import FAILS, FINDINGS, HOLDS, Finding, Verdict, judge
from kswarms.analysis.measures.learned import learned_shares
from kswarms.analysis.results.runs import Results

LEARNING: Final = (("fig-6.4a", "fig-6.4b"), ("fig-6.6", "fig-6.7", "fig-6.8"))
"""Scenarios of learners that learn about other swarms, and of learners about their own swarm."""
DENSITIES: Final = (6, 10, 16, 20, 26, 30, 36, 40, 46, 50)
FIRST_SEED: Final = 1000
"""Smaller seeds were used for fitting."""
ONE_SIDED: Final = 0.9
"""Confidence of a two-sided interval, each bound of which has 95 %."""

TABLE_ERROR: Final = 8.0
"""Maximum mean absolute error over the cells of Table 6.1 (percentage points)."""
CONTRADICTED: Final = ("6.4b", 30)
"""Density at which the learner scores less than its opponent, unlike the source: 2.6 pucks (120 seeds)."""

BY_ID: Final = {finding.id: finding for finding in FINDINGS}


class Sample(NamedTuple):
    """Games that a test plays."""

    densities: tuple[int, ...]
    seeds: int  # games of each scenario and density
    scenarios: tuple[tuple[str, ...], ...] = LEARNING  # in groups that are played together


FEW = Sample((6, 30, 50), seeds=8, scenarios=LEARNING[:1])
# All robots learn flight within their swarm, so there is no variation between seeds.
EXTREMES = Sample((6, 50), seeds=4, scenarios=LEARNING[1:])
ALL = Sample(DENSITIES, seeds=20)
# Scores of few robots vary most between seeds, and their games are the fastest.
SPARSE = Sample((6, 10, 16), seeds=20, scenarios=(("fig-6.4b",),))

each_sample = pytest.mark.parametrize(
    "sample",
    [
        pytest.param(FEW, id="few", marks=pytest.mark.slow),
        pytest.param(ALL, id="all", marks=pytest.mark.full),
    ],
)

Outcomes = Callable[[Sample, str], Results]


@pytest.fixture
def outcomes(played: Callable[..., Results]) -> Outcomes:
    """Return a function that plays the group of a scenario."""

    def of(sample: Sample, scenario: str) -> Results:
        (group,) = (group for group in sample.scenarios if scenario in group)
        return played(group, sample.densities, sample.seeds, FIRST_SEED)

    return of


def without_margin(finding: Finding, **changes: Any) -> Finding:
    """Return a finding without a margin, whose intervals have bounds of 95 %."""
    claim = finding.claim.replace(margin=0.0, **changes)
    return finding.replace(claim=claim, confidence=ONE_SIDED)


@each_sample
@pytest.mark.parametrize("figure", ["6.4a", "6.4b"])
def test_the_learner_scores_at_least_as_much_as_its_opponent(
    figure: str, sample: Sample, outcomes: Outcomes
) -> None:
    # If all learn flight, both swarms behave alike; one interval in twenty excludes the tie.
    densities = tuple(n for n in sample.densities if (figure, n) != CONTRADICTED)
    finding = without_margin(BY_ID[f"{figure}-at-least"], densities=densities)
    verdict = judge(finding, outcomes(sample, f"fig-{figure}"))
    assert verdict.verdict != FAILS, str(verdict)
    assert verdict.seeds == sample.seeds


@pytest.mark.full
def test_against_attackers_learners_of_flight_score_less_at_one_density(outcomes: Outcomes) -> None:
    figure, n = CONTRADICTED
    finding = without_margin(BY_ID[f"{figure}-at-least"], relation="<", densities=(n,))
    verdict = judge(finding, outcomes(ALL, f"fig-{figure}"))
    assert verdict.verdict == HOLDS, str(verdict)


@pytest.mark.parametrize(
    "sample",
    [
        pytest.param(SPARSE, id="few robots", marks=pytest.mark.slow),
        pytest.param(ALL, id="all", marks=pytest.mark.full),
    ],
)
def test_against_attackers_the_learner_scores_clearly_more(sample: Sample, outcomes: Outcomes) -> None:
    # The source reports it at every N; here it holds at each small N, and on average over all N.
    over = "each N" if sample is SPARSE else "mean over N"
    finding = without_margin(BY_ID["6.4b-clearly-more"], over=over)
    verdict = judge(finding, outcomes(sample, "fig-6.4b"))
    assert verdict.verdict == HOLDS, str(verdict)


@pytest.mark.parametrize(
    "sample",
    [
        pytest.param(EXTREMES, id="extremes", marks=pytest.mark.slow),
        pytest.param(ALL, id="all", marks=pytest.mark.full),
    ],
)
@pytest.mark.parametrize("figure", ["6.6", "6.7", "6.8"])
def test_more_than_99_percent_learn_flight_within_the_swarm(
    figure: str, sample: Sample, outcomes: Outcomes
) -> None:
    finding = BY_ID[f"{figure}-flight-within"].replace(confidence=ONE_SIDED)
    verdict = judge(finding, outcomes(sample, f"fig-{figure}"))
    assert effect(verdict) > 99
    if sample is ALL:  # few games leave the verdict open
        assert verdict.verdict == HOLDS, str(verdict)


def effect(verdict: Verdict) -> float:
    assert verdict.effect is not None, str(verdict)
    return verdict.effect


@each_sample
def test_table_6_1(sample: Sample, outcomes: Outcomes) -> None:
    verdict = judge(BY_ID["table-6.1"], outcomes(sample, "fig-6.4a"))
    assert effect(verdict) <= TABLE_ERROR, str(verdict)
    assert f"{2 * len(sample.densities)} cells" in verdict.note


@pytest.mark.full
@pytest.mark.parametrize("figure", ["6.4a", "6.4b"])
def test_the_more_robots_the_more_learn_to_attack(figure: str, outcomes: Outcomes) -> None:
    verdict = judge(BY_ID[f"table-6.1-rises-{figure}"], outcomes(ALL, f"fig-{figure}"))
    assert verdict.verdict == HOLDS, str(verdict)
    assert effect(verdict) > 0.8


@each_sample
@pytest.mark.parametrize("scenario", ["fig-6.4a", "fig-6.4b"])
def test_few_learn_to_attack_at_low_density_and_most_at_high_density(
    scenario: str, sample: Sample, outcomes: Outcomes
) -> None:
    policies = outcomes(sample, scenario).policies
    assert policies is not None
    few, *_, many = learned_shares(policies, [scenario])["measured"]
    assert few < 10
    assert many > 60
