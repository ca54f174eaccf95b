"""Expansion to runs: each game and seed once, named by what is simulated."""

import re
import subprocess
import sys

import pytest

from scenarios import runs as module
from scenarios.catalogue import CATALOGUE
from scenarios.runs import digest, expand

GAME = CATALOGUE["fig-6.1c"].game("", 6)


def test_a_scenario_expands_to_conditions_times_densities_times_seeds() -> None:
    runs = expand([CATALOGUE["fig-6.15"].replace(densities=(6, 10), seeds=3)], first_seed=5)
    assert len(runs) == len({run.digest for run in runs}) == 4 * 2 * 3
    asked = {(condition, run.n, run.seed) for run in runs for _, condition in run.labels}
    names = [condition.name for condition in CATALOGUE["fig-6.15"].conditions]
    assert asked == {(name, n, seed) for name in names for n in (6, 10) for seed in (5, 6, 7)}


def test_two_figures_of_one_condition_share_its_runs() -> None:
    few = [CATALOGUE[name].replace(densities=(6,), seeds=2) for name in ("fig-6.1c", "fig-6.2", "fig-6.3")]
    runs = expand(few)
    assert [run.labels for run in runs] == [
        (("fig-6.1c", ""),),
        (("fig-6.1c", ""),),
        (("fig-6.2", ""), ("fig-6.3", "")),
        (("fig-6.2", ""), ("fig-6.3", "")),
    ]
    assert [run.seed for run in runs] == [0, 1, 0, 1]


def test_a_figure_with_more_seeds_shares_those_that_both_have() -> None:
    one, twenty = CATALOGUE["fig-6.2"].replace(seeds=1), CATALOGUE["fig-6.3"]
    runs = expand([one.replace(densities=(6,)), twenty.replace(densities=(6,))])
    assert len(runs) == 20
    assert [len(run.labels) for run in runs] == [2] + [1] * 19


def test_no_two_scenarios_share_a_run_but_for_the_figures_of_one_game() -> None:
    runs = expand([scenario.replace(densities=(26,), seeds=1) for scenario in CATALOGUE.values()])
    shared = [run.labels for run in runs if len(run.labels) > 1]
    assert shared == [(("fig-6.2", ""), ("fig-6.3", ""))]


def test_the_digest_covers_game_seed_and_version(monkeypatch: pytest.MonkeyPatch) -> None:
    name = digest(GAME, 0)
    assert re.fullmatch("[0-9a-f]{16}", name)
    assert digest(CATALOGUE["fig-6.1c"].game("", 6), 0) == name
    others = {
        digest(GAME, 1),
        digest(GAME.replace(duration=601.0), 0),
        digest(GAME.replace(parameters=GAME.parameters.replace(friction=0.5)), 0),
        digest(CATALOGUE["fig-6.1c"].game("", 8), 0),
    }
    monkeypatch.setattr(module, "package_version", lambda: "0.0.0")
    others.add(digest(GAME, 0))
    assert len(others - {name}) == 5


def test_the_digest_is_the_same_in_another_process() -> None:
    code = (
        "from scenarios.catalogue import CATALOGUE; from scenarios.runs import digest; "
        "print(digest(CATALOGUE['fig-6.1c'].game('', 6), 0))"
    )
    answer = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert answer.stdout.strip() == digest(GAME, 0)


def test_effort_grows_with_robots_time_and_finer_periods() -> None:
    by_effort = [
        ("fig-6.1a", "", 6),
        ("fig-6.15", "flight-50ms", 6),
        ("fig-6.1a", "", 50),
        ("fig-6.2", "", 6),
        ("fig-6.2", "", 50),
    ]
    efforts = []
    for name, condition, n in by_effort:
        runs = expand([CATALOGUE[name].replace(densities=(n,), seeds=1)])
        efforts += [run.effort for run in runs if run.labels == ((name, condition),)]
    assert efforts == sorted(efforts)
    assert len(set(efforts)) == len(by_effort)
