"""Judging: results for each verdict of each kind of claim."""

import math
from collections.abc import Sequence

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from kswarms.agents.common.errors import InputError
from kswarms.analysis.findings import FAILS, FINDINGS, HOLDS, NO_DATA, UNDECIDED, Verdict, judge_all
from kswarms.analysis.findings.claims import Agreement, Claim, Compare, Overtake, Peak, Share, Trend
from kswarms.analysis.findings.quantity import Quantity
from kswarms.analysis.findings.verdicts import Region
from kswarms.analysis.results.published import table_6_1
from kswarms.analysis.results.runs import Results
from kswarms.analysis.statistics import intervals
from kswarms.analysis.statistics.intervals import Interval
from tests.helpers.synthetic_results import (
    BEHIND,
    DENSITIES,
    FAR,
    LEARNED,
    LEVEL,
    MIXED,
    NEAR,
    S1,
    S2,
    TIE,
    duel,
    learners,
    more,
    policies,
    runs,
    verdict_on,
)

WITHIN = Quantity(measure="learned_flight_within", scenario="fig-6.8", swarm=2)


@pytest.mark.parametrize(
    ("claim", "lead", "expected"),
    [
        (more(">"), FAR, HOLDS),
        (more(">"), TIE, UNDECIDED),
        (more(">"), BEHIND, FAILS),
        (more(">"), MIXED, FAILS),
        (more(">", margin=4), FAR, HOLDS),
        (more(">", margin=5), FAR, UNDECIDED),
        (more(">", margin=8), FAR, FAILS),
        (more(">="), FAR, HOLDS),
        (more(">="), TIE, UNDECIDED),
        (more(">=", margin=3), TIE, HOLDS),
        (more(">=", margin=3), BEHIND, FAILS),
        (more("<"), BEHIND, HOLDS),
        (more("<"), TIE, UNDECIDED),
        (more("<"), FAR, FAILS),
        (more("<="), BEHIND, HOLDS),
        (more("<=", margin=3), TIE, HOLDS),
        (more("<=", margin=3), FAR, FAILS),
        (more("within", margin=3), TIE, HOLDS),
        (more("within", margin=5), FAR, UNDECIDED),
        (more("within", margin=3), FAR, FAILS),
        (more("within", margin=3), BEHIND, FAILS),
        (more(">", over="mean over N"), MIXED, HOLDS),
        (more(">", over="mean over N"), TIE, UNDECIDED),
        (more(">", over="mean over N"), BEHIND, FAILS),
        (more(">", over="mean over N", margin=4), MIXED, FAILS),
        (more(">", over="sum over N", margin=10), MIXED, HOLDS),
        (more(">", over="sum over N", margin=20), MIXED, FAILS),
        (more(">", over="sum over N"), TIE, UNDECIDED),
        (more(">", densities=(6, 30)), MIXED, HOLDS),
        (more(">", densities=(50,)), MIXED, FAILS),
        (more(">", right=15.0), FAR, UNDECIDED),
        (more(">", right=13.0), FAR, HOLDS),
        (more("<", right=13.0), FAR, FAILS),
        (Overtake(ahead=S2, behind=S1, between=(16, 30)), [-5, -5, 5, 5, 5], HOLDS),
        (Overtake(ahead=S2, behind=S1, between=(30, 40)), [-5, -5, 5, 5, 5], FAILS),
        (Overtake(ahead=S2, behind=S1, between=(16, 30)), [-5, -5, 0, 5, 5], UNDECIDED),
        (Overtake(ahead=S2, behind=S1, between=(16, 30)), FAR, FAILS),
        (Overtake(ahead=S2, behind=S1, between=(16, 30)), BEHIND, FAILS),
        (Overtake(ahead=S2, behind=S1, between=(16, 30)), TIE, UNDECIDED),
        (Peak(quantity=S2), [0, 5, 9, 5, 0], HOLDS),
        (Peak(quantity=S2), [0, 3, 6, 9, 12], FAILS),
        (Peak(quantity=S2), [12, 9, 6, 3, 0], FAILS),
        (Peak(quantity=S2), [5, 3, 0, 3, 5], FAILS),
        (Peak(quantity=S2), TIE, UNDECIDED),
        (Trend(quantity=S2), [0, 3, 6, 9, 12], HOLDS),
        (Trend(quantity=S2), [12, 9, 6, 3, 0], FAILS),
        (Trend(quantity=S2), [0, 0.1, 0, 0.1, 0], UNDECIDED),
        (Trend(quantity=S2, above=0.9), [0, 3, 2.9, 9, 12], UNDECIDED),
    ],
    ids=str,
)
def test_each_kind_of_claim_about_runs_has_each_verdict(
    claim: Claim, lead: Sequence[float], expected: str
) -> None:
    verdict = verdict_on(claim, duel(lead))
    assert verdict.verdict == expected, str(verdict)
    assert verdict.seeds == 10


