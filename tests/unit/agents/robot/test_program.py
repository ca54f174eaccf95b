"""Behaviour of a robot between conflicts, in games set up by hand (section 2.3)."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from kswarms.agents.robot.krembot import Krembot
from kswarms.agents.robot.sensing import heads_for, walls_met
from kswarms.agents.robot.state import HOMING_ERROR
from kswarms.agents.streams import Purpose, stream
from kswarms.model.game_model import GameModel

Scene = Callable[..., GameModel]

STEP = 2.96 * 0.1
"""Maximum turn in a period (rad)."""


def pose(model: GameModel, robot: int = 0) -> tuple[float, float, float]:
    x, y = model.robots[robot].position
    return float(x), float(y), model.robots[robot].heading


def carry(model: GameModel, robot: int = 0) -> None:
    model.robots[robot].pick_up()
    model.picked_up += 1


def test_homing_turns_in_place_and_drives_straight(scene: Scene) -> None:
    model = scene([(-0.1, 0.2, 0.0)], changes={"leg_mean": 0.2})
    carry(model)
    target = math.atan2(-0.2, -0.7)
    turn = math.ceil(abs(target) / STEP)
    model.env.run(until=turn)
    assert pose(model) == pytest.approx((-0.1, 0.2, target))
    for now in range(turn + 1, turn + 36):
        before = model.robots[0].position.copy()
        model.env.run(until=now)
        # The legs of the wandering, 0.2 s long, have no effect.
        assert pose(model)[2] == pytest.approx(target)
        assert math.dist(before, model.robots[0].position) == pytest.approx(0.015)
    assert (model.pucks, model.robots[0].carrying) == ([0], True)
    model.env.run(until=turn + 40)
    assert (model.pucks, model.robots[0].carrying, model.robots[0].pucks) == ([1], False, 1)


@pytest.mark.parametrize("offset", [0.04, -0.04, 0.06, -0.06])
def test_homing_tolerates_a_small_error(scene: Scene, offset: float) -> None:
    model = scene([(-0.1, 0.0, math.pi + offset)])
    carry(model)
    model.env.run(until=1)
    drives = math.dist(pose(model)[:2], (-0.1, 0.0)) > 0
    assert drives == (abs(offset) < HOMING_ERROR)


def test_a_homing_robot_turns_again_when_the_error_grows(scene: Scene) -> None:
    model = scene([(-0.1, 0.0, math.pi + 0.045)])
    carry(model)
    base = model.arena.bases[0]
    while model.pucks == [0]:
        x, y, heading = pose(model)
        error = math.remainder(math.atan2(base[1] - y, base[0] - x) - heading, 2 * math.pi)
        model.env.run(until=model.env.now + 1)
        if math.dist(pose(model)[:2], (x, y)) > 0:
            assert abs(error) <= HOMING_ERROR + 1e-9


def test_a_robot_out_of_sight_of_its_base_wanders(scene: Scene) -> None:
    model = scene([(0.03, 0.0, 0.5)])
    carry(model)
    model.env.run(until=1)
    assert pose(model)[2] == 0.5
    assert math.dist(pose(model)[:2], (0.03, 0.0)) == pytest.approx(0.015)


def test_bases_of_other_swarms_do_not_count(scene: Scene) -> None:
    model = scene([(0.78, 0.0, 1.0)], [(0.0, 0.0, 0.0)])
    carry(model)
    model.env.run(until=10)
    assert (model.pucks, model.robots[0].carrying) == ([0, 0], True)


def test_pucks_are_picked_up_and_deposited_during_actions(scene: Scene) -> None:
    # Robot 0 fights across a station, robot 2 across its base.
    model = scene(
        [(-0.2, 0.66, 0.0), (-1 + 0.13, -0.4, math.pi / 2)],
        [(0.05, 0.66, 0.0), (-1 + 0.13, -0.15, math.pi / 2)],
        policies="attack,avoid",
        changes={"fight_duration": 5.0},
    )
    carry(model, 1)
    for _ in range(50):
        model.env.run(until=model.env.now + 1)
        assert [robot.state for robot in model.robots[:2]] == ["A", "A"]
    assert model.robots[0].carrying
    assert not model.robots[1].carrying
    assert model.pucks == [1, 0]


@pytest.mark.parametrize(("drive", "drive_action"), [(0.6, 0.6), (0.7, 0.6), (0.3, 0.9)])
def test_program_and_action_have_their_own_drives(scene: Scene, drive: float, drive_action: float) -> None:
    drives = (drive, drive_action)
    alone = scene([(0.0, 0.0, 0.0)], drives=drives)
    carrying = scene([(-0.3, 0.0, math.pi)], drives=drives)
    carry(carrying)
    fighter = scene([(0.0, 0.0, 0.0)], [(0.3, 0.0, 0.0)], policies="attack,avoid", drives=drives)
    for model, x, expected in ((alone, 0.0, drive), (carrying, -0.3, drive), (fighter, 0.0, drive_action)):
        model.env.run(until=3)
        assert abs(pose(model)[0] - x) == pytest.approx(3 * 0.1 * 0.25 * expected)


def test_turning_does_not_depend_on_the_drive(scene: Scene) -> None:
    for drive in (0.3, 0.6, 1.0):
        model = scene([(0.0, 0.0, math.pi / 2)], changes={"base_range": 1.9}, drives=(drive, drive))
        carry(model)
        model.env.run(until=3)
        turned = 3 * (math.pi / 2) / math.ceil(math.pi / 2 / STEP)
        assert pose(model)[2] == pytest.approx(math.pi / 2 + turned)


def test_a_wander_turn_is_its_draw_in_whole_periods(scene: Scene) -> None:
    # Legs of one period, far from the walls.
    limit = math.radians(40)
    changes = {"leg_mean": 1e-6, "wander_turn": limit, "station_radius": 0.01}
    model = scene([(0.0, 0.0, 0.0)], changes=changes, seed=6)
    rng = stream(6, 0, Purpose.WANDER)
    heading, now = 0.0, 0
    for _ in range(20):
        angle = rng.uniform(-limit, limit)
        heading, now = heading + angle, now + 1 + math.ceil(abs(angle) / STEP)
        model.env.run(until=now)
        assert math.remainder(pose(model)[2] - heading, 2 * math.pi) == pytest.approx(0, abs=1e-9)
    assert math.dist(pose(model)[:2], (0.0, 0.0)) < 0.31


CORNERS = [(0.90, 0.90, 0.8), (-0.91, 0.0, 3.0), (0.3, -0.91, -1.0), (-0.86, 0.9, 2.2)]


def wall_turns(scene: Scene, start: tuple[float, float, float], **changes: Any) -> list[float]:
    """Return the headings after the turn at a wall, for many seeds."""
    headings = []
    for seed in range(60):
        model = scene([start], changes=changes, seed=seed)
        model.env.run(until=1)
        assert model.states.turn_rate[0] != 0
        while model.states.turn_rate[0] != 0:
            model.env.run(until=model.env.now + 1)
        headings.append(pose(model)[2])
        assert math.dist(pose(model)[:2], start[:2]) < 0.016  # it turned in place and drives now
    return headings


@pytest.mark.parametrize("start", CORNERS)
def test_a_clear_escape_meets_no_wall(scene: Scene, start: tuple[float, float, float]) -> None:
    for heading in wall_turns(scene, start):
        assert walls_met(*start[:2], heading, 1.0, 0.085 + 0.06, 0.0) == 0


@pytest.mark.parametrize("start", CORNERS)
def test_an_escape_away_points_away_from_the_walls_met(
    scene: Scene, start: tuple[float, float, float]
) -> None:
    met = walls_met(*start, 1.0, 0.085 + 0.1, math.pi / 4)
    changes = {"wall_escape": "away", "wall_half_angle": math.pi / 4, "wall_distance": 0.1}
    headings = wall_turns(scene, start, **changes)
    assert met != 0
    assert not any(heads_for(heading, met) for heading in headings)
    assert np.ptp(headings) > 0.5


def test_walls_are_ignored_in_action_and_on_the_way_home(scene: Scene) -> None:
    # A fighter follows its opponent along and into the wall.
    changes = {"fight_duration": 4.0}
    model = scene([(0.5, 0.9, 0.0)], [(0.75, 0.9, 0.0)], policies="attack,avoid", changes=changes)
    model.env.run(until=39)
    assert model.robots[0].state == "A"
    assert pose(model)[2] == pytest.approx(0.0)
    # With a base at the wall, a robot drives home along the wall.
    model = scene([(-0.915, 0.7, -1.4)], changes={"wall_distance": 0.5, "base_range": 1.0})
    carry(model)
    while model.pucks == [0]:
        model.env.run(until=model.env.now + 1)
        assert model.env.now < 70


@pytest.fixture
def legs(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Record the starts of legs (periods)."""
    starts: list[int] = []
    begin = Krembot.begin_leg

    def record_leg(robot: Krembot) -> None:
        starts.append(int(robot._env.now))
        begin(robot)

    monkeypatch.setattr(Krembot, "begin_leg", record_leg)
    return starts


