"""Numbers, units, seeds and notes of verdicts."""

import pytest

from kswarms.analysis.findings import FAILS, HOLDS, NO_DATA, UNDECIDED, Verdict
from kswarms.analysis.findings.claims import Claim, Compare, Overtake, Peak, Trend
from kswarms.analysis.findings.quantity import Quantity
from kswarms.analysis.results.runs import Results
from tests.helpers.synthetic_results import BEHIND, FAR, S1, S2, TIE, duel, more, verdict_on

BOTH = Quantity(scenario="duel")
OVERTAKE = Overtake(ahead=S2, behind=S1, between=(16, 30))


def test_a_verdict_at_every_density_shows_the_weakest_density() -> None:
    verdict = verdict_on(more(), duel([5, 3, 5, 5, 5]))
    assert verdict.effect == pytest.approx(3)
    assert verdict.low is not None
    assert verdict.high is not None
    assert 0 < verdict.low < 3 < verdict.high
    assert verdict.note == "N = 6, 16, 30, 40, 50; effect at N = 16, where the claim is weakest"
    failed = verdict_on(more(), duel([5, -4, 5, -9, 5]))
    assert failed.effect == pytest.approx(-9)
    assert failed.note.endswith("false at N = 16, 40")


def test_a_verdict_is_one_line_of_text() -> None:
    verdict = Verdict("it", "It is so.", HOLDS, 1.25, 0.5, 2.0, "pucks", 8, "N = 6")
    assert str(verdict) == "it holds: 1.25 pucks (0.5 … 2); 8 seeds; N = 6"
    open_ended = Verdict("it", "It is so.", UNDECIDED, 36.125, 30.0, None, "robots", 8, "N = 6, 50")
    assert str(open_ended) == "it undecided: 36.12 robots (30 … –); 8 seeds; N = 6, 50"
    unknown = Verdict("it", "It is so.", NO_DATA, note="no runs of fig-6.1a")
    assert str(unknown) == "it no data; 0 seeds; no runs of fig-6.1a"


def test_an_undecided_verdict_says_how_many_seeds_would_decide() -> None:
    verdict = verdict_on(more(), duel([5, 0.5, 5, 5, 5]))
    assert verdict.verdict == UNDECIDED
    assert "true at N = 6, 30, 40, 50" in verdict.note
    assert "more seeds decide (power 80%)" in verdict.note
    assert "no number of seeds decides" in verdict_on(more(over="mean over N"), duel(TIE)).note


def test_a_missing_density_is_named() -> None:
    verdict = verdict_on(more(densities=(6, 26, 30)), duel(FAR))
    assert (verdict.verdict, verdict.note.split("; ")[1]) == (HOLDS, "without N = 26")


CLAIMS = [more(), more(over="mean over N"), OVERTAKE, Peak(quantity=S2), Trend(quantity=S2)]


@pytest.mark.parametrize("claim", CLAIMS, ids=str)
def test_too_few_seeds_give_no_decision(claim: Claim) -> None:
    verdict = verdict_on(claim, duel([-9, 9, 99, 9, 9], seeds=4))
    assert (verdict.verdict, verdict.low, verdict.high, verdict.seeds) == (UNDECIDED, None, None, 4)
    assert verdict.note.endswith("seeds")


def test_failing_at_one_of_many_densities_needs_more_seeds() -> None:
    # Six seeds suffice for 95 %, but five densities need 99 %, so eight.
    assert verdict_on(more(), duel(BEHIND, seeds=7)).verdict == UNDECIDED
    assert verdict_on(more(), duel(BEHIND, seeds=8)).verdict == FAILS
    assert verdict_on(more(densities=(6,)), duel(BEHIND, seeds=6)).verdict == FAILS


def test_a_single_seed_has_an_effect_without_interval() -> None:
    verdict = verdict_on(more(over="mean over N"), duel(FAR, seeds=1))
    assert (verdict.verdict, verdict.effect, verdict.low) == (UNDECIDED, 5.0, None)


def test_an_uncertain_lead_at_either_end_is_noted() -> None:
    verdict = verdict_on(OVERTAKE, duel([1, 1, 1, 1, 0.5]))
    assert (verdict.verdict, verdict.low, verdict.high) == (UNDECIDED, None, None)
    assert "possibly ahead from N = 6 on" in verdict.note
    assert "possibly not ahead at N = 50" in verdict.note
    assert "the mean curves do not cross" in verdict_on(OVERTAKE, duel(FAR)).note


def test_only_common_seeds_are_compared() -> None:
    results = duel(FAR)
    kept = (results.runs["swarm"] == 1) | (results.runs["seed"] >= 2) | (results.runs["n"] != 16)
    verdict = verdict_on(more(), Results(results.runs[kept]))
    assert (verdict.verdict, verdict.seeds) == (HOLDS, 8)


@pytest.mark.parametrize(
    ("measure", "expected", "unit"),
    [
        ("time_in_conflict", 40.0, "% of time"),
        ("time_inter", 30.0, "% of time"),
        ("time_intra", 10.0, "% of time"),
        ("conflicts_inter", 10.0, "conflicts"),
        ("conflicts_intra", 6.0, "conflicts"),
        ("pucks", 20.0, "pucks"),
    ],
)
def test_measures_of_all_swarms_are_sums(measure: str, expected: float, unit: str) -> None:
    claim = Compare(left=BOTH.replace(measure=measure), relation=">", right=0.0, over="mean over N")
    verdict = verdict_on(claim, duel(TIE))
    assert (verdict.effect, verdict.unit) == (pytest.approx(expected), unit)


def test_a_difference_of_percentages_is_in_percentage_points() -> None:
    claim = more(left=S2.replace(measure="time_inter"), right=S2.replace(measure="time_intra"))
    verdict = verdict_on(claim, duel(TIE))
    assert (verdict.effect, verdict.unit, verdict.verdict) == (pytest.approx(20), "percentage points", HOLDS)
