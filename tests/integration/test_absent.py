"""Games with absent robots differ only by the effect of their absence (docs/contribution.md)."""

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
from kswarms.model.description.game import Game
from kswarms.model.description.presets import PRESETS
from kswarms.model.game_model import GameModel
from tests.conftest import Scene
from tests.games import check_times_and_pucks, conflicts_of, make_game, play, play_learning_phase

FITTED = PRESETS["fitted"]
NEAR = 2 * KREMBOT.radius + KREMBOT.sensing_scale * max(FITTED.flight_range, FITTED.active_range)
"""Robots farther apart than this, centre to centre, do not affect each other (m)."""
RESERVE = 0.05
"""Upper bound of the approach of two robots in a period (m)."""
ABSENT_FROM = ("learning", "game")


def game(*policies: str, **fields: Any) -> Game:
    policies = policies or ("attack", "inter-learner")
    return make_game(*policies, **{"learning": 30.0, "duration": 30.0, **fields})


def world(model: GameModel, absent: tuple[int, ...] = ()) -> list[Any]:
    """Return body, state and policy of all but some robots, and the supplies."""
    robots = [robot for robot in model.robots if robot.number not in absent]
    bodies = [(r.number, *r.position, r.heading, r.state, r.carrying, repr(r.policy)) for r in robots]
    return [bodies, model.supply]


# Absent from the start.


