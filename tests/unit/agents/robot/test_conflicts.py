"""Behaviour of a robot in a conflict, in games set up by hand (section 2.3)."""

import itertools
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from kswarms.model.game_model import GameModel

Scene = Callable[..., GameModel]

FACING_AWAY = [(0.25, 0.05, 0.0)]
"""Pose of a robot ahead of a robot at the origin that heads along x; it faces away from that robot."""

STEP = 2.96 * 0.1
"""Maximum turn in a period (rad)."""


def pose(model: GameModel, robot: int = 0) -> tuple[float, float, float]:
    x, y = model.robots[robot].position
    return float(x), float(y), model.robots[robot].heading


def run_to(model: GameModel, seconds: float) -> None:
    model.env.run(until=round(seconds / model.game.parameters.period))


def conflicts(model: GameModel, robot: int = 0) -> list[dict[str, Any]]:
    """Return a robot's closed conflicts, times in periods."""
    assert model.conflict_log is not None
    return [conflict._asdict() for conflict in model.conflict_log if conflict.robot == robot]


def test_a_fight_turns_to_the_bearing_and_drives(scene: Scene) -> None:
    model = scene([(0.0, 0.0, -0.6)], FACING_AWAY, policies="attack,avoid", record="conflicts")
    bearing = math.atan2(0.05, 0.25)
    turn = math.ceil((bearing + 0.6) / STEP)
    model.env.run(until=turn + 1)
    assert turn == 3
    assert model.robots[0].state == "A"
    assert pose(model)[2] == pytest.approx(bearing)
    assert math.dist(pose(model)[:2], (0.0, 0.0)) == pytest.approx(0.015)
    run_to(model, 5.0)
    first = conflicts(model)[0]
    assert (first["opponent"], first["start"], first["action"].name) == (1, 0, "fight")
    assert first["t_a"] == turn + 10


def test_a_flight_turns_to_the_most_vacant_direction(scene: Scene) -> None:
    # All sectors except the one at 90° contain a robot within the flight range, facing outward.
    around = [k * math.pi / 4 for k in range(8) if k != 2]
    ring = [(0.3 * math.cos(a), 0.3 * math.sin(a), a) for a in around]
    model = scene([(0.0, 0.0, 0.0)], ring, record="conflicts")
    turn = math.ceil(math.pi / 2 / STEP)
    model.env.run(until=turn + 1)
    assert pose(model)[2] == pytest.approx(math.pi / 2)
    assert pose(model)[1] == pytest.approx(0.015)
    model.env.run(until=turn + 18)
    assert model.robots[0].t_a == [0, turn + 17]


def test_a_logged_conflict_has_the_state_at_its_start(scene: Scene) -> None:
    # Four robots within the active range of 0.30 m and one within the flight range, no wall.
    ring = [(0.3 * math.cos(a), 0.3 * math.sin(a), a) for a in (0.0, 0.8, 1.6, 2.4, 3.2)]
    model = scene([(0.0, 0.1, 0.0)], [(x, y + 0.1, a) for x, y, a in ring], record="conflicts", duration=30.0)
    model.robots[1].position = np.array([0.0, 0.1 - 0.17 - 0.38])
    model.env.run()
    start = {"robot": 0, "opponent": 2, "start": 0, "x": 0.0, "y": 0.1}
    sensed = {"active": 4, "seen": (2, 3, 4, 5)}
    assert conflicts(model)[0].items() >= {**start, **sensed}.items()


def test_walls_count_for_a_flight(scene: Scene) -> None:
    # A robot ahead, walls at the right and behind: the flight range is free only towards −x.
    model = scene(
        [(0.87, -0.6, math.pi / 2)], [(0.87, -0.4, math.pi / 2), (0.6, -0.35, 2.0), (0.6, -0.87, -2.0)]
    )
    run_to(model, 2.0)
    assert model.robots[0].state == "A"
    assert math.cos(pose(model)[2]) == pytest.approx(-1)
    assert pose(model)[0] < 0.87


def test_ties_of_vacant_directions_are_broken_at_random(scene: Scene) -> None:
    chosen = []
    for seed in range(140):
        model = scene([(0.0, 0.0, 0.0)], [(0.25, 0.0, 0.0)], seed=seed)
        model.env.run(until=12)
        chosen.append(round(model.robots[0].heading / (math.pi / 4)) % 8)
    counts = np.bincount(chosen, minlength=8)
    assert counts[0] == 0
    # 20 of each of seven on average; χ² with 6 degrees of freedom stays below 22.5 in 999 of 1000 cases.
    assert ((counts[1:] - 20.0) ** 2 / 20.0).sum() < 22.5


def test_the_nearest_robot_ahead_is_met(scene: Scene) -> None:
    far, near, nearer_but_aside = (0.28, 0.05, 0.0), (0.22, -0.08, 0.0), (0.0, 0.175, 1.5)
    model = scene([(0.0, 0.0, 0.0)], [far, near, nearer_but_aside], policies="attack,avoid")
    model.env.run(until=1)
    assert model.states.opponent[0] == 2