def test_a_new_leg_begins_after_every_turn(
    scene: Scene, legs: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    turns = []
    begin = Krembot.begin_wall_turn

    def record_turn(robot: Krembot) -> None:
        turns.append(int(robot._env.now))
        begin(robot)

    monkeypatch.setattr(Krembot, "begin_wall_turn", record_turn)
    # Stations are tiny, so it never carries a puck home.
    model = scene([(0.0, 0.0, 0.3)], changes={"leg_mean": 1e6, "station_radius": 0.01}, duration=300.0)
    model.env.run(until=2999)
    assert len(turns) > 10
    for turn, leg in zip(turns, legs[1:], strict=False):
        assert turn < leg <= turn + math.ceil(math.pi / STEP)
    assert len(turns) <= len(legs) <= len(turns) + 1


def test_a_new_leg_begins_after_an_action(scene: Scene, legs: list[int]) -> None:
    model = scene([(0.0, 0.0, 0.0)], [(0.25, 0.0, 0.0)], changes={"leg_mean": 1e6})
    model.env.run(until=1)
    assert legs == [0]  # the leg of robot 1
    while model.robots[0].state == "A":
        model.env.run(until=model.env.now + 1)
    action = model.robots[0].t_a[1]
    assert legs == [0, action]


def test_the_nearest_robot_gets_the_last_puck(scene: Scene) -> None:
    # The station is at (0, 0.66).
    model = scene([(-0.09, 0.66, math.pi), (0.085, 0.66, 0.0)], [(0.0, 0.81, 1.57)], supply=1)
    model.env.run(until=1)
    assert [robot.carrying for robot in model.robots] == [False, True, False]
    assert model.supply == [0, 1]


def test_an_empty_station_gives_nothing(scene: Scene) -> None:
    model = scene([(0.0, 0.66, 0.0), (-0.17, 0.66, 0.0)], supply=1)
    model.env.run(until=20)
    assert model.supply == [0, 1]
    assert model.picked_up == 1
