"""Games with absent robots are otherwise the same games (docs/contribution.md)."""

import json
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kswarms.agents.body import KREMBOT
from kswarms.agents.robot.state import RobotStates
from kswarms.agents.streams import Purpose
from kswarms.model.description.game import Game, Swarm
from kswarms.model.description.parameters import PRESETS
from kswarms.model.game_model import GameModel

FITTED = PRESETS["fitted"]
NEAR = 2 * KREMBOT.radius + KREMBOT.sensing_scale * max(FITTED.flight_range, FITTED.active_range)
"""Robots farther apart than this, centre to centre, do not affect each other (m)."""
RESERVE = 0.05
"""Upper bound of the approach of two robots in a period (m)."""
WAYS = ("learning", "game")


def game(*policies: str, size: int = 6, learning: float = 30.0, **rest: Any) -> Game:
    swarms = tuple(Swarm(policy=policy, size=size) for policy in policies or ("attack", "inter-learner"))
    return Game(swarms=swarms, learning=learning, **{"duration": 30.0, **rest})


def play(what: Game, seed: int = 0, record: str = "conflicts,robots,trajectory") -> GameModel:
    model = GameModel(what, seed, record)
    model.play()
    return model


def at_the_switch(what: Game, seed: int = 0, record: str = "conflicts") -> GameModel:
    model = GameModel(what.replace(sample_period=what.learning), seed, record)
    model.step()
    assert model.phase == "game"
    return model


def world(model: GameModel, absent: tuple[int, ...] = ()) -> list[Any]:
    """Return body, state and policy of all but some robots, and the supplies."""
    robots = [robot for robot in model.robots if robot.number not in absent]
    return [
        [
            (robot.number, *robot.position, robot.heading, robot.state, robot.carrying, repr(robot.policy))
            for robot in robots
        ],
        model.supply,
    ]


def rows_of(model: GameModel, phase: str) -> list[dict[str, Any]]:
    table = model.tables()["conflicts"]
    rows = [dict(zip(table, values, strict=True)) for values in zip(*table.values(), strict=True)]
    return [row for row in rows if row["phase"] == phase]


def everything(model: GameModel) -> str:
    return json.dumps([model.results(), model.tables()])


# Absent from the very beginning.


def test_the_other_robots_keep_number_place_heading_policy_and_streams() -> None:
    what = game("mixed", "learner", "random", size=5)
    whole = GameModel(what, 3)
    rest = GameModel(what.replace(absent=(0, 7, 8)), 3)
    assert [robot.number for robot in rest.robots] == [1, 2, 3, 4, 5, 6, 9, 10, 11, 12, 13, 14]
    assert [[robot.number for robot in members] for members in rest.members] == [
        [1, 2, 3, 4],
        [5, 6, 9],
        [10, 11, 12, 13, 14],
    ]
    assert world(rest) == world(whole, (0, 7, 8))
    for robot in rest.robots:
        twin = whole.robots[robot.number]
        assert (robot.swarm, robot.policy_name) == (twin.swarm, twin.policy_name)
        assert [robot._draws(p).random() for p in Purpose] == [twin._draws(p).random() for p in Purpose]


@settings(max_examples=8)
@given(seed=st.integers(0, 10**6), absent=st.integers(0, 5))
def test_nothing_changes_until_a_robot_comes_near_the_absent_one(seed: int, absent: int) -> None:
    what = game("avoid", "attack", size=3, learning=0.0, body="krembot")
    whole, rest = GameModel(what, seed), GameModel(what.replace(absent=(absent,)), seed)
    gone = whole.robots[absent]
    others = [robot for robot in whole.robots if robot is not gone]
    for tick in range(1, 300):
        if min(math.dist(gone.position, robot.position) for robot in others) < NEAR + RESERVE:
            break
        for model in (whole, rest):
            model.env.run(until=tick)
        assert world(rest) == world(whole, (absent,))


