"""Tables of the means over the seeds, a row for each density."""

import pytest

from kswarms.agents.common.errors import InputError
from kswarms.analysis.tables.scores import scores, scores_table
from tests.helpers.result_rows import runs_of


def test_scores_are_the_numbers_of_the_figure() -> None:
    pucks = scores(runs_of("fig-x"), "fig-x")
    assert pucks["quantity"].unique().tolist() == ["pucks"]
    assert pucks[pucks["curve"] == "S2: attack"]["mean"].tolist() == [26, 36, 46]
    sud = scores(runs_of("fig-6.12", conditions=("a", "b")), "fig-6.12")
    assert sud["curve"].unique().tolist() == ["a", "b"]
    assert sud["mean"].tolist() == [-14, -4, 6, 86, 96, 106]
    shares = scores(runs_of("fig-6.3"), "fig-6.3")
    means = shares.groupby(["quantity", "curve"])["mean"].first()
    kinds = [
        (kind, curve)
        for kind in ("inter-swarm", "intra-swarm", "total")
        for curve in ("S1: avoid", "S2: attack")
    ]
    assert means.index.tolist() == kinds
    assert (400 * means).tolist() == pytest.approx([20, 40, 10, 20, 30, 60])


def test_scores_need_runs_of_the_scenario() -> None:
    with pytest.raises(InputError, match=r"scenario='fig-9': must be one of fig-x"):
        scores(runs_of("fig-x"), "fig-9")


def test_the_table_has_a_row_for_each_density_and_a_dash_for_a_missing_mean() -> None:
    runs = runs_of("fig-x", conditions=("a", "b"), swarms=(2,), seeds=8)
    table = scores_table(scores(runs[(runs["condition"] == "a") | (runs["n"] == 6)], "fig-x"))
    assert table.header == ["N", "a", "b"]
    assert table.rows == [
        ["6", "26.0 (25.2 … 26.8)", "126.0 (125.2 … 126.8)"],
        ["16", "36.0 (35.2 … 36.8)", "–"],
        ["26", "46.0 (45.2 … 46.8)", "–"],
    ]
    assert table.caption == "pucks deposited by the swarm; mean of 8 seeds (95 % interval)"
    one = scores_table(scores(runs_of("fig-6.3", seeds=1), "fig-6.3"))
    assert one.header[:3] == ["N", "S1: avoid\ntotal", "S2: attack\ntotal"]
    assert one.rows[0][1:3] == ["0.075", "0.150"]
    assert one.caption == "share of time in conflict; one seed"
    some = runs[(runs["n"] != 6) | (runs["seed"] == 0)]
    caption = scores_table(scores(some, "fig-x")).caption
    assert "mean of 1 to 8 seeds (95 % interval of 6 seeds or more)" in caption
