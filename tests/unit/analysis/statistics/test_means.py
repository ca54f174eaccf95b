"""Means and intervals over the seeds, and the tables made of them, on rows whose answers are known."""

import math

import numpy as np
import pandas as pd
import pytest

from kswarms.agents.common.errors import InputError
from kswarms.analysis.statistics.means import summary
from kswarms.analysis.tables.scores import printed, scores
from tests.helpers.result_rows import runs_of


def rows(values: dict[int, list[float]]) -> pd.DataFrame:
    return pd.DataFrame(
        {"n": n, "seed": seed, "value": v} for n, of_n in values.items() for seed, v in enumerate(of_n)
    )


def test_a_point_is_the_mean_with_an_interval_inside_the_seeds() -> None:
    (point,) = summary(rows({6: [1, 2, 3, 4, 5, 6, 7, 8]}), "value", by=()).to_dict("records")
    assert (point["n"], point["seeds"], point["mean"]) == (6, 8, 4.5)
    assert 1 < point["low"] < 4.5 < point["high"] < 8


def test_points_of_different_numbers_of_seeds_keep_their_own() -> None:
    points = summary(rows({6: [1, 3], 10: [5], 16: [2, 2, 2]}), "value", by=())
    assert points["seeds"].tolist() == [2, 1, 3]
    assert points["mean"].tolist() == [2, 5, 2]
    assert [math.isnan(low) for low in points["low"]] == [False, True, False]
    assert (points["low"][2], points["high"][2]) == (2, 2)


def test_curves_are_told_apart_and_the_order_of_rows_does_not_matter() -> None:
    runs = runs_of("fig-x", conditions=("a", "b"), seeds=8)
    runs["pucks"] += np.random.default_rng(3).integers(0, 9, len(runs))
    points = summary(runs, "pucks")
    assert list(points[["condition", "swarm", "n"]].itertuples(index=False, name=None)) == [
        (condition, swarm, n) for condition in "ab" for swarm in (1, 2) for n in (6, 16, 26)
    ]
    pd.testing.assert_frame_equal(points, summary(runs.sample(frac=1, random_state=1), "pucks"))


def test_the_interval_covers_the_true_mean_as_often_as_it_says() -> None:
    draws = np.random.default_rng(1).exponential(size=(400, 20))
    points = summary(rows(dict(enumerate(draws.tolist()))), "value", by=())
    covered = ((points["low"] <= 1) & (points["high"] >= 1)).mean()
    assert 0.90 <= covered <= 0.98  # 95 % ± 3 standard deviations, less what a skewed law costs


def test_scores_are_what_the_figure_of_a_scenario_shows() -> None:
    pucks = scores(runs_of("fig-x"), "fig-x")
    assert pucks["quantity"].unique().tolist() == ["pucks"]
    assert pucks[pucks["curve"] == "S2: attack"]["mean"].tolist() == [26, 36, 46]
    sud = scores(runs_of("fig-6.12", conditions=("a", "b")), "fig-6.12")
    assert sud["curve"].unique().tolist() == ["a", "b"]
    assert sud["mean"].tolist() == [-14, -4, 6, 86, 96, 106]
    shares = scores(runs_of("fig-6.3"), "fig-6.3")
    assert shares.groupby(["quantity", "curve"])["mean"].first().to_dict() == {
        ("inter-swarm", "S1: avoid"): pytest.approx(20 / 400),
        ("inter-swarm", "S2: attack"): pytest.approx(40 / 400),
        ("intra-swarm", "S1: avoid"): pytest.approx(10 / 400),
        ("intra-swarm", "S2: attack"): pytest.approx(20 / 400),
        ("total", "S1: avoid"): pytest.approx(30 / 400),
        ("total", "S2: attack"): pytest.approx(60 / 400),
    }


def test_scores_of_a_scenario_without_runs() -> None:
    with pytest.raises(InputError, match=r"scenario='fig-9': must be one of fig-x"):
        scores(runs_of("fig-x"), "fig-9")


def test_printed_scores_have_a_row_for_each_density_and_a_dash_for_what_is_not_there() -> None:
    runs = runs_of("fig-x", conditions=("a", "b"), swarms=(2,), seeds=2)
    table = printed(scores(runs[(runs["condition"] == "a") | (runs["n"] == 6)], "fig-x"))
    assert table.header == ["N", "a", "b"]
    assert table.rows == [
        ["6", "26.0 (25.0 … 27.0)", "126.0 (125.0 … 127.0)"],
        ["16", "36.0 (35.0 … 37.0)", "–"],
        ["26", "46.0 (45.0 … 47.0)", "–"],
    ]
    assert table.caption == "pucks deposited by the swarm; mean of 2 seeds (95 % bootstrap interval)"
    one = printed(scores(runs_of("fig-6.3", seeds=1), "fig-6.3"))
    assert one.header[:3] == ["N", "S1: avoid\ntotal", "S2: attack\ntotal"]
    assert one.rows[0][1:3] == ["0.075", "0.150"]
    assert one.caption == "share of time in conflict; one seed"
    some = runs[(runs["n"] != 6) | (runs["seed"] == 0)]
    assert "mean of 1 to 2 seeds" in printed(scores(some, "fig-x")).caption
