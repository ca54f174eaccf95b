"""Statistics of contributions with known answers."""

from typing import Any

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from kswarms.agents.common.errors import InputError
from kswarms.analysis.figures.contribution import contribution_figure
from kswarms.analysis.measures.contribution import (
    freed_time,
    mean_contributions,
    measures_with_values,
    rank_correlations,
    select_contributions,
    time_sud,
)
from kswarms.analysis.measures.utilities import robot_utilities, utilities_by_swarm
from kswarms.analysis.statistics.curves import spearman
from kswarms.analysis.statistics.intervals import bootstrap_interval
from tests.helpers.contribution_rows import ROBOTS, SEEDS, contribution_rows, noise


def test_a_contribution_is_the_sud_minus_the_sud_without_the_robot() -> None:
    suds = {"sud": 7, "sud_without": [[3] * 4 + [9] * 4], "time_sud": 1.5, "time_sud_without": 2.0}
    rows = select_contributions(contribution_rows(**suds))
    assert set(rows["pucks"]) == {4.0, -2.0}
    assert set(rows["time"]) == {-0.5}
    assert set(rows["reward_rate"]) == {0.1}
    assert select_contributions(contribution_rows(reward_time=0.0))["reward_rate"].isna().all()


def test_columns_with_several_values_need_a_selection() -> None:
    several = pd.concat([contribution_rows(), contribution_rows(n=26, sud=5)])
    assert set(select_contributions(several, n=26)["pucks"]) == {5.0}
    with pytest.raises(InputError, match=r"n=None: must be one of 16, 26"):
        select_contributions(several)
    with pytest.raises(InputError, match=r"scenario='fig-6.1': must be one of 'fig-6.4b'"):
        select_contributions(several, n=26, scenario="fig-6.1")


def test_means_have_bootstrap_intervals_over_the_seeds() -> None:
    contribution = noise(5.0) + np.arange(ROBOTS)
    found = mean_contributions(select_contributions(contribution_rows(time_sud=contribution)))
    assert found["robot"].tolist() == [*range(20, 28), -1]
    for k, row in enumerate(found.to_dict("records")):
        sample = contribution[:, k] if k < ROBOTS else contribution.mean(axis=1)
        expected = bootstrap_interval(np.sort(sample))
        assert (row["time_low"], row["time_high"]) == pytest.approx((expected.low, expected.high), abs=0.05)
        assert row["time"] == pytest.approx(sample.mean())
        assert row["seeds"] == SEEDS


def test_each_swarm_has_its_own_mean_robot() -> None:
    both = pd.concat([contribution_rows(swarm=1, sud=3), contribution_rows(swarm=2, sud=-1)])
    found = mean_contributions(select_contributions(both))
    assert found[found["robot"] < 0][["swarm", "pucks"]].to_numpy().tolist() == [[1, 3.0], [2, -1.0]]


@pytest.mark.parametrize("seeds", [1, 5])
def test_fewer_than_six_seeds_have_no_interval(seeds: int) -> None:
    sud = noise(shape=(seeds, ROBOTS))
    rows = select_contributions(contribution_rows(seeds=seeds, time_sud=sud, reward=np.arange(8.0)))
    assert mean_contributions(rows)[["time_low", "time_high", "reward_low"]].isna().all(axis=None)
    found = rank_correlations(rows).set_index("measure").loc["time"]
    assert not np.isnan(found["robots"])
    assert np.isnan(found[["robots_low", "robots_high", "games_low"]].tolist()).all()
    assert freed_time(rows)["share_low"].isna().all()


@settings(max_examples=30)
@given(seed=st.integers(0, 10**6), values=st.integers(2, 20), robots=st.integers(3, 12))
def test_spearman_agrees_with_scipy(seed: int, values: int, robots: int) -> None:
    draws = np.random.default_rng(seed)
    both = draws.integers(0, values, size=(2, 4, robots)).astype(float)
    found = spearman(*both)
    for first, second, one in zip(*both, found, strict=True):
        if len(set(first)) > 1 and len(set(second)) > 1:
            assert one == pytest.approx(stats.spearmanr(first, second).statistic)
        else:
            assert np.isnan(one)


@pytest.mark.parametrize("sign", [1, -1])
def test_rewards_in_the_order_of_contributions_have_rank_correlation_1(sign: int) -> None:
    true = np.exp(np.arange(ROBOTS) / 2)
    reward = sign * true**3 + noise(0.1, seed=1)
    rows = select_contributions(contribution_rows(time_sud=true + noise(0.1), reward=reward))
    found = rank_correlations(rows).set_index("measure").loc["time"]
    assert found["robots"] == found["robots_low"] == found["robots_high"] == pytest.approx(sign)
    assert sign * found["games"] > 0.9
    assert -1.0 <= found["games_low"] <= found["games_high"] <= 1.0


