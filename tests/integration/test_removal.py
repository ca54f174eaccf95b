"""Robots that are removed in the middle of a game (docs/howto.md)."""

import json
from collections.abc import Callable
from typing import Any

import pytest

from kswarms import GameModel, InputError
from kswarms.agents.robot.krembot import Krembot
from kswarms.model.description.presets import PRESETS
from tests.conftest import Scene
from tests.games import (
    check_times_and_pucks,
    conflicts_of,
    game_under_way,
    make_game,
    play_learning_phase,
)

Remove = Callable[[GameModel, Krembot], object]


def world(model: GameModel) -> list[Any]:
    """Return the body and the state of each robot in the game."""
    robots = model.robots
    return [(r.number, *r.position, r.heading, r.state, r.carrying, r.pucks, r.times()) for r in robots]


WAYS: dict[str, Remove] = {
    "robot.remove": lambda _, robot: robot.remove(),
    "model.remove": lambda model, robot: model.remove(robot),
    "deregister_agent": lambda model, robot: model.deregister_agent(robot),
    "agents.do": lambda model, robot: model.agents.select(lambda each: each is robot).do("remove"),
    "agents.shuffle_do": lambda model, robot: model.agents.shuffle_do(lambda e: e is robot and e.remove()),
}


@pytest.mark.parametrize("way", WAYS)
def test_every_way_to_remove_a_robot_leaves_the_others_as_they_are(way: str) -> None:
    model, twin = game_under_way(), game_under_way()
    for number in (3, 11, 0):
        robot = next(robot for robot in model.robots if robot.number == number)
        WAYS[way](model, robot)
    gone = {0, 3, 11}
    assert world(model) == [row for row in world(twin) if row[0] not in gone]
    assert list(model.agents) == model.robots == list(model.space.agents)
    assert [robot.number for robot in model.removed] == [3, 11, 0]
    assert [len(members) for members in model.members] == [4, 5]
    check_times_and_pucks(model)
    model.play()
    check_times_and_pucks(model)
    assert (model.ended, model.time) == ("time", 60.0)


def test_a_removed_robot_keeps_its_scores_and_its_last_state() -> None:
    model = game_under_way("avoid", "avoid", seconds=0.1, duration=300.0)
    while model.time < 50.0:
        model.step()
    robot = max(model.robots, key=lambda each: each.pucks)
    assert robot.pucks > 0
    before = (robot.pucks, robot.times(), robot.conflicts.copy(), robot.heading, robot.state, *robot.position)
    robot.remove()
    model.play()
    assert before == (
        robot.pucks, robot.times(), robot.conflicts, robot.heading, robot.state, *robot.position
    )  # fmt: skip
    row = model.results()[robot.swarm]
    assert row["size"] == 6
    assert row["pucks"] == model.pucks[robot.swarm] == sum(r.pucks for r in model.players(robot.swarm))
    table = model.tables()["robots"]
    assert table["robot"] == list(range(12))
    assert table["t_p"][robot.number] < 51
    places = model.tables()["trajectory"]
    shown = [t for t, n in zip(places["time"], places["robot"], strict=True) if n == robot.number]
    assert max(shown) == 50.0


def test_the_puck_of_a_removed_robot_is_lost() -> None:
    model = game_under_way("avoid", "avoid", seconds=30.0, supply=20, duration=120.0)
    carriers = [robot for robot in model.robots if robot.carrying]
    assert carriers
    for count, robot in enumerate(carriers):
        assert model.lost == count
        robot.remove()
    supply = sum(model.supply)
    assert model.lost == len(carriers)
    assert model.picked_up == 40 - supply == sum(model.pucks) + len(carriers)
    model.play()
    check_times_and_pucks(model)


def test_a_removal_at_the_start_of_the_game_is_the_same_as_absence() -> None:
    for preempt in (False, True):
        base = make_game(
            "attack", "inter-learner", "mixed", size=4, learning=40.0, duration=60.0, supply=9,
            parameters=PRESETS["fitted"].replace(preempt=preempt),
        )  # fmt: skip
        absent = play_learning_phase(base.replace(absent=(2, 7), absent_from="game"), 5)
        removed = play_learning_phase(base, 5)
        for robot in [removed.robots[7], removed.robots[2]]:
            robot.remove()
        assert absent.supply == removed.supply
        for model in (absent, removed):
            model.play()
        assert world(absent) == world(removed)
        assert json.dumps(conflicts_of(absent, "game")) == json.dumps(conflicts_of(removed, "game"))
        assert absent.pucks == removed.pucks
        assert [row["size"] for row in absent.results()] == [3, 3, 4]
        assert [row["size"] for row in removed.results()] == [4, 4, 4]