@pytest.mark.parametrize(
    ("shares", "scale", "expected"),
    [([0.0] * 5, 0.0, HOLDS), ([0.05] * 5, 0.01, FAILS), ([0.01] * 5, 0.005, UNDECIDED)],
)
def test_a_share_of_robots_has_each_verdict(shares: Sequence[float], scale: float, expected: str) -> None:
    results = learners(shares, scenario="fig-6.8", opponent=2, scale=scale)
    verdict = verdict_on(Share(quantity=WITHIN, above=99), results)
    assert verdict.verdict == expected, str(verdict)
    assert verdict.unit == "% of robots"


def test_a_few_robots_that_all_attack_do_not_prove_a_high_share() -> None:
    # 3 robots in each of 10 games: the exact binomial interval of 30 out of 30 starts at 88 %.
    results = learners([0.0], scenario="fig-6.8", opponent=2, densities=(6,))
    verdict = verdict_on(Share(quantity=WITHIN, above=99), results)
    assert (verdict.verdict, verdict.effect, verdict.high) == (UNDECIDED, 100.0, 100.0)
    assert verdict.low == pytest.approx(100 * 0.025 ** (1 / 30))
    assert "30 of 30 robots" in verdict.note


def test_robots_of_a_game_are_not_independent() -> None:
    # All robots attack in half of the games: the same share, but fewer independent observations.
    results = learners([0.5], densities=(50,), scale=0.0)
    assert results.policies is not None
    together = results.policies.assign(attack_share=results.policies["seed"] % 2)
    claim = Share(quantity=LEARNED, above=0)
    one, other = verdict_on(claim, results), verdict_on(claim, Results(results.runs, together))
    assert one.effect == other.effect == 50.0
    assert one.low is not None
    assert other.low is not None
    assert other.low < one.low - 10


TABLE = table_6_1().set_index("n")["fig_6_4a_attack_pct"]
PUBLISHED = [TABLE[n] / 100 for n in DENSITIES]


@pytest.mark.parametrize(("off", "expected"), [(0.0, HOLDS), (0.03, HOLDS), (0.05, UNDECIDED), (0.2, FAILS)])
def test_agreement_with_the_published_table_has_each_verdict(off: float, expected: str) -> None:
    results = learners([share + off for share in PUBLISHED], scale=0.02)
    verdict = verdict_on(Agreement(cells=(LEARNED,), margin=5), results)
    assert verdict.verdict == expected, str(verdict)
    assert verdict.effect == pytest.approx(100 * off, abs=1e-9)
    assert "5 cells" in verdict.note


@pytest.mark.parametrize(
    ("claim", "note"),
    [
        (more(right=Quantity(scenario="other", swarm=1)), "no runs of other S1"),
        (more(left=Quantity(scenario="duel", condition="x", swarm=3)), "no runs of duel condition 'x' S3"),
        (more(densities=(26, 46)), "no runs at N = 26, 46"),
        (Overtake(ahead=S2, behind=S1, between=(30, 36)), "no runs at N = 36"),
        (Peak(quantity=S2, densities=(6, 16)), "N = 6, 16: rise and fall need three densities"),
        (Trend(quantity=S2, densities=(6, 16)), "N = 6, 16: a trend needs three densities"),
        (Share(quantity=WITHIN, above=99), "no runs of fig-6.8 S2 (learned_flight_within)"),
        (Agreement(cells=(LEARNED,), margin=5), "no runs of fig-6.4a S2 (learned_attack)"),
    ],
    ids=str,
)
def test_missing_games_are_noted(claim: Claim, note: str) -> None:
    assert verdict_on(claim, duel(FAR)) == Verdict("it", "It is so.", NO_DATA, note=note)


def test_densities_without_published_numbers_are_noted() -> None:
    verdict = verdict_on(Agreement(cells=(LEARNED,), margin=5), learners([0.0], densities=(8,)))
    assert (verdict.verdict, verdict.note) == (NO_DATA, "nothing published at N = 8")


def test_scenarios_played_at_different_densities_cannot_be_compared() -> None:
    other = runs([LEVEL[:2]], densities=(8, 18), scenario="other")
    results = Results(pd.concat([duel(FAR).runs, other]))
    verdict = verdict_on(more(right=Quantity(scenario="other", swarm=1)), results)
    assert (verdict.verdict, verdict.note) == (NO_DATA, "no runs at the same N")


