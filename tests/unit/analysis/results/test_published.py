"""Published numbers are complete and agree with their sources."""

import pytest

from kswarms.analysis.results.published import (
    argos_fixed_policies,
    learned_percentages,
    table_6_1,
    table_6_2,
    table_6_3,
)

DENSITIES = [6, 10, 16, 20, 26, 30, 36, 40, 46, 50]


def test_table_6_1_has_the_published_numbers() -> None:
    table = table_6_1()
    assert list(table.columns) == ["n", "fig_6_4a_attack_pct", "fig_6_4b_attack_pct"]
    assert list(table["n"]) == DENSITIES
    assert list(table["fig_6_4a_attack_pct"]) == [1.6, 2, 2.5, 7.5, 31.9, 61, 97.7, 99.7, 100, 100]
    assert list(table["fig_6_4b_attack_pct"]) == [1.6, 0, 1.2, 0, 3, 7.3, 26.3, 55.5, 65.2, 75.6]


def test_table_6_2_has_the_published_numbers() -> None:
    table = table_6_2()
    assert list(table.columns) == ["n", "inter_attack_pct", "intra_avoid_pct"]
    assert list(table["n"]) == DENSITIES
    assert list(table["inter_attack_pct"]) == [0, 1, 1.8, 1.5, 15.7, 37.6, 56.9, 71.25, 75.4, 77.8]
    assert table["intra_avoid_pct"].min() == 99.4


def test_table_6_3_has_the_published_numbers() -> None:
    table = table_6_3()
    assert list(table.columns) == ["n", "d0.02", "d0.08", "d0.125", "d0.2", "d0.25"]
    assert list(table["n"]) == DENSITIES
    assert table["d0.02"].max() == 0
    assert list(table["d0.125"]) == [1.6, 1, 2.5, 2, 11.5, 33.3, 51.1, 49.25, 58.2, 56.4]
    assert list(table["d0.25"]) == [8.3, 18, 29.3, 35.5, 47.6, 57.6, 65, 64, 72.6, 78.4]


def test_the_learned_percentages_combine_all_tables() -> None:
    table = learned_percentages()
    columns = table.set_index(["scenario", "condition", "learned", "n"])["published"].sort_index()
    assert len(columns) == 90
    assert columns["fig-6.4a", "", "attack"].tolist() == table_6_1()["fig_6_4a_attack_pct"].tolist()
    assert columns["fig-6.4b", "", "attack", 36] == 26.3
    assert columns["fig-6.8", "", "attack", 40] == 71.25
    assert columns["fig-6.8", "", "flight within", 50] == 99.4
    assert columns["fig-6.12", "delta=0.2", "attack", 46] == 69.1


def test_there_are_ten_argos_games_of_each_kind_with_600_s_for_each_robot() -> None:
    games = argos_fixed_policies()
    sizes = games.groupby(["s1_policy", "s2_policy", "n"])["seed"].nunique()
    assert len(sizes) == 15
    assert set(sizes) == {10}
    for swarm in ("1", "2"):
        lived = games["ta_intra" + swarm] + games["ta_inter" + swarm] + games["tp" + swarm]
        assert lived.to_numpy() == pytest.approx(600 * games["n"].to_numpy() / 2, abs=0.2)


def test_the_mean_scores_of_argos_match_its_description() -> None:
    games = argos_fixed_policies()
    avoid = games[(games["s1_policy"] == "avoid") & (games["s2_policy"] == "avoid")].groupby("n")["score1"]
    assert avoid.mean().tolist() == pytest.approx([17.5, 26.0, 19.1, 12.5, 8.9])
    attack = games[(games["s1_policy"] == "avoid") & (games["s2_policy"] == "attack")].groupby("n")["score2"]
    assert attack.mean().tolist() == pytest.approx([14.5, 26.7, 29.5, 28.9, 25.3])
