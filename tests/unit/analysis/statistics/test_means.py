"""Means over the seeds with their intervals, on rows with known answers."""

import math

import numpy as np
import pandas as pd
import pytest

from kswarms.analysis.statistics.intervals import bootstrap_interval
from kswarms.analysis.statistics.means import describe_seeds, mean_by_group
from tests.helpers.result_rows import runs_of


def rows(values: dict[int, list[float]]) -> pd.DataFrame:
    return pd.DataFrame(
        {"n": n, "seed": seed, "value": v} for n, of_n in values.items() for seed, v in enumerate(of_n)
    )


def test_a_point_is_the_mean_with_its_bootstrap_interval() -> None:
    sample = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 9.0]
    (point,) = mean_by_group(rows({6: sample}), ["n"], "value").to_dict("records")
    assert (point["n"], point["seeds"], point["mean"]) == (6, 8, 4.625)
    interval = bootstrap_interval(sample)
    assert (point["low"], point["high"]) == (interval.low, interval.high)


def test_points_keep_their_own_number_of_seeds() -> None:
    points = mean_by_group(rows({6: [1, 3], 10: [5], 16: [2] * 6, 20: [1] * 3 + [2] * 4}), ["n"], "value")
    assert points["seeds"].tolist() == [2, 1, 6, 7]
    assert points["mean"].tolist() == pytest.approx([2, 5, 2, 11 / 7])
    assert [math.isnan(low) for low in points["low"]] == [True, True, False, False]
    assert (points["low"][2], points["high"][2]) == (2, 2)


def test_curves_are_separate_and_the_order_of_rows_does_not_matter() -> None:
    runs = runs_of("fig-x", conditions=("a", "b"), seeds=8)
    runs["pucks"] += np.random.default_rng(3).integers(0, 9, len(runs))
    key = ["condition", "swarm", "n"]
    points = mean_by_group(runs, key, "pucks")
    assert list(points[key].itertuples(index=False, name=None)) == [
        (condition, swarm, n) for condition in "ab" for swarm in (1, 2) for n in (6, 16, 26)
    ]
    pd.testing.assert_frame_equal(points, mean_by_group(runs.sample(frac=1, random_state=1), key, "pucks"))


@pytest.mark.parametrize(
    ("few", "many", "text"),
    [
        (1, 1, "one seed"),
        (4, 4, "mean of 4 seeds"),
        (4, 20, "mean of 4 to 20 seeds (95 % interval of 6 seeds or more)"),
        (20, 20, "mean of 20 seeds (95 % interval)"),
    ],
)
def test_captions_name_seeds_and_interval(few: int, many: int, text: str) -> None:
    assert describe_seeds(few, many) == text
