"""Runs of scenarios, and the digests that identify them."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from kswarms.agents.policies.saved import save_learned
from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.runs import run as module
from kswarms.scenarios.runs.run import code_version, describe_curve, digest, expand

GAME = CATALOGUE["fig-6.1c"].game("", 6)


def test_a_scenario_expands_to_conditions_times_densities_times_seeds() -> None:
    runs = expand([CATALOGUE["fig-6.15"].replace(densities=(6, 10), seeds=3)], first_seed=5)
    assert len(runs) == len({run.digest for run in runs}) == 5 * 2 * 3
    expanded = {(condition, run.n, run.seed) for run in runs for _, condition in run.labels}
    names = [condition.name for condition in CATALOGUE["fig-6.15"].conditions]
    assert expanded == {(name, n, seed) for name in names for n in (6, 10) for seed in (5, 6, 7)}


def test_two_figures_with_the_same_condition_share_its_runs() -> None:
    few = [CATALOGUE[name].replace(densities=(6,), seeds=2) for name in ("fig-6.1c", "fig-6.2", "fig-6.3")]
    runs = expand(few)
    assert [run.labels for run in runs] == [
        (("fig-6.1c", ""),),
        (("fig-6.1c", ""),),
        (("fig-6.2", ""), ("fig-6.3", "")),
        (("fig-6.2", ""), ("fig-6.3", "")),
    ]
    assert [run.seed for run in runs] == [0, 1, 0, 1]


def test_figures_share_the_runs_of_the_seeds_that_both_have() -> None:
    one, twenty = CATALOGUE["fig-6.2"].replace(seeds=1), CATALOGUE["fig-6.3"]
    runs = expand([one.replace(densities=(6,)), twenty.replace(densities=(6,))])
    assert len(runs) == 20
    assert [len(run.labels) for run in runs] == [2] + [1] * 19


# Written as "figure curve = figure curve = …".
SHARED = """
6.2 = 6.3
6.4a = 6.10b wlu
6.4b = 6.10a wlu = 6.12 delta=0.125 = 6.14 ucb
6.9 = 6.10a individual
6.11a = 6.12 delta=0.25
6.11b = 6.12 delta=0.2
6.11c = 6.12 delta=0.08
6.11d = 6.12 delta=0.02
7.1 = 7.6 avoid
7.2a = 7.6 attack
7.2b = 7.4 avoid
7.3 = 7.4 delta=0.145
7.5 = 7.6 delta=0.145
7.7a = 7.8 avoid
7.10 delta=0.125 = 7.11 delta=0.125
7.10 avoid = 7.11 avoid
7.17 = 7.19 avoid
7.18a = 7.19 b=1
7.18b = 7.19 b=7/6
"""


def test_only_curves_of_the_same_game_share_a_run() -> None:
    runs = expand([scenario.replace(densities=(26,), seeds=1) for scenario in CATALOGUE.values()])
    shared = {
        " = ".join(f"{name.removeprefix('fig-')} {condition}".strip() for name, condition in run.labels)
        for run in runs
        if len(run.labels) > 1
    }
    assert shared == set(SHARED.strip().splitlines())


@pytest.mark.parametrize(("random", "same"), [("c", "fig-6.4b"), ("d", "fig-6.4a")])
def test_figures_with_random_stations_differ_only_in_their_stations(random: str, same: str) -> None:
    game = CATALOGUE[f"fig-6.13{random}"].game("", 26)
    assert game != CATALOGUE[same].game("", 26)
    assert game.replace(layout="symmetric") == CATALOGUE[same].game("", 26)


def test_the_digest_covers_game_seed_and_version(monkeypatch: pytest.MonkeyPatch) -> None:
    name = digest(GAME, 0)
    assert re.fullmatch("[0-9a-f]{16}", name)
    assert digest(CATALOGUE["fig-6.1c"].game("", 6), 0) == name
    others = {
        digest(GAME, 1),
        digest(GAME.replace(duration=601.0), 0),
        digest(GAME.replace(learning=3000.0), 0),
        digest(GAME.replace(parameters=GAME.parameters.replace(friction=0.5)), 0),
        digest(CATALOGUE["fig-6.1c"].game("", 8), 0),
    }
    monkeypatch.setattr(module, "__version__", "0.0.0")
    others.add(digest(GAME, 0))
    assert len(others - {name}) == 6


def test_the_digest_covers_the_content_of_learned_policies(tmp_path: Path) -> None:
    file = tmp_path / "learned.json"
    arm = {"opponent": 1, "action": "fight", "reward": 1.0, "time": 10.0, "count": 2.0, "q": 0.1}
    save_learned(file, 2, [[arm]])
    scenario = CATALOGUE["fig-6.1c"]
    avoid, _ = scenario.conditions[0].swarms
    loading = (avoid, avoid.replace(policy=f"avoid+learned(file='{file}')"))
    game = scenario.conditions[0].replace(swarms=loading).game(8)
    name = digest(game, 0)
    save_learned(file, 2, [[arm]])
    assert digest(game, 0) == name
    save_learned(file, 2, [[arm | {"action": "flight"}]])
    assert digest(game, 0) != name


def test_the_digest_is_the_same_in_another_process() -> None:
    code = (
        "from kswarms import CATALOGUE; from kswarms.scenarios.runs.run import digest; "
        "print(digest(CATALOGUE['fig-6.1c'].game('', 6), 0))"
    )
    answer = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert answer.stdout.strip() == digest(GAME, 0)


def test_effort_grows_with_robots_time_learning_and_finer_periods() -> None:
    by_effort = [
        ("fig-6.1a", "", 6),
        ("fig-6.15", "flight-50ms", 6),
        ("fig-6.2", "", 50),
        ("fig-6.4a", "", 6),
        ("fig-6.1a", "", 50),
        ("fig-6.5a", "", 50),
        ("fig-6.4a", "", 50),
    ]
    efforts = []
    for name, condition, n in by_effort:
        runs = expand([CATALOGUE[name].replace(densities=(n,), seeds=1)])
        efforts += [run.effort for run in runs if run.labels == ((name, condition),)]
    assert efforts == sorted(efforts)
    assert len(set(efforts)) == len(by_effort)


def test_a_curve_is_described_by_everything_but_the_number_of_robots() -> None:
    condition = CATALOGUE["fig-6.1c"].conditions[0]
    described = describe_curve(condition, 6)
    assert described == describe_curve(condition, 50)
    assert described != describe_curve(condition.replace(duration=601.0), 6)
    assert described != describe_curve(condition.replace(parameters="fitted, friction=0.9"), 6)


def test_the_code_version_is_the_version_with_a_hash() -> None:
    assert re.fullmatch(r"\S+ [0-9a-f]{12}", code_version())
    assert code_version().startswith(f"{module.__version__} ")