@pytest.mark.parametrize(
    ("distance", "bearing", "met"),
    [
        (0.341, 0.0, True),  # a gap of 0.171 m
        (0.343, 0.0, False),
        (0.25, math.radians(62), True),
        (0.25, math.radians(-62), True),
        (0.25, math.radians(63), False),
        (0.25, math.pi, False),
    ],
)
def test_a_near_robot_ahead_starts_a_conflict(
    scene: Scene, distance: float, bearing: float, met: bool
) -> None:
    other = (distance * math.cos(bearing + 0.3), distance * math.sin(bearing + 0.3), bearing + 0.3)
    model = scene([(0.0, 0.0, 0.3)], [other], policies="attack,attack")
    model.env.run(until=1)
    assert (model.robots[0].state == "A") == met
    assert model.robots[0].conflicts == [0, int(met)]
    assert model.robots[1].state == "P"  # it detects no robot


def test_the_next_conflict_starts_at_once_if_its_condition_holds(scene: Scene) -> None:
    # Two robots that fight head on lock: each action ends with the other robot still ahead.
    model = scene(
        [(-0.1, 0.0, 0.0)], [(0.1, 0.0, math.pi)], policies="attack,attack", record="conflicts", duration=20.0
    )
    model.play()
    table = model.tables()["conflicts"]
    for robot in (0, 1):
        rows = [k for k, who in enumerate(table["robot"]) if who == robot]
        assert [table["start"][k] for k in rows] == pytest.approx(range(20))
        assert {table["t_p"][k] for k in rows} == {0.0}
        assert [table["t_a"][k] for k in rows] == pytest.approx([1.0] * 20)
    assert [row["t_p"] for row in model.results()] == [0.0, 0.0]


def test_program_time_is_between_action_and_next_conflict(scene: Scene) -> None:
    model = scene([(0.0, 0.0, 0.0)], FACING_AWAY, record="conflicts", duration=120.0)
    model.env.run()
    for robot in model.robots:
        log = conflicts(model, robot.index)
        for before, after in itertools.pairwise(log):
            assert after["start"] == before["start"] + before["t_a"] + before["t_p"]
        assert log[-1]["start"] + log[-1]["t_a"] + log[-1]["t_p"] == 1200
        assert robot.t_p == log[0]["start"] + sum(conflict["t_p"] for conflict in log)
        assert sum(robot.t_a) == sum(conflict["t_a"] for conflict in log)


@pytest.mark.parametrize("preempt", [False, True])
def test_another_robot_ahead_interrupts_an_action_only_with_preempt(scene: Scene, preempt: bool) -> None:
    changes = {"preempt": preempt, "fight_duration": 3.0}
    others = [(0.25, 0.0, 0.0), (0.0, 0.8, 1.0)]
    model = scene([(0.0, 0.0, 0.0)], others, policies="attack,avoid", changes=changes, record="conflicts")
    model.env.run(until=10)
    assert model.states.opponent[0] == 1
    model.states.positions[2] = pose(model)[0] + 0.18, 0.05  # overlaps the other robot
    model.env.run(until=12)
    assert model.states.opponent[0] == (2 if preempt else 1)
    assert model.robots[0].conflicts == [0, 2 if preempt else 1]
    assert [(c["t_a"], c["t_p"]) for c in conflicts(model)] == ([(10, 0)] if preempt else [])
    if preempt:
        # The end of the interrupted fight, due at 30, has no effect on the second fight.
        model.robots[1].position = np.array([-0.5, -0.5])
        model.env.run(until=38)
        assert model.robots[0].state == "A"
        assert model.robots[0].t_a == [0, 10]


def test_the_end_of_an_interrupted_turn_has_no_effect(scene: Scene) -> None:
    # A slow turn to the left of 34 periods is interrupted by a longer one to the right.
    others = [(0.3 * math.cos(1.0), 0.3 * math.sin(1.0), 1.0), (0.0, 0.8, 1.0)]
    changes = {"preempt": True, "turning_rate": 0.3}
    model = scene([(0.0, 0.0, 0.0)], others, policies="attack,avoid", changes=changes)
    model.env.run(until=5)
    heading = pose(model)[2]
    model.robots[1].position = np.array([-0.5, 0.0])
    model.robots[2].position = 0.3 * np.array([math.cos(heading - 1.05), math.sin(heading - 1.05)])
    for now in range(6, 40):
        model.env.run(until=now)
        assert model.states.stride[0] == 0
    model.env.run(until=5 + 35 + 3)
    assert pose(model)[2] == pytest.approx(heading - 1.05)
    assert math.dist(pose(model)[:2], (0.0, 0.0)) == pytest.approx(3 * 0.015)


def test_the_same_robot_does_not_interrupt(scene: Scene) -> None:
    model = scene([(0.0, 0.0, 0.0)], FACING_AWAY, policies="attack,avoid", changes={"preempt": True})
    model.env.run(until=10)
    assert model.robots[0].conflicts == [0, 1]


def test_a_conflict_drops_a_pending_turn(scene: Scene) -> None:
    # After a leg of one period a slow turn begins; then a robot comes ahead.
    changes = {"turning_rate": 0.05, "leg_mean": 1e-3}
    model = scene([(0.0, 0.0, 0.0)], [(0.0, 0.8, 1.0)], policies="attack,avoid", changes=changes)
    turn_rate = model.states.turn_rate
    model.env.run(until=4)
    assert turn_rate[0] != 0
    x, y, heading = pose(model)
    model.robots[1].position = np.array([x + 0.2 * math.cos(heading), y + 0.2 * math.sin(heading)])
    for now in range(5, 15):
        model.env.run(until=now)
        assert model.robots[0].state == "A"
        assert turn_rate[0] == 0
    assert pose(model)[2] == pytest.approx(heading)
