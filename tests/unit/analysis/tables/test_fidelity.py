"""Comparison of synthetic runs with ARGoS."""

from collections.abc import Sequence

import pandas as pd
import pytest
from scipy import stats

from kswarms.agents.common.errors import InputError
from kswarms.analysis.results.published import argos_fixed_policies
from kswarms.analysis.tables.fidelity import compare_with_argos, markdown_table


def runs_of(
    pucks: Sequence[int], share: float = 0.3, scenario: str = "argos-avoid-avoid", n: int = 16, swarm: int = 1
) -> pd.DataFrame:
    """Return a row of `runs.parquet` for each score, with the same share of time in conflict."""
    lived = 600 * n / 2
    times = {"t_a_intra": 0.25 * share * lived, "t_a_inter": 0.75 * share * lived, "t_p": (1 - share) * lived}
    point = {"scenario": scenario, "n": n, "seed": range(len(pucks)), "swarm": swarm}
    return pd.DataFrame({**point, "pucks": pucks, **times})


def argos(first: str, second: str, n: int) -> pd.DataFrame:
    games = argos_fixed_policies()
    return games[(games["s1_policy"] == first) & (games["s2_policy"] == second) & (games["n"] == n)]


def only_row(runs: pd.DataFrame) -> pd.Series:
    frame = compare_with_argos(runs)
    assert len(frame) == 1
    return frame.iloc[0]


def own_form(games: pd.DataFrame) -> pd.DataFrame:
    """Return ARGoS games in the form of `runs.parquet`."""
    scenario = "argos-" + games["s1_policy"] + "-" + games["s2_policy"]
    columns = {"score": "pucks", "ta_intra": "t_a_intra", "ta_inter": "t_a_inter", "tp": "t_p"}
    return pd.concat(
        games.rename(columns={f"{theirs}{k}": ours for theirs, ours in columns.items()})
        .filter(["n", *columns.values()])
        .assign(scenario=scenario, swarm=k)
        for k in (1, 2)
    )


def test_argos_games_agree_with_themselves() -> None:
    frame = compare_with_argos(own_form(argos_fixed_policies()))
    assert len(frame) == 3 * 5 * 2
    assert frame["score_difference"].to_numpy() == pytest.approx(0)
    assert frame["share_difference"].to_numpy() == pytest.approx(0)
    assert frame["score_fits"].all()
    assert frame["share_fits"].all()


def test_the_first_policy_in_the_id_belongs_to_s1() -> None:
    games = argos("avoid", "attack", 36)
    frame = compare_with_argos(own_form(games)).set_index("swarm")
    assert frame["score_theirs"].to_dict() == pytest.approx({1: 34.3, 2: 28.9})
    lived = 600 * 18
    expected = ((games["ta_intra2"] + games["ta_inter2"]) / lived).mean()
    assert frame.loc[2, "share_theirs"] == pytest.approx(expected, abs=1e-4)


def test_the_score_interval_is_welchs() -> None:
    pucks = [20, 31, 25, 28, 27, 24]
    row = only_row(runs_of(pucks))
    theirs = argos("avoid", "avoid", 16)["score1"]
    expected = stats.ttest_ind(pucks, theirs, equal_var=False).confidence_interval(0.95)
    assert (row["score_low"], row["score_high"]) == pytest.approx((expected.low, expected.high))
    assert row["score_difference"] == pytest.approx(sum(pucks) / 6 - 26.0)
    assert row["score_relative"] == pytest.approx((sum(pucks) / 6 - 26.0) / 26.0)
    assert (row["seeds_ours"], row["seeds_theirs"]) == (6, 10)


# ARGoS: avoid/avoid S1 at N = 16 scores 26.0.
@pytest.mark.parametrize(
    ("pucks", "fits"),
    [
        ([31] * 20, True),  # +19 %, though 5 pucks, far outside the interval
        ([32] * 20, False),  # +23 %
        ([21] * 20, True),  # -19 %
        ([20] * 20, False),  # -23 %
        ([10, 60, 35, 20, 55], True),  # +38 %, 10 pucks, but the interval contains 0
    ],
)
def test_a_score_agrees_by_relative_difference_or_interval(pucks: list[int], fits: bool) -> None:
    row = only_row(runs_of(pucks))
    assert bool(row["score_fits"]) is fits


