"""State arrays that robots and kernel share: one row for each robot.

A robot writes its row when it decides; the kernel moves the bodies and reads the phases. Lengths are metres,
angles radians in (−π, π], times control periods.
"""

from typing import Final, NamedTuple, cast

import numpy as np
from numpy.typing import ArrayLike

from kswarms.agents.common.arrays import Floats, Integers
from kswarms.agents.common.errors import InputError


class Bodies(NamedTuple):
    """Contiguous arrays of the kernel, float64 or int64, shape (n,)."""

    x: Floats  # centre (m)
    y: Floats
    heading: Floats  # direction (rad)
    forward_x: Floats  # unit vector of the heading
    forward_y: Floats
    stride: Floats  # forward motion in a period (m), 0 while turning in place
    turn_rate: Floats  # change of heading in a period (rad), 0 while driving
    moved_x: Floats  # displacement in the last period (m), without the relaxation of overlaps
    moved_y: Floats
    swarm: Integers  # swarm, counted from 0
    phase: Integers  # one of the constants below
    carrying: Integers  # 1 with a puck, 0 without
    opponent: Integers  # opponent of the latest conflict, -1 before the first


N_MOTION: Final = Bodies._fields.index("swarm") - 2
"""Number of float fields besides x and y."""

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

    Parameters
    ----------
    positions : ndarray of float64, shape (n, 2)
        Centres (m). The array is copied unless its columns are contiguous.
    swarm : ndarray of int64, shape (n,)
        Swarm of each robot, from 0.
    headings : ndarray of float64, shape (n,)
        Headings (rad).

    Attributes
    ----------
    positions : ndarray of float64, shape (n, 2)
        Centres (m). The array is shared with Mesa's space.
    motion, roles : ndarray, shape (7, n) and (4, n)
        The float and the integer fields of `Bodies` after `x` and `y`, one in each row. After a removal, only
        the first columns are in use.
    bodies : Bodies
        The rows of these arrays; `x` and `y` are the columns of `positions`.
    x, y, swarm, phase, carrying, opponent, heading, stride, turn_rate : memoryview, shape (n,)
        Views of the arrays; reading or writing one number is twice as fast as with arrays.
    numbers : list of int
        Number of the robot in each row. Numbers never change; rows change when a robot is removed.
    """

    def __init__(self, positions: Floats, swarm: Integers, headings: Floats) -> None:
        n = len(swarm)
        self.numbers = list(range(n))
        self.positions = _by_columns(positions)
        self.motion = np.zeros((N_MOTION, n))
        self.roles = np.zeros((len(Bodies._fields) - 2 - N_MOTION, n), dtype=np.int64)
        self._view(n)
        bodies = self.bodies
        bodies.heading[:] = headings
        bodies.forward_x[:] = np.cos(headings)
        bodies.forward_y[:] = np.sin(headings)
        bodies.swarm[:] = swarm
        bodies.phase[:] = IDLE
        bodies.opponent[:] = -1

    def keep(self, rows: Integers, positions: Floats) -> None:
        """Keep only some rows, ascending, shape (m,); they become rows 0 … m − 1 in the same memory.

        `positions` are the centres of these robots (m), shape (m, 2), in contiguous columns.
        """
        opponent = self.bodies.opponent
        new_row = np.full(len(opponent) + 1, -1)  # the last entry is for opponent −1
        new_row[rows] = np.arange(len(rows))
        opponent[:] = new_row[opponent]
        self.positions = _by_columns(positions)
        for block in (self.motion, self.roles):
            block[:, : len(rows)] = block[:, rows]
        self.numbers = [self.numbers[row] for row in rows]
        self._view(len(rows))

    def copy_row(self, row: int) -> "RobotStates":
        """Return a copy of the state of one robot."""
        rows = slice(row, row + 1)
        copy = RobotStates(self.positions[rows].copy(), self.bodies.swarm[rows], self.bodies.heading[rows])
        for new, old in zip(copy.bodies, self.bodies, strict=True):
            new[:] = old[rows]
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

    def _view(self, n: int) -> None:
        self.bodies = bodies = Bodies(*self.positions.T, *self.motion[:, :n], *self.roles[:, :n])
        self.x = cast("memoryview[float]", bodies.x.data)
        self.y = cast("memoryview[float]", bodies.y.data)
        self.swarm = bodies.swarm.data
        self.phase = bodies.phase.data
        self.carrying = bodies.carrying.data
        self.opponent = bodies.opponent.data
        self.heading = cast("memoryview[float]", bodies.heading.data)
        self.stride = cast("memoryview[float]", bodies.stride.data)
        self.turn_rate = cast("memoryview[float]", bodies.turn_rate.data)


def _by_columns(positions: Floats) -> Floats:
    """Return an array with contiguous columns: the same one if it has them."""
    return positions if positions.strides[0] == positions.itemsize else np.asfortranarray(positions)
