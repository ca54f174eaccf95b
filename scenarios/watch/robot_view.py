"""State of one robot for display: its sensors, its activity and its knowledge."""

import math
from bisect import bisect_left
from operator import attrgetter
from typing import Final, NamedTuple

import numpy as np

from kswarms.agents.body import SENSORS
from kswarms.agents.policies.learner import Learner
from kswarms.agents.robot.sensing import sense
from kswarms.agents.robot.state import ACTION, HOME, HOME_TURN, IDLE, LEG, LEG_OVER, TURN
from kswarms.model.game_model import GameModel
from kswarms.scenarios.watch.conflicts import Arm, arms_of

_DOING: Final = {
    IDLE: "decides",
    LEG: "wanders",
    LEG_OVER: "decides",
    TURN: "turns",
    HOME_TURN: "turns home",
    HOME: "drives home",
    ACTION: "in conflict",
}


class Sensor(NamedTuple):
    """One of the eight proximity sensors."""

    angle: float  # of its centre, relative to the heading (rad)
    free: float  # from the robot's surface to the nearest obstacle in its sector, at most its range (m)
    active: bool  # whether it counts in n'_i (Eq. 5.4)


class RobotView(NamedTuple):
    """State of a robot; times and counts are those of the current phase."""

    robot: int
    swarm: int  # from 1
    policy: str  # as the game describes it
    doing: str
    opponent: str  # the robot met last; empty before the first conflict, and if that robot has left
    carrying: bool
    pucks: int
    t_a: tuple[float, ...]  # T(a) against each swarm (s)
    t_p: float  # T(p) (s)
    conflicts: tuple[int, ...]  # begun, against each swarm
    sensors: tuple[Sensor, ...]  # counter-clockwise from the one ahead
    learning: bool
    rule: str  # the selection rule; empty if the robot does not learn
    bandits: dict[int, tuple[Arm, ...]]  # for each swarm learned about, from 1


def row_of(model: GameModel, number: int) -> int | None:
    """Return the row of a robot in the state arrays, by its number; None if it is absent."""
    row = bisect_left(model.robots, number, key=attrgetter("number"))
    return row if row < len(model.robots) and model.robots[row].number == number else None


def view_robot(model: GameModel, number: int) -> RobotView | None:
    """Return the current state of a robot, by its number; None if it is absent."""
    index = row_of(model, number)
    if index is None:
        return None
    robot = model.robots[index]
    seconds = model.controller.seconds
    t_a, t_p = robot.times()
    met = model.states.opponent[index]
    learner = robot.policy if isinstance(robot.policy, Learner) else None
    return RobotView(
        number,
        robot.swarm + 1,
        robot.policy_name,
        _DOING[model.states.phase[index]],
        f"robot {model.robots[met].number} of S{model.states.swarm[met] + 1}" if met >= 0 else "",
        robot.carrying,
        robot.pucks,
        tuple(seconds(periods) for periods in t_a),
        seconds(t_p),
        tuple(robot.conflicts),
        _read_sensors(model, index),
        learner is not None and learner.learning,
        repr(learner.rule) if learner else "",
        {m + 1: arms_of(learner, bandit) for m, bandit in learner.bandits.items()} if learner else {},
    )


def _read_sensors(model: GameModel, index: int) -> tuple[Sensor, ...]:
    body, parameters = model.game.body, model.game.parameters
    reach = body.sensor_range
    bodies = model.states.bodies
    free = np.empty(SENSORS)
    others = np.arange(len(model.robots), dtype=np.uint32)
    state = bodies.forward_x[index], bodies.forward_y[index], bodies.x, bodies.y
    sense(index, *state, others, len(others), body.radius, model.arena.half, reach, free)
    limit = body.sensing_scale * parameters.active_range
    return tuple(
        Sensor(sensor * 2 * math.pi / SENSORS, min(distance, reach), distance <= limit)
        for sensor, distance in enumerate(free.tolist())
    )
