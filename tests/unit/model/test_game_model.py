"""The game as a Mesa model: space, samples, tables and results."""

import math

import mesa
import numpy as np
import pandas as pd
import pytest

from kswarms.agents.common.limits import FASTEST, LONGEST_TIME, SHORTEST_TIME, SLOWEST
from kswarms.model.description.game import Game, Swarm
from kswarms.model.description.presets import PRESETS
from kswarms.model.foraging import ForagingModel
from kswarms.model.game_model import GameModel
from kswarms.model.recorder import RECORDS
from tests.helpers.mesa_versions import sample_labels

GAME = Game(
    swarms=(Swarm(policy="avoid", size=4), Swarm(policy="attack", size=5), Swarm(policy="mixed", size=3)),
    duration=60.0,
)


def played(record: str = "", sample_period: float = 10.0, seed: int = 2) -> GameModel:
    model = GameModel(GAME.replace(sample_period=sample_period), seed, record)
    model.play()
    return model


def test_a_game_is_a_mesa_model_of_robots_in_a_continuous_space() -> None:
    model = GameModel(GAME, 2)
    assert isinstance(model, mesa.Model)
    assert list(model.agents) == model.robots == list(model.space.agents)
    assert [robot.index for robot in model.robots] == list(range(12))
    assert [[robot.swarm for robot in members] for members in model.members] == [[0] * 4, [1] * 5, [2] * 3]
    assert [robot.policy_name for robot in model.members[2]] == ["avoid", "avoid", "aggressive"]
    assert model.space.dimensions.tolist() == [[-1, 1], [-1, 1]]
    assert not model.space.torus


def test_games_with_parameters_at_their_limits_can_be_played() -> None:
    times = dict.fromkeys(("flight_duration", "fight_duration", "leg_mean"), LONGEST_TIME)
    for rest in ({"turning_rate": SLOWEST}, {"turning_rate": FASTEST}, {"leg_mean": SHORTEST_TIME}):
        slow = PRESETS["fitted"].replace(period=SHORTEST_TIME, conflict_distance=0.5, **(times | rest))
        game = GAME.replace(parameters=slow, duration=1e-4, sample_period=LONGEST_TIME)
        model = GameModel(game, 2, "robots")
        model.play()
        assert model.ended == "time"
        assert sum(sum(robot.conflicts) for robot in model.robots) > 0


def test_positions_are_the_kernels_own_memory() -> None:
    model = GameModel(GAME, 2)
    for robot in model.robots:
        assert np.shares_memory(robot.position, model.states.positions)
        assert np.shares_memory(robot.position, model.space.agent_positions)
    before = [robot.position.copy() for robot in model.robots]
    model.env.run(until=15)
    for robot, start in zip(model.robots, before, strict=True):
        assert (robot.position == model.states.positions[robot.index]).all()
        assert (robot.pos == robot.position).all()
        assert math.dist(robot.position, start) <= 15 * 0.015 + 1e-9
    assert all((robot.position != start).any() for robot, start in zip(model.robots, before, strict=True))


def test_setting_a_position_moves_the_robot() -> None:
    model = GameModel(GAME, 2)
    model.env.run(until=5)
    model.robots[0].position = np.array([0.31, -0.27])
    model.env.run(until=6)
    assert math.dist(model.robots[0].position, (0.31, -0.27)) < 0.02


def test_neighbour_queries_are_right_at_any_time() -> None:
    model = GameModel(GAME, 2)
    for until in (1, 40, 133):
        model.env.run(until=until)
        for robot in model.robots:
            distances = {other: math.dist(robot.position, other.position) for other in model.robots}
            near, found = robot.get_neighbors_in_radius(0.5)
            assert {*near} == {other for other, d in distances.items() if d <= 0.5 and other is not robot}
            assert found == pytest.approx([distances[other] for other in near])
            nearest, _ = robot.get_nearest_neighbors(1)
            assert distances[nearest[0]] == min(d for other, d in distances.items() if other is not robot)


def test_the_samples_of_the_model() -> None:
    model = played("model")
    frame = model.datacollector.get_model_vars_dataframe()
    kinds = ["pucks", "sud", "share_a", "share_p"]
    others = "size policy t_a_intra t_a_inter t_p conflicts_intra conflicts_inter"
    of_swarm = {*kinds, *others.split()}
    of_swarms = {f"{kind}_{k}" for kind in of_swarm for k in (1, 2, 3)}
    assert set(frame.columns) == {"time", "game_time", "ended", "run_seed"} | of_swarms
    assert frame["ended"].tolist() == ["running"] * 6 + ["time"]
    assert frame["time"].tolist() == [0, 10, 20, 30, 40, 50, 60] == model.sample_times
    start, end = frame.iloc[0], frame.iloc[-1]
    assert [start[f"{kind}_1"] for kind in kinds] == [0, 0, 0, 1]
    for row in model.results():
        k, played_time = row["swarm"], row["size"] * 60.0
        assert all(end[f"{name}_{k}"] == row[name] for name in of_swarm & row.keys())
        assert end[f"share_a_{k}"] == pytest.approx((row["t_a_intra"] + row["t_a_inter"]) / played_time)
        assert end[f"share_p_{k}"] == pytest.approx(row["t_p"] / played_time)
    assert frame.filter(like="pucks").diff().min().min() in (0, np.nan)


def test_the_samples_of_the_agents() -> None:
    model = played("agents", sample_period=5.0)
    frame = model.datacollector.get_agent_vars_dataframe()
    assert list(frame.columns) == ["swarm", "state", "puck", "x", "y", "heading"]
    assert frame.index.names == ["Step", "AgentID"]
    assert len(frame) == 13 * 12
    assert set(frame["state"]) == {"A", "P"}
    assert set(frame["puck"]) == {True, False}
    last = frame.loc[sample_labels(model.sample_times)[12]]
    for robot in model.robots:
        row = last.loc[robot.unique_id]
        assert (row["x"], row["y"]) == tuple(robot.position)
        assert (row["heading"], row["puck"], row["state"]) == (robot.heading, robot.carrying, robot.state)
        assert row["swarm"] == robot.swarm + 1