@pytest.mark.parametrize("seed", range(3))
def test_robots_that_met_the_absent_one_move_differently_without_it(seed: int) -> None:
    whole, rest = (play(game(absent=absent), seed) for absent in ((), (4,)))
    assert world(rest) != world(whole, (4,))


def test_the_empty_game_of_one_robot_is_without_conflicts() -> None:
    """All but one of both swarms are absent: a swarm may be left empty."""
    model = play(game("avoid", "attack", size=2, absent=(0, 1, 3)))
    rows = model.results()
    assert [row["size"] for row in rows] == [0, 1]
    assert [row["conflicts_intra"] + row["conflicts_inter"] for row in rows] == [0, 0]
    assert [row["t_p"] for row in rows] == [0.0, 30.0]
    assert rows[1]["sud"] == rows[1]["pucks"] == -rows[0]["sud"]


# Absent from the measured game alone.


@pytest.mark.parametrize("absent", [(0,), (3, 11), (6, 7, 8, 9, 10, 11)])
def test_removal_at_the_switch_does_not_change_the_learning_phase(absent: tuple[int, ...]) -> None:
    whole = at_the_switch(game(supply=9), record="conflicts")
    rest = at_the_switch(game(supply=9, absent=absent, absent_from="game"))
    assert json.dumps(rows_of(rest, "learning")) == json.dumps(rows_of(whole, "learning"))
    assert world(rest) == world(whole, absent)
    assert min(rest.supply) < 9
    assert rest.carried_at_start == sum(robot.carrying for robot in rest.robots)
    for model in (whole, rest):
        model.play()
    assert json.dumps(rows_of(rest, "learning")) == json.dumps(rows_of(whole, "learning"))
    assert world(rest) != world(whole, absent)


