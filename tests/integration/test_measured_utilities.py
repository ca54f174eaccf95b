"""Utilities of recorded games (section 1.3)."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from kswarms.agents.theory.swarms import (
    is_zero_sum_between,
    is_zero_sum_difference,
    sum_of_differences,
    swarm_utility_difference,
)
from kswarms.analysis.measures.utilities import robot_utilities, utilities_by_swarm
from kswarms.analysis.results.records import read_conflicts
from kswarms.model.description.game import Game, Swarm
from kswarms.model.game_model import GameModel
from kswarms.scenarios.description.condition import Condition, SwarmRule
from kswarms.scenarios.description.scenario import Scenario
from kswarms.scenarios.runs.play import play
from kswarms.scenarios.runs.run import expand
from kswarms.scenarios.study.study import Study

ALPHA = {1: 0.5, 2: 1.0, 3: 2.0}
BETA = {(k, m): 1.0 + 0.1 * k + 0.01 * m for k in (1, 2, 3) for m in (1, 2, 3)}
TRIO = (Swarm(policy="avoid", size=5), Swarm(policy="attack", size=6), Swarm(policy="mixed", size=4))


def play_game(game: Game, record: str = "conflicts") -> GameModel:
    model = GameModel(game, seed=5, record=record)
    model.play()
    return model


def test_utilities_agree_with_the_sampled_states() -> None:
    # With a sample in each control period, the states give the times in A and in P.
    model = play_game(Game(swarms=TRIO, duration=40.0, sample_period=0.1), "conflicts,trajectory")
    tables = model.tables()
    conflicts, states = pd.DataFrame(tables["conflicts"]), pd.DataFrame(tables["trajectory"])
    in_a = states.pivot(index="time", columns="robot", values="state").to_numpy() == "A"
    swarm = np.array([robot.swarm for robot in model.robots])
    u, wlu = np.zeros((15, 3)), np.zeros(15)
    for row in conflicts.to_dict("records"):
        i, k, s = row["robot"], row["swarm"], row["opponent_swarm"]
        first = round(row["start"] / 0.1) + 1
        last = first + round((row["t_a"] + row["t_p"]) / 0.1)
        t_a = 0.1 * in_a[first:last].sum(axis=0)
        t_p = 0.1 * (~in_a[first:last]).sum(axis=0)
        own = BETA[k, s] * t_p[i] - ALPHA[k] * t_a[i]
        for m in (1, 2, 3):
            for j in row["seen"][m - 1]:
                gained, lost = BETA[m, k] * t_p[j], ALPHA[m] * t_a[j]
                if m == k:
                    u[i, m - 1] += own
                    wlu[i] += own - lost - BETA[m, k] * t_a[j]
                else:
                    u[i, m - 1] += own - (gained - lost)
                    u[j, k - 1] -= own - (gained - lost)
                    wlu[i] += 2 * own + 2 * lost + BETA[m, k] * t_a[j] - gained
    robots = robot_utilities(conflicts, ALPHA, BETA)
    assert len(conflicts) > 100
    assert robots["robot"].tolist() == list(range(15))
    assert robots["swarm"].tolist() == (swarm + 1).tolist()
    assert robots["conflicts"].sum() == len(conflicts)
    assert robots[["u_1", "u_2", "u_3"]].to_numpy() == pytest.approx(u, abs=1e-6)
    assert robots["utility"].to_numpy() == pytest.approx(u.sum(axis=1), abs=1e-6)
    assert robots["wlu"].to_numpy() == pytest.approx(wlu, abs=1e-6)


@pytest.mark.parametrize("swarms", [TRIO[:2], TRIO], ids=["two swarms", "three swarms"])
def test_the_utilities_of_two_swarms_from_each_other_cancel(swarms: tuple[Swarm, ...]) -> None:
    conflicts = pd.DataFrame(play_game(Game(swarms=swarms, duration=60.0)).tables()["conflicts"])
    robots = robot_utilities(conflicts, ALPHA, BETA)
    u = robots[[f"u_{k + 1}" for k in range(len(swarms))]].to_numpy()
    swarm_of = (robots["swarm"] - 1).tolist()
    assert is_zero_sum_between(u, swarm_of)
    assert np.abs(u).max() > 1
    assert not is_zero_sum_between(np.abs(u), swarm_of)
    table = utilities_by_swarm(robots)
    totals = table["utility"].tolist()
    assert sum(totals) == pytest.approx(u[np.arange(len(u)), swarm_of].sum())
    assert table["sud"].tolist() == pytest.approx(
        [swarm_utility_difference(totals, k) for k in range(len(totals))]
    )
    assert table["sud"].sum() == pytest.approx(sum_of_differences(totals), abs=1e-6)
    assert is_zero_sum_difference([totals]) == (len(swarms) == 2)


def test_the_learning_phase_is_measured_separately() -> None:
    game = Game(
        swarms=(Swarm(policy="avoid", size=6), Swarm(policy="learner", size=6)), learning=40.0, duration=60.0
    )
    conflicts = pd.DataFrame(play_game(game).tables()["conflicts"])
    assert set(conflicts["phase"]) == {"learning", "game"}
    measured = robot_utilities(conflicts)
    assert measured.equals(robot_utilities(conflicts[conflicts["phase"] == "game"]))
    learned = robot_utilities(conflicts, phase="learning")
    assert measured["conflicts"].sum() + learned["conflicts"].sum() == len(conflicts)


def test_a_file_of_conflicts_gives_the_utilities_of_the_games(tmp_path: Path) -> None:
    swarms = tuple(SwarmRule(policy=policy) for policy in ("avoid", "attack"))
    crowd = Scenario(
        id="crowd", title="A crowd", densities=(10, 16), seeds=1,
        conditions=(Condition(swarms=swarms, duration=60.0),),
    )  # fmt: skip
    runs = expand([crowd])
    outcomes = [play(run, "conflicts") for run in runs]
    with Study(tmp_path) as study:
        assert len(list(study.play(study.plan([crowd]), records=["conflicts"]))) == 2
    robots = robot_utilities(read_conflicts(tmp_path, seen=True))
    assert len(robots) == 10 + 16
    for run, outcome in zip(runs, outcomes, strict=True):
        of_file = robots[robots["run"] == run.digest].drop(columns="run").reset_index(drop=True)
        assert of_file.equals(robot_utilities(pd.DataFrame(outcome.records["conflicts"])))