@pytest.mark.parametrize(("more", "fits"), [(1.5, True), (1.6, False)])
def test_a_low_score_agrees_by_difference_in_pucks(more: float, fits: bool) -> None:
    # Here 2.2 - 0.7 is more than 1.5 in floating point.
    theirs = argos("attack", "attack", 26)["score1"].mean()
    assert theirs == pytest.approx(0.7)
    tenths = round(10 * (theirs + more))
    pucks = [tenths // 10 + (game < tenths % 10) for game in range(10)] * 5
    row = only_row(runs_of(pucks, scenario="argos-attack-attack", n=26))
    assert row["score_difference"] == pytest.approx(more)
    assert row["score_low"] > 0
    assert abs(row["score_difference"]) > 0.2 * theirs
    assert bool(row["score_fits"]) is fits


@pytest.mark.parametrize(("off", "fits"), [(0.06, True), (-0.06, True), (0.061, False), (-0.061, False)])
def test_a_share_of_time_agrees_within_its_tolerance(off: float, fits: bool) -> None:
    games = argos("avoid", "avoid", 16)
    in_conflict = games["ta_intra1"] + games["ta_inter1"]
    share = (in_conflict / (in_conflict + games["tp1"])).mean()
    row = only_row(runs_of([26] * 5, share=share + off))
    assert row["share_difference"] == pytest.approx(off)
    assert bool(row["share_fits"]) is fits


def test_a_single_game_has_no_interval() -> None:
    row = only_row(runs_of([60]))
    assert pd.isna(row["score_low"])
    assert not row["score_fits"]


def test_constant_scores_have_an_interval_of_width_0(monkeypatch: pytest.MonkeyPatch) -> None:
    constant = argos("avoid", "avoid", 16).assign(score1=0)
    monkeypatch.setattr("kswarms.analysis.tables.fidelity.argos_fixed_policies", lambda: constant)
    row = only_row(runs_of([3, 3, 3]))
    assert (row["score_low"], row["score_high"]) == (3, 3)
    assert not row["score_fits"]
    assert pd.isna(row["score_relative"])
    assert only_row(runs_of([0, 0, 0]))["score_fits"]
    assert "| – |" in markdown_table(compare_with_argos(runs_of([3, 4])))  # no difference relative to 0


def test_other_scenarios_and_densities_are_left_out() -> None:
    runs = pd.concat([runs_of([26, 27]), runs_of([26, 27], scenario="fig-6.1a"), runs_of([9, 8], n=10)])
    row = only_row(runs)
    assert (row["scenario"], row["n"], row["swarm"]) == ("argos-avoid-avoid", 16, 1)


def test_runs_without_argos_games_are_refused() -> None:
    expected = r"fig-6\.1a.*must include argos-attack-attack, .* N = 6, 16, 26, 36, 46"
    with pytest.raises(InputError, match=expected):
        compare_with_argos(runs_of([26, 27], scenario="fig-6.1a"))


def test_markdown_has_the_numbers_of_the_frame() -> None:
    frame = compare_with_argos(pd.concat([runs_of([26] * 3), runs_of([60], share=0.9, swarm=2)]))
    head, rule, first, second = markdown_table(frame).splitlines()
    assert head.count("|") == rule.count("|") == first.count("|") == second.count("|")
    cells = [cell.strip() for cell in first.strip("|").split("|")]
    assert cells[:5] == ["argos-avoid-avoid", "16", "S1", "26.0", "26.0"]
    assert cells[5].startswith("+0.0 (-")
    assert cells[6:8] == ["+0 %", "yes"]
    cells = [cell.strip() for cell in second.strip("|").split("|")]
    assert cells[5] == "+35.1"
    assert cells[7] == cells[11] == "**no**"