def test_a_removed_robot_neither_acts_nor_is_met() -> None:
    absent = (2, 5, 6, 11)
    model = play(game("attack", "learner", absent=absent, absent_from="game"), seed=1)
    learned, played = rows_of(model, "learning"), rows_of(model, "game")
    assert {row["robot"] for row in learned} == {row["opponent"] for row in learned} == set(range(12))
    there = set(range(12)) - set(absent)
    assert {row["robot"] for row in played} == {row["opponent"] for row in played} == there
    for row in learned + played:
        assert (row["swarm"], row["opponent_swarm"]) == (row["robot"] // 6 + 1, row["opponent"] // 6 + 1)
    tables = model.tables()
    assert tables["robots"]["robot"] == sorted(there)
    samples = {}
    for time, robot in zip(tables["trajectory"]["time"], tables["trajectory"]["robot"], strict=True):
        samples.setdefault(time, set()).add(robot)
    assert all(seen == (there if time >= 30 else set(range(12))) for time, seen in samples.items())


def test_mesa_lists_the_robots_in_the_game() -> None:
    model = at_the_switch(game(absent=(1, 8), absent_from="game"))
    assert list(model.agents) == model.robots == list(model.space.agents)
    model.env.run(until=350)
    for row, robot in enumerate(model.robots):
        assert robot.index == row
        assert (robot.position == model.states.positions[row]).all()
        assert np.shares_memory(robot.position, model.states.positions)
        near, _ = robot.get_neighbors_in_radius(0.5)
        distances = {other: math.dist(robot.position, other.position) for other in model.robots}
        assert {*near} == {other for other, d in distances.items() if d <= 0.5 and other is not robot}


def test_a_blocked_robot_drives_on_after_the_removal() -> None:
    """Two aggressive robots of two swarms, head to head, until one of them leaves."""
    reached = {}
    for absent in ((), (1,)):
        what = game("aggressive", "aggressive", size=1, learning=5.0, absent=absent, absent_from="game")
        model = GameModel(what, record="conflicts")
        for robot, (x, heading) in zip(model.robots, ((-0.2, 0.0), (0.2, math.pi)), strict=True):
            robot.position = np.array([x, 0.3])
            row = model.states.robots[robot.index : robot.index + 1]
            row["heading"], row["forward_x"], row["forward_y"] = heading, math.cos(heading), 0.0
        model.env.run(until=50)
        before = model.robots[0].position[0]
        assert before < 0.0
        begun = len(rows_of(model, "learning"))
        assert begun > 4
        model.env.run(until=60)
        reached[absent] = model.robots[0].position[0] - before
    assert abs(reached[()]) < 1e-3
    assert reached[1,] == pytest.approx(10 * 0.015)


def test_the_puck_of_an_absent_robot_is_not_counted() -> None:
    took_one = False
    for seed in range(4):
        absent = (0, 1, 2, 6)
        whole = at_the_switch(game(learning=60.0), seed)
        took_one |= any(robot.carrying for robot in whole.robots if robot.number in absent)
        model = play(game(learning=60.0, absent=absent, absent_from="game", duration=120.0), seed)
        carried = sum(robot.carrying for robot in model.robots)
        assert model.picked_up + model.carried_at_start == sum(model.pucks) + carried
        assert model.pucks == [sum(robot.pucks for robot in members) for members in model.members]
    assert took_one


def test_times_of_the_present_robots_add_up() -> None:
    for since in WAYS:
        model = play(game("attack", "learner", absent=(0, 9, 10), absent_from=since, puck_limit=3))
        measured = model.env.now - 300
        assert [row["size"] for row in model.results()] == [5, 4]
        for robot in model.robots:
            t_a, t_p = robot.times()
            assert sum(t_a) + t_p == measured
        for row in model.results():
            assert row["t_a_intra"] + row["t_a_inter"] + row["t_p"] == pytest.approx(
                row["size"] * row["duration"]
            )


# Both ways to be absent.


def test_without_learning_both_are_the_same() -> None:
    never, left = (game("avoid", "attack", learning=0.0, absent=(3,), absent_from=way) for way in WAYS)
    assert everything(play(never)) == everything(play(left))


@pytest.mark.parametrize("preempt", [False, True])
def test_a_robot_without_conflicts_may_be_removed_early_or_late(preempt: bool) -> None:
    """It is the same world, whether the robot was never there or leaves before it came near anybody."""
    compared = 0
    for seed in range(12):
        parameters = FITTED.replace(preempt=preempt)
        what = game("attack", "attack", size=3, learning=4.0, body="krembot", parameters=parameters, supply=2)
        whole = GameModel(what, seed)
        gone = whole.robots[2]
        gap = math.inf
        for tick in range(1, 41):
            others = [robot for robot in whole.robots if robot is not gone]
            gap = min(gap, *(math.dist(gone.position, robot.position) for robot in others))
            whole.env.run(until=tick)
        if gap < NEAR + RESERVE or gone.carrying:
            continue
        never, left = (play(what.replace(absent=(2,), absent_from=way), seed) for way in WAYS)
        assert world(never) == world(left)
        assert json.dumps(rows_of(never, "game")) == json.dumps(rows_of(left, "game"))
        compared += 1
    assert compared >= 2


def test_removal_keeps_the_latest_opponents() -> None:
    states = RobotStates(np.zeros((5, 2)), np.array([0, 0, 1, 1, 1]), np.arange(5.0))
    states.robots["opponent"] = [-1, 4, 1, 0, 3]
    memory = states.robots
    states.keep(np.array([0, 2, 4]), np.zeros((3, 2)))
    assert states.robots["opponent"].tolist() == [-1, -1, -1]
    assert states.heading.tolist() == [0.0, 2.0, 4.0]
    assert states.swarm.tolist() == [0, 1, 1]
    assert np.shares_memory(states.robots, memory)

    states.robots["opponent"] = [2, 0, 1]
    states.keep(np.array([1, 2]), np.zeros((2, 2)))
    assert states.opponent.tolist() == [-1, 0]