def test_robots_removed_while_learning_do_not_count_in_the_measured_game() -> None:
    model = game_under_way(learning=40.0)
    for number in (1, 8):
        model.remove(next(robot for robot in model.robots if robot.number == number))
    model.play()
    assert model.removed == []
    assert [row["size"] for row in model.results()] == [5, 5]
    assert 1 not in model.tables()["robots"]["robot"]
    check_times_and_pucks(model)


def test_conflicts_name_the_same_robots_after_a_removal() -> None:
    for seed in range(4):
        model, twin = (game_under_way("attack", "mixed", seed=seed) for _ in range(2))
        closed = len(twin.conflict_log or ())
        model.robots[0].remove()
        begun = []
        for each in (model, twin):
            each.env.run(until=201)
            for robot in each.robots:
                robot.finish(201)  # closes the open conflict
            begun.append({(c[:4], c.seen) for c in each.conflict_log or () if c.start < 200})
        assert begun[0] == begun[1]
        assert len(begun[0]) > closed > 10


def test_the_opponent_of_a_removed_robot_completes_its_action(scene: Scene) -> None:
    model = scene([(0.0, 0.0, 0.0)], [(0.25, 0.0, 0.0)], policies="attack,avoid", record="conflicts")
    model.env.run(until=3)
    attacker, victim = model.robots
    assert attacker.state == "A"
    begun = attacker.conflicts.copy()
    victim.remove()
    assert (attacker.state, attacker.conflicts) == ("A", begun)
    assert model.states.opponent[0] == -1
    model.env.run(until=30)
    assert (attacker.state, attacker.conflicts) == ("P", begun)
    model.play()
    (row,) = conflicts_of(model, "game")
    assert (row["robot"], row["opponent"], row["opponent_swarm"]) == (0, 1, 2)
    assert row["t_a"] == pytest.approx(model.action_periods["fight"] / 10)


def test_timeouts_of_a_removed_robot_have_no_effect() -> None:
    model = game_under_way()
    robot = model.robots[4]
    robot.remove()
    before = robot.state, robot.heading, [array.tolist() for array in robot._states.bodies]
    model.play()
    assert before == (robot.state, robot.heading, [array.tolist() for array in robot._states.bodies])


@pytest.mark.parametrize("all_at_once", [False, True])
def test_a_game_without_robots_goes_on_to_its_end(all_at_once: bool) -> None:
    model = game_under_way()
    if all_at_once:
        model.remove_all_agents()
    else:
        for robot in model.robots[::-1]:
            robot.remove()
            model.step()
    assert model.robots == list(model.agents) == []
    model.play()
    assert (model.ended, model.time) == ("time", 60.0)
    assert [row["size"] for row in model.results()] == [6, 6]
    assert len(model.policy_results()) == 4
    check_times_and_pucks(model)


def test_all_robots_may_be_removed_while_learning() -> None:
    model = game_under_way(learning=40.0)
    model.remove_all_agents()
    model.play()
    assert [row["size"] for row in model.results()] == [0, 0]
    assert model.policy_results() == []
    assert set(map(len, model.tables()["robots"].values())) == {0}


def test_only_robots_of_the_game_can_be_removed() -> None:
    model = game_under_way()
    robot = model.robots[0]
    robot.remove()
    robot.remove()  # as in Mesa, nothing happens
    for other in (robot, game_under_way().robots[1], "x", None, 3, model):
        with pytest.raises(InputError, match="must be a robot in this game"):
            model.remove(other)  # type: ignore[arg-type]
    assert len(model.robots) == 11


def test_a_robot_may_be_removed_after_the_end() -> None:
    model = game_under_way()
    model.play()
    results, tables = model.results(), json.dumps(model.tables())
    model.robots[2].remove()
    assert (model.results(), json.dumps(model.tables())) == (results, tables)
    assert len(model.agents) == 11
