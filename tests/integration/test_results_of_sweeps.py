"""Games played by a script, with `mesa.batch_run` or as models: results are drawn and judged."""

from typing import Any

import mesa
import pandas as pd
import pytest

from kswarms import Finding, ForagingModel, InputError, figure_of, judge, read_results
from kswarms.analysis.report.report import build_report
from kswarms.analysis.tables.scores import scores

POLICIES = ["avoid,attack", "avoid,avoid"]
GAMES: dict[str, Any] = {"n": [4, 8], "policies": POLICIES, "seed": range(6), "duration": 20.0}


def sweep(**parameters: Any) -> list[dict[str, Any]]:
    rows: list[dict[str, Any]] = mesa.batch_run(
        ForagingModel, GAMES | parameters, number_processes=1, display_progress=False
    )
    return rows


def test_a_sweep_is_drawn_and_judged() -> None:
    results = read_results(sweep(), scenario="crowd")
    assert len(results.runs) == 2 * 2 * 6 * 2
    assert results.policies is None
    assert scores(results.runs, "crowd")["seeds"].unique().tolist() == [6]
    legend = figure_of(results.runs, "crowd").legends[0].get_texts()
    assert legend[0].get_text() == "policies=avoid,attack, S1: avoid"
    claim = {"kind": "compare", "relation": "<=", "right": 10.0}
    claim["left"] = {"scenario": "crowd", "condition": "policies=avoid,avoid", "swarm": 1}
    verdict = judge(Finding(id="few", statement="Few pucks in 20 s.", claim=claim), results)
    assert (verdict.verdict, verdict.seeds) == ("holds", 6)
    page = build_report(results, findings=[]).to_html()
    assert "Report on a sweep" in page
    assert "policies=avoid,attack, S1: avoid" in page


def test_rows_samples_and_models_give_the_same_runs() -> None:
    rows = sweep(seed=[0, 1], policies="avoid,inter-learner", learning=20.0, n=4)
    from_rows = read_results(pd.DataFrame(rows))
    models = [
        ForagingModel(n=4, policies="avoid,inter-learner", learning=20.0, duration=20.0, seed=seed)
        for seed in (0, 1)
    ]
    for model in models:
        model.play()
    from_models = read_results(models)
    pd.testing.assert_frame_equal(from_rows.runs, from_models.runs)
    assert from_models.policies is not None
    assert set(from_models.policies["swarm"]) == {2}
    assert set(from_models.policies["seed"]) == {0, 1}
    samples = read_results(models[0].datacollector.get_model_vars_dataframe())
    pd.testing.assert_frame_equal(samples.runs, read_results(models[0]).runs)


def test_conditions_are_the_parameters_that_differ() -> None:
    rows = sweep(seed=0, n=4, side=[2.0, 3.0], duration=[10.0, 20.0], policies=["avoid", "avoid,avoid"])
    runs = read_results(pd.DataFrame(rows)).runs
    assert runs["condition"].iloc[0] == "policies=avoid, duration=10.0, side=2.0"
    assert runs["condition"].nunique() == 8
    assert len(runs) == 4 * 1 + 4 * 2
    named = read_results(rows[:1], by=["side"]).runs
    assert set(named["condition"]) == {"side=2.0"}
    with pytest.raises(InputError, match=r"by=.*two games have the same condition, N and seed"):
        read_results(rows, by=["side"])


def test_a_sweep_of_durations_keeps_them_when_pucks_end_the_games() -> None:
    games = {"duration": [200.0, 300.0], "puck_limit": 1, "policies": "avoid,avoid", "n": 8, "seed": 0}
    rows = sweep(**games)
    assert {row["duration"] for row in rows} == {200.0, 300.0}
    models = [ForagingModel(**{**games, "duration": duration}) for duration in (200.0, 300.0)]
    for model in models:
        model.play()
    for runs in (read_results(rows).runs, read_results(models).runs):
        assert set(runs["condition"]) == {"duration=200.0", "duration=300.0"}
        assert set(runs["ended"]) == {"pucks"}
        assert runs["duration"].max() < 200.0


def test_unusable_games_are_refused() -> None:
    with pytest.raises(InputError, match=r'must have model reporters \(record="model"\)'):
        read_results([{"RunId": 0, "n": 4}])
    with pytest.raises(InputError, match="a game was stopped before its end"):
        read_results(ForagingModel(n=4, duration=10.0))
    with pytest.raises(InputError, match="must hold at least one game"):
        read_results([])
