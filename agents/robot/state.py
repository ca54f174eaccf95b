"""State arrays that robots and kernel share: one row for each robot.

A robot writes its row when it decides; the kernel moves the bodies and reads the phases. Lengths are metres,
angles radians in (−π, π], times control periods.
"""

from typing import Final, cast

import numpy as np
from numpy.typing import ArrayLike

from kswarms.agents.common.arrays import Floats, Integers, Records
from kswarms.agents.common.errors import InputError

ROBOT: Final = np.dtype(
    [
        ("swarm", np.int64),  # swarm, counted from 0
        ("phase", np.int64),  # one of the constants below
        ("carrying", np.int64),  # 1 with a puck, 0 without
        ("opponent", np.int64),  # opponent of the latest conflict, -1 before the first
        ("heading", np.float64),  # direction (rad)
        ("forward_x", np.float64),  # unit vector of the heading
        ("forward_y", np.float64),
        ("stride", np.float64),  # forward motion in a period (m), 0 while turning in place
        ("turn_rate", np.float64),  # change of heading in a period (rad), 0 while driving
    ]
)
"""Row of a robot."""

# Phases. ACTION is state A, all others are state P.
IDLE: Final = 0  # waiting for a decision at the next percepts
LEG: Final = 1  # wandering straight ahead
LEG_OVER: Final = 2  # the leg is over: waiting for the decision to turn
TURN: Final = 3  # turning in place between legs or at a wall
HOME_TURN: Final = 4  # turning in place towards the own base
HOME: Final = 5  # driving to the own base with a puck
ACTION: Final = 6  # resolving a conflict, including the turn

HOMING_ERROR: Final = 0.05  # a robot on its way home turns if its heading is off by more (rad)

_OVERLAP: Final = 1e-4  # maximum overlap of two bodies (m)
_ROUNDING: Final = 1e-9  # maximum rounding error of a position (m)


class RobotStates:
    """States of n robots.

    Attributes
    ----------
    positions : ndarray of float64, shape (n, 2)
        Centres (m). The array is shared with Mesa's space, not copied.
    robots : ndarray of `ROBOT`, shape (n,)
        The array for the kernel.
    swarm, phase, carrying, opponent, heading, stride, turn_rate : memoryview, shape (n,)
        Views of its fields; reading or writing one number is twice as fast as with arrays.
    numbers : list of int
        Number of the robot in each row. Numbers never change; rows change when a robot is removed.
    """

    def __init__(self, positions: Floats, swarm: Integers, headings: Floats) -> None:
        self.positions = positions
        self.numbers = list(range(len(swarm)))
        self.robots: Records = np.zeros(len(swarm), dtype=ROBOT)
        self.robots["swarm"] = swarm
        self.robots["phase"] = IDLE
        self.robots["opponent"] = -1
        self.robots["heading"] = headings
        self.robots["forward_x"] = np.cos(headings)
        self.robots["forward_y"] = np.sin(headings)
        self._view()

    def keep(self, rows: Integers, positions: Floats) -> None:
        """Keep only some rows, ascending, shape (m,); they become rows 0 … m − 1 in the same memory.

        `positions` are the centres of these robots (m), shape (m, 2). The array is not copied.
        """
        new_row = np.full(len(self.robots) + 1, -1)  # the last entry is for opponent −1
        new_row[rows] = np.arange(len(rows))
        self.robots["opponent"] = new_row[self.robots["opponent"]]
        self.robots[: len(rows)] = self.robots[rows]
        self.robots = self.robots[: len(rows)]
        self.positions = positions
        self.numbers = [self.numbers[row] for row in rows]
        self._view()

    def copy_row(self, row: int) -> "RobotStates":
        """Return a copy of the state of one robot."""
        rows = slice(row, row + 1)
        robots = self.robots[rows]
        copy = RobotStates(self.positions[rows].copy(), robots["swarm"], robots["heading"])
        copy.robots[:] = robots
        return copy

    def move(self, row: int, place: ArrayLike, half: float, radius: float) -> None:
        """Move a robot to a place (m), shape (2,), where it overlaps no other robot and no wall.

        `half` is half the side of the arena, `radius` the radius of every body (m).
        """
        try:
            point = np.asarray(place, dtype=np.float64)
        except (TypeError, ValueError):
            point = np.empty(0)
        limit = half - radius
        if point.shape != (2,) or not np.abs(point).max() <= limit + _ROUNDING:  # refuses NaN, too
            raise InputError("position", place, f"must be two numbers from {-limit} to {limit} (m)")
        distances = np.hypot(*(self.positions - point).T)
        distances[row] = np.inf
        nearest = int(distances.argmin())
        if distances[nearest] < 2 * radius - _OVERLAP:
            raise InputError("position", place, f"must not overlap robot {self.numbers[nearest]}")
        self.positions[row] = point

    def _view(self) -> None:
        self.swarm = self.robots["swarm"].data
        self.phase = self.robots["phase"].data
        self.carrying = self.robots["carrying"].data
        self.opponent = self.robots["opponent"].data
        self.heading = cast("memoryview[float]", self.robots["heading"].data)
        self.stride = cast("memoryview[float]", self.robots["stride"].data)
        self.turn_rate = cast("memoryview[float]", self.robots["turn_rate"].data)