def test_the_table_of_conflicts() -> None:
    model = played("conflicts")
    table = pd.DataFrame(model.tables()["conflicts"])
    columns = "phase robot swarm opponent opponent_swarm start x y action t_a t_p active seen reward q"
    assert list(table.columns) == columns.split()
    assert table.equals(model.datacollector.get_table_dataframe("conflicts"))
    swarm = np.array([robot.swarm + 1 for robot in model.robots])
    assert (table["swarm"] == swarm[table["robot"]]).all()
    assert (table["opponent_swarm"] == swarm[table["opponent"]]).all()
    assert (table["robot"] != table["opponent"]).all()
    assert set(table["phase"]) == {"game"}
    assert table["active"].between(0, 8).all()
    for row in table.to_dict("records"):
        for k, seen in enumerate(row["seen"]):
            assert (swarm[list(seen)] == k + 1).all()
        assert row["opponent"] in row["seen"][row["opponent_swarm"] - 1]
        assert sum(map(len, row["seen"])) <= row["active"]
    assert table[["x", "y"]].abs().max().max() <= 1 - 0.085 + 1e-9
    fights = (table["swarm"] == 2) & (table["opponent_swarm"] != 2)
    assert set(table.loc[fights, "action"]) == {"fight"}
    assert set(table.loc[table["swarm"] == 1, "action"]) == {"flight"}
    for row in model.results():
        own = table[table["swarm"] == row["swarm"]]
        inter = own["opponent_swarm"] != row["swarm"]
        assert (len(own) - inter.sum(), inter.sum()) == (row["conflicts_intra"], row["conflicts_inter"])
        assert own.loc[~inter, "t_a"].sum() == pytest.approx(row["t_a_intra"])
        assert own.loc[inter, "t_a"].sum() == pytest.approx(row["t_a_inter"])
        # The time before the first conflict of a robot belongs to no conflict.
        first = own.groupby("robot")["start"].min()
        never = row["size"] - len(first)
        assert own["t_p"].sum() + first.sum() + 60 * never == pytest.approx(row["t_p"])


def test_the_table_of_robots() -> None:
    model = played("robots")
    table = pd.DataFrame(model.tables()["robots"])
    assert list(table.columns) == ["robot", "swarm", "policy", "pucks", "t_a", "t_p", "arms"]
    assert table["robot"].tolist() == list(range(12))
    assert (table["t_a"] + table["t_p"]).tolist() == pytest.approx([60.0] * 12)
    for row in model.results():
        own = table[table["swarm"] == row["swarm"]]
        assert len(own) == row["size"]
        assert own["pucks"].sum() == row["pucks"]
        assert own["t_p"].sum() == pytest.approx(row["t_p"])
    assert table["policy"].tolist() == [robot.policy_name for robot in model.robots]


def test_the_trajectory() -> None:
    model = played("trajectory", sample_period=7.0)
    table = pd.DataFrame(model.tables()["trajectory"])
    assert list(table.columns) == ["time", "robot", "x", "y", "heading", "state", "puck"]
    assert table["time"].unique().tolist() == pytest.approx([*range(0, 60, 7), 60])
    assert (table.groupby("time")["robot"].apply(list).map(lambda robots: robots == list(range(12)))).all()
    assert table[table["time"] == 60.0][["x", "y"]].to_numpy().tolist() == model.states.positions.tolist()


@pytest.mark.parametrize(
    ("record", "tables", "model_vars", "agents"),
    [
        ("", set(), False, False),
        ("model", set(), True, False),
        ("agents", set(), False, True),
        ("conflicts", {"conflicts"}, False, False),
        (" robots , conflicts,", {"robots", "conflicts"}, False, False),
        (",".join(RECORDS), {"conflicts", "robots", "trajectory"}, True, True),
    ],
)
def test_only_requested_records_are_kept(
    record: str, tables: set[str], model_vars: bool, agents: bool
) -> None:
    model = played(record)
    assert model.tables().keys() == tables
    assert bool(model.datacollector.model_vars) == model_vars
    assert bool(model.datacollector.agent_reporters) == agents
    assert (model.conflict_log is None) == ("conflicts" not in record)


def test_the_columns_of_results() -> None:
    rows = played().results()
    columns = "swarm size policy pucks sud t_a_intra t_a_inter t_p conflicts_intra conflicts_inter duration"
    assert [list(row) for row in rows] == [[*columns.split(), "ended"]] * 3
    assert [row["policy"] for row in rows] == ["avoid", "attack", "mixed"]
    assert [type(row["pucks"]) for row in rows] == [int] * 3


def test_results_in_the_middle_of_a_game_are_those_so_far() -> None:
    model = GameModel(GAME, 2)
    model.env.run(until=217)
    for row in model.results():
        assert (row["duration"], row["ended"]) == (pytest.approx(21.7), "")
        assert row["t_a_intra"] + row["t_a_inter"] + row["t_p"] == pytest.approx(row["size"] * 21.7)


def test_playing_on_from_any_point_ends_the_same() -> None:
    for record in ("", "model"):
        model = GameModel(GAME, 2, record)
        model.env.run(until=33)
        model.step()
        model.play()
        model.play()
        assert model.results() == played().results()


def test_the_order_of_creation_does_not_matter() -> None:
    first, second = ForagingModel(n=6, seed=1), ForagingModel(n=6, seed=1)
    second.play()
    first.play()
    assert first.results() == second.results()
