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
    """One of the eight proximity sensors.

    Attributes
    ----------
    angle : float
        Direction of its centre relative to the heading (rad).
    free : float
        Distance from the robot's surface to the nearest obstacle in its sector, at most its range (m).
    active : bool
        Whether it counts in n'_i (Eq. 5.4).
    """

    angle: float
    free: float
    active: bool


class RobotView(NamedTuple):
    """State of a robot.

    Attributes
    ----------
    robot, swarm : int
        Number from 0; swarm-ID from 1.
    policy : str
        As the game describes it.
    doing : str
        Current activity in words.
    opponent : str
        The robot met last; empty before the first conflict, and if that robot has left.
    carrying : bool
        Whether it carries a puck.
    pucks : int
        Pucks deposited in this phase.
    t_a : tuple of float
        T(a) for each opposing swarm (s).
    t_p : float
        T(p) (s).
    conflicts : tuple of int
        Conflicts begun, for each opposing swarm.
    sensors : tuple of Sensor
        Counter-clockwise from the one ahead.
    learning : bool
        Whether it is still learning.
    rule : str
        Its selection rule; empty if it does not learn.
    bandits : dict of int to tuple of Arm
        What it knows about its actions against each swarm learned about, from 1.
    """

    robot: int
    swarm: int
    policy: str
    doing: str
    opponent: str
    carrying: bool
    pucks: int
    t_a: tuple[float, ...]
    t_p: float
    conflicts: tuple[int, ...]
    sensors: tuple[Sensor, ...]
    learning: bool
    rule: str
    bandits: dict[int, tuple[Arm, ...]]


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
    row = model.states.robots[index]
    free = np.empty(SENSORS)
    others = np.arange(len(model.robots))
    state = row["forward_x"], row["forward_y"], model.states.positions
    sense(index, *state, others, len(others), body.radius, model.arena.half, reach, free)
    limit = body.sensing_scale * parameters.active_range
    return tuple(
        Sensor(sensor * 2 * math.pi / SENSORS, min(distance, reach), distance <= limit)
        for sensor, distance in enumerate(free.tolist())
    )