@pytest.mark.parametrize(
    ("over", "note"),
    [
        ("each N", "no seed with both sides at N = 6, 16, 30, 40, 50"),
        ("mean over N", "no seed with all of N = 6, 16, 30, 40, 50"),
    ],
)
def test_different_seeds_are_not_paired(over: str, note: str) -> None:
    other = runs([LEVEL], scenario="other").assign(seed=lambda rows: rows["seed"] + 100)
    results = Results(pd.concat([duel(FAR).runs, other]))
    verdict = verdict_on(more(right=Quantity(scenario="other", swarm=1), over=over), results)
    assert (verdict.verdict, verdict.note) == (NO_DATA, note)


@pytest.mark.parametrize("lead", [FAR, NEAR, TIE, BEHIND, MIXED], ids=str)
@pytest.mark.parametrize(("relation", "reverse"), [(">", "<"), (">=", "<="), ("within", "within")])
def test_exchanging_the_sides_changes_only_the_sign(
    lead: Sequence[float], relation: str, reverse: str
) -> None:
    there = verdict_on(more(relation, margin=0.5), duel(lead))
    back = verdict_on(more(reverse, margin=0.5, left=S1, right=S2), duel(lead))
    assert there.verdict == back.verdict
    assert there.effect == pytest.approx(-back.effect if back.effect is not None else None)


def test_the_order_of_rows_does_not_matter() -> None:
    results = duel(NEAR)
    shuffled = Results(results.runs.sample(frac=1, random_state=1))
    for claim in (more(), more(over="sum over N"), Overtake(ahead=S2, behind=S1, between=(16, 30))):
        assert verdict_on(claim, shuffled) == verdict_on(claim, results)


@pytest.mark.slow
def test_a_tie_fails_in_at_most_5_percent_of_cases(monkeypatch: pytest.MonkeyPatch) -> None:
    """For equal curves, "at least as much at every N" is true and "more at every N" is false."""
    monkeypatch.setattr(intervals, "RESAMPLES", 1999)  # enough to count, in a fifth of the time
    at_least, clearly = [], []
    for seed in range(60):
        draws = np.random.default_rng(seed).normal(size=(10, 4))
        rows = runs([LEVEL[:4], LEVEL[:4]], DENSITIES[:4], scale=0.0)
        of_s2 = rows["swarm"] == 2
        rows.loc[of_s2, "pucks"] += draws.ravel()
        at_least.append(verdict_on(more(">="), Results(rows)).verdict)
        clearly.append(verdict_on(more(">"), Results(rows)).verdict)
    assert at_least.count(FAILS) <= stats.binom.ppf(0.999, 60, 0.05)
    assert clearly.count(HOLDS) == 0  # probability 1 / 40 at one density


def test_duplicate_games_are_refused() -> None:
    results = duel(FAR)
    with pytest.raises(InputError, match="runs='duel': must have one row for each"):
        verdict_on(more(), Results(pd.concat([results.runs, results.runs])))


def test_policies_without_games_are_refused() -> None:
    results = Results(duel(FAR).runs, policies([0.0] * 5))
    with pytest.raises(InputError, match=r"runs='fig-6\.4a': must have the games"):
        verdict_on(Share(quantity=LEARNED, above=50), results)


def test_an_opponent_must_be_named_among_several() -> None:
    both = pd.concat([policies([0.0] * 5), policies([1.0] * 5, opponent=3)])
    results = Results(learners([0.0] * 5).runs, both)
    claim = Compare(left=LEARNED, relation="<", right=50.0)
    with pytest.raises(InputError, match=r"opponent=None: must be one of 1, 3 in fig-6\.4a"):
        verdict_on(claim, results)
    for opponent, expected in ((1, HOLDS), (3, FAILS)):
        named = claim.replace(left=LEARNED.replace(opponent=opponent))
        assert verdict_on(named, results).verdict == expected


def test_findings_without_runs_have_no_data() -> None:
    verdicts = judge_all(duel(FAR))
    assert [verdict.finding for verdict in verdicts] == [finding.id for finding in FINDINGS]
    assert {verdict.verdict for verdict in verdicts} == {NO_DATA}


def test_a_region_classifies_intervals() -> None:
    above, within = Region(0, math.inf, closed=False), Region(-1, 1)
    assert above.verdict(Interval(0.0, 0.0, 0.0)) == FAILS
    assert above.verdict(Interval(1.0, 0.0, 2.0)) == UNDECIDED
    assert above.verdict(Interval(1.0, 0.1, 2.0)) == HOLDS
    assert within.verdict(Interval(0.0, -1.0, 1.0)) == HOLDS
    assert within.verdict(Interval(1.0, 1.0, 1.5)) == UNDECIDED
    assert within.verdict(Interval(1.2, 1.1, 1.5)) == FAILS
    assert within.verdict(Interval(0.0, -math.inf, math.inf)) == UNDECIDED