def test_the_other_robots_keep_number_place_heading_policy_and_streams() -> None:
    base = game("mixed", "learner", "random", size=5)
    complete = GameModel(base, 3)
    rest = GameModel(base.replace(absent=(0, 7, 8)), 3)
    assert [robot.number for robot in rest.robots] == [1, 2, 3, 4, 5, 6, 9, 10, 11, 12, 13, 14]
    assert [len(members) for members in rest.members] == [4, 3, 5]
    for swarm, members in enumerate(rest.members):
        assert {robot.number // 5 for robot in members} == {swarm}
    assert world(rest) == world(complete, (0, 7, 8))
    for robot in rest.robots:
        twin = complete.robots[robot.number]
        assert (robot.swarm, robot.policy_name) == (twin.swarm, twin.policy_name)
        numbers = [robot._generator(p).random() for p in Purpose]
        assert numbers == [twin._generator(p).random() for p in Purpose]


@settings(max_examples=8)
@given(seed=st.integers(0, 10**6), absent=st.integers(0, 5))
def test_nothing_changes_until_a_robot_comes_near_the_absent_one(seed: int, absent: int) -> None:
    base = game("avoid", "attack", size=3, learning=0.0, body="krembot")
    complete, rest = GameModel(base, seed), GameModel(base.replace(absent=(absent,)), seed)
    gone = complete.robots[absent]
    others = [robot for robot in complete.robots if robot is not gone]
    for tick in range(1, 300):
        if min(math.dist(gone.position, robot.position) for robot in others) < NEAR + RESERVE:
            break
        for model in (complete, rest):
            model.env.run(until=tick)
        assert world(rest) == world(complete, (absent,))


@pytest.mark.parametrize("seed", range(3))
def test_robots_that_met_the_absent_one_move_differently_without_it(seed: int) -> None:
    complete, rest = (play(game(absent=absent), seed) for absent in ((), (4,)))
    assert world(rest) != world(complete, (4,))


def test_a_lone_robot_has_no_conflicts() -> None:
    # All robots but one are absent; one swarm is empty.
    model = play(game("avoid", "attack", size=2, absent=(0, 1, 3)))
    rows = model.results()
    assert [row["size"] for row in rows] == [0, 1]
    assert [row["conflicts_intra"] + row["conflicts_inter"] for row in rows] == [0, 0]
    assert [row["t_p"] for row in rows] == [0.0, 30.0]
    assert rows[1]["sud"] == rows[1]["pucks"] == -rows[0]["sud"]


# Absent from the measured game only.


@pytest.mark.parametrize("absent", [(0,), (3, 11), (6, 7, 8, 9, 10, 11)])
def test_removal_at_the_switch_does_not_change_the_learning_phase(absent: tuple[int, ...]) -> None:
    complete = play_learning_phase(game(supply=9))
    rest = play_learning_phase(game(supply=9, absent=absent, absent_from="game"))
    assert json.dumps(conflicts_of(rest, "learning")) == json.dumps(conflicts_of(complete, "learning"))
    assert world(rest) == world(complete, absent)
    assert min(rest.supply) < 9
    assert rest.carried_at_start == sum(robot.carrying for robot in rest.robots)
    for model in (complete, rest):
        model.play()
    assert json.dumps(conflicts_of(rest, "learning")) == json.dumps(conflicts_of(complete, "learning"))
    assert world(rest) != world(complete, absent)


def test_a_removed_robot_neither_acts_nor_is_met() -> None:
    absent = (2, 5, 6, 11)
    model = play(game("attack", "learner", absent=absent, absent_from="game"), seed=1)
    learned, played = conflicts_of(model, "learning"), conflicts_of(model, "game")
    assert {row["robot"] for row in learned} == {row["opponent"] for row in learned} == set(range(12))
    there = set(range(12)) - set(absent)
    assert {row[name] for row in played for name in ("robot", "opponent")} == there
    for row in learned + played:
        assert (row["swarm"], row["opponent_swarm"]) == (row["robot"] // 6 + 1, row["opponent"] // 6 + 1)
    tables = model.tables()
    assert tables["robots"]["robot"] == sorted(there)
    samples = {}
    for time, robot in zip(tables["trajectory"]["time"], tables["trajectory"]["robot"], strict=True):
        samples.setdefault(time, set()).add(robot)
    assert all(seen == (there if time >= 30 else set(range(12))) for time, seen in samples.items())


def test_mesa_lists_the_robots_in_the_game() -> None:
    model = play_learning_phase(game(absent=(1, 8), absent_from="game"))
    assert list(model.agents) == model.robots == list(model.space.agents)
    model.env.run(until=350)
    for row, robot in enumerate(model.robots):
        assert robot.index == row
        assert (robot.position == model.states.positions[row]).all()
        assert np.shares_memory(robot.position, model.states.positions)
        near, _ = robot.get_neighbors_in_radius(0.5)
        distances = {other: math.dist(robot.position, other.position) for other in model.robots}
        assert {*near} == {other for other, d in distances.items() if d <= 0.5 and other is not robot}


def test_a_blocked_robot_drives_on_after_the_removal(scene: Scene) -> None:
    # Two aggressive robots drive head to head until one of them leaves.
    poses = [(-0.2, 0.3, 0.0)], [(0.2, 0.3, math.pi)]
    reached = {}
    for absent in ((), (1,)):
        fields = {"learning": 5.0, "absent": absent, "absent_from": "game", "record": "conflicts"}
        model = scene(*poses, policies="aggressive,aggressive", **fields)
        model.env.run(until=50)
        before = model.robots[0].position[0]
        assert before < 0.0
        assert len(conflicts_of(model, "learning")) > 4
        model.env.run(until=60)
        reached[absent] = model.robots[0].position[0] - before
    assert abs(reached[()]) < 1e-3
    assert reached[1,] == pytest.approx(10 * 0.015)


def test_the_puck_of_an_absent_robot_is_not_counted() -> None:
    carries_puck = False
    for seed in range(4):
        absent = (0, 1, 2, 6)
        complete = play_learning_phase(game(learning=60.0), seed)
        carries_puck |= any(robot.carrying for robot in complete.robots if robot.number in absent)
        model = play(game(learning=60.0, absent=absent, absent_from="game", duration=120.0), seed)
        check_times_and_pucks(model)
    assert carries_puck


def test_times_of_the_present_robots_add_up() -> None:
    for since in ABSENT_FROM:
        model = play(game("attack", "learner", absent=(0, 9, 10), absent_from=since, puck_limit=3))
        assert [row["size"] for row in model.results()] == [5, 4]
        check_times_and_pucks(model)


# Both values of `absent_from`.


def test_without_learning_both_values_give_the_same_game() -> None:
    models = [
        play(game("avoid", "attack", learning=0.0, absent=(3,), absent_from=way)) for way in ABSENT_FROM
    ]
    never, left = (json.dumps([model.results(), model.tables()]) for model in models)
    assert never == left


@pytest.mark.parametrize("preempt", [False, True])
def test_a_robot_without_conflicts_may_be_removed_early_or_late(preempt: bool) -> None:
    # The world is the same if the robot leaves before it came near any other.
    compared = 0
    for seed in range(12):
        parameters = FITTED.replace(preempt=preempt)
        base = game("attack", "attack", size=3, learning=4.0, body="krembot", parameters=parameters, supply=2)
        complete = GameModel(base, seed)
        gone = complete.robots[2]
        gap = math.inf
        for tick in range(1, 41):
            others = [robot for robot in complete.robots if robot is not gone]
            gap = min(gap, *(math.dist(gone.position, robot.position) for robot in others))
            complete.env.run(until=tick)
        if gap < NEAR + RESERVE or gone.carrying:
            continue
        never, left = (play(base.replace(absent=(2,), absent_from=way), seed) for way in ABSENT_FROM)
        assert world(never) == world(left)
        assert json.dumps(conflicts_of(never, "game")) == json.dumps(conflicts_of(left, "game"))
        compared += 1
    assert compared >= 2


def test_removal_keeps_the_states_of_the_others() -> None:
    states = RobotStates(np.zeros((5, 2)), np.array([0, 0, 1, 1, 1]), np.arange(5.0))
    states.bodies.opponent[:] = [-1, 4, 1, 0, 3]
    states.bodies.moved_x[:] = range(5)
    memory = states.bodies.heading
    states.keep(np.array([0, 2, 4]), np.zeros((3, 2)))
    assert states.bodies.opponent.tolist() == [-1, -1, -1]
    assert states.heading.tolist() == [0.0, 2.0, 4.0]
    assert states.swarm.tolist() == [0, 1, 1]
    assert states.bodies.moved_x.tolist() == [0, 2, 4]
    assert np.shares_memory(states.bodies.heading, memory)

    states.bodies.opponent[:] = [2, 0, 1]
    states.keep(np.array([1, 2]), np.zeros((2, 2)))
    assert states.opponent.tolist() == [-1, 0]