def test_a_correlation_within_games_is_not_a_correlation_of_the_means() -> None:
    """Reward and contribution depend on the same noise in each game, but all robots have the same mean."""
    chance = noise(1.0)
    chance -= chance.mean(axis=0)  # all means over the seeds are 0
    sud, reward = chance + noise(0.01, seed=3), chance + noise(0.01, seed=2)
    rows = select_contributions(contribution_rows(time_sud=sud, reward=reward))
    found = rank_correlations(rows).set_index("measure").loc["time"]
    assert found["games"] > 0.95
    assert abs(found["robots"]) < 0.9  # the means are noise


@pytest.mark.slow
def test_intervals_of_independent_quantities_contain_0() -> None:
    """Rewards are independent of contributions: about 5 % of the 80 intervals miss 0."""
    missed = {"robots": 0, "games": 0}
    for repetition in range(80):
        draws = {"time_sud": noise(3.0, 2 * repetition), "reward": noise(2.0, 2 * repetition + 1)}
        found = (
            rank_correlations(select_contributions(contribution_rows(**draws)))
            .set_index("measure")
            .loc["time"]
        )
        for name in missed:
            missed[name] += not found[f"{name}_low"] <= 0 <= found[f"{name}_high"]
    # More than 11 misses of 80 have a probability of 0.1 %; without any, the intervals would be too wide.
    assert 1 <= missed["games"] <= 11
    assert missed["robots"] <= 11  # the bootstrap is conservative here


def test_rank_correlations_need_three_different_robots() -> None:
    assert rank_correlations(select_contributions(contribution_rows(robots=2))).empty
    found = rank_correlations(select_contributions(contribution_rows()))
    assert found["measure"].tolist() == ["pucks", "time"]
    assert found[["robots", "games", "games_low"]].isna().all(axis=None)


def test_missing_measures_are_left_out() -> None:
    rows = select_contributions(contribution_rows(time_sud=np.nan, sud=noise(9.0).round().astype(int)))
    assert measures_with_values(rows) == ["pucks"]
    assert rank_correlations(rows)["measure"].tolist() == ["pucks"]
    assert len(contribution_figure(rows).axes) == 1


@pytest.mark.parametrize("share", [1.0, 0.0, 0.4, -0.3])
def test_the_share_of_conflict_time_that_becomes_program_time(share: float) -> None:
    met = 50.0 + noise(5.0)
    times = {"mates_t_a": 300.0, "mates_t_a_without": 300.0 - share * met, "mates_t_a_met": met}
    times |= {"mates_t_p": 900.0, "mates_t_p_without": 900.0 + share * met}
    rows = select_contributions(contribution_rows(**times))
    found = freed_time(rows).set_index("others").loc["mates"]
    assert found[["share", "share_low", "share_high"]].tolist() == pytest.approx([share] * 3)
    assert found["met"] == pytest.approx(met.mean())
    assert found["t_p_without"] - found["t_p"] == pytest.approx(share * met.mean())


def test_the_interval_of_the_share_widens_with_the_noise() -> None:
    widths = []
    for size in (1.0, 20.0):
        rows = select_contributions(
            contribution_rows(opponents_t_a=200.0 + noise(size), opponents_t_a_without=150.0)
        )
        found = freed_time(rows).set_index("others").loc["opponents"]
        assert found["share_low"] < found["share"] < found["share_high"]
        widths.append(found["share_high"] - found["share_low"])
    assert widths[0] < widths[1] / 10


def test_times_are_scaled_to_the_duration_with_the_robot() -> None:
    rows = select_contributions(
        contribution_rows(mates_t_a=200.0, mates_t_a_without=300.0, duration_without=1200.0)
    )
    found = freed_time(rows).set_index("others").loc["mates"]
    assert (found["t_a_without"], found["t_p_without"], found["share"]) == (150.0, 50.0, 0.5)


def test_the_share_is_missing_without_other_robots_or_meetings() -> None:
    no_mates = {f"mates_{what}": 0.0 for what in ("t_a", "t_a_without", "t_p", "t_p_without", "t_a_met")}
    found = freed_time(select_contributions(contribution_rows(**no_mates, opponents_t_a_met=0.0)))
    assert found["others"].tolist() == ["opponents"]
    assert found[["share", "share_low", "share_high"]].isna().all(axis=None)


def test_time_sud_ignores_the_learning_phase() -> None:
    conflicts: dict[str, list[Any]] = {"phase": ["learning", "game", "game"], "robot": [0, 0, 1]}
    conflicts |= {"swarm": [1, 1, 2], "opponent_swarm": [2, 2, 1], "start": [0.0, 10.0, 11.0]}
    conflicts |= {"t_a": [2.0, 2.0, 3.0], "t_p": [5.0, 6.0, 4.0], "active": [1, 1, 1]}
    conflicts["seen"] = [((), (1,)), ((), (1,)), ((0,), ())]
    found = time_sud(conflicts, 2)
    expected = utilities_by_swarm(robot_utilities(pd.DataFrame(conflicts)))
    assert found == pytest.approx(expected["sud"].tolist())
    assert found[0] == -found[1] != 0
    assert time_sud({name: values[:1] for name, values in conflicts.items()}, 2) == [0.0, 0.0]
