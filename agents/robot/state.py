"""The arrays that the robots and the motion kernel share: one row for each robot.

A robot writes its row when it decides; the kernel moves the bodies and reads what to watch for.
Lengths are metres, angles radians in (−π, π], times control periods.
"""

from typing import Final, cast

import numpy as np

from kswarms.agents.common.arrays import Floats, Integers, Records

ROBOT: Final = np.dtype(
    [
        ("swarm", np.int64),  # swarm, counted from 0
        ("phase", np.int64),  # one of the constants below
        ("carrying", np.int64),  # 1 with a puck, 0 without
        ("opponent", np.int64),  # robot met last, -1 before the first conflict
        ("heading", np.float64),  # direction (rad)
        ("forward_x", np.float64),  # unit vector of the heading
        ("forward_y", np.float64),
        ("stride", np.float64),  # what the wheels drive forward in a period (m), 0 in place
        ("turn_rate", np.float64),  # change of heading in a period (rad), 0 while driving
    ]
)
"""One robot's row."""

# What a robot is doing. All below ACTION belong to state P, ACTION is state A.
IDLE: Final = 0
"""Nothing yet: asks for a decision at the next percepts."""
LEG: Final = 1
"""Wandering straight ahead."""
LEG_OVER: Final = 2
"""The wander clock has run out: asks for a turn."""
TURN: Final = 3
"""Turning in place, for the wandering or for a wall."""
HOME_TURN: Final = 4
"""Turning in place towards the own base."""
HOME: Final = 5
"""Driving straight to the own base, carrying a puck."""
ACTION: Final = 6
"""Resolving a conflict, turn included."""


HOMING_ERROR: Final = 0.05
"""A robot on its way home turns where it is off by more than this angle (rad)."""


class Fleet:
    """State of all robots.

    Parameters
    ----------
    positions : ndarray of float64, shape (n, 2)
        Centres (m); kept, not copied, so that it can be the array of Mesa's space.
    swarm : ndarray of int64, shape (n,)
        Swarm of each robot, counted from 0.
    headings : ndarray of float64, shape (n,)
        Directions at the start (rad).

    Attributes
    ----------
    robots : ndarray of `ROBOT`, shape (n,)
        What the kernel is given.
    swarm, phase, carrying, opponent, heading, stride, turn_rate : memoryview, shape (n,)
        Its fields, as views: to read or write one number, twice as fast as an array.
    """

    def __init__(self, positions: Floats, swarm: Integers, headings: Floats) -> None:
        self.positions = positions
        self.robots: Records = np.zeros(len(swarm), dtype=ROBOT)
        self.robots["swarm"] = swarm
        self.robots["phase"] = IDLE
        self.robots["opponent"] = -1
        self.robots["heading"] = headings
        self.robots["forward_x"] = np.cos(headings)
        self.robots["forward_y"] = np.sin(headings)
        self._view()

    def keep(self, rows: Integers, positions: Floats) -> None:
        """Let only some robots stay, and close their ranks.

        Parameters
        ----------
        rows : ndarray of int64, shape (m,)
            Rows of those who stay, ascending; they are then rows 0 … m − 1, in the same memory.
        positions : ndarray of float64, shape (m, 2)
            Their centres (m); kept, not copied.
        """
        new_row = np.full(len(self.robots) + 1, -1)  # its last entry is that of the opponent −1
        new_row[rows] = np.arange(len(rows))
        self.robots["opponent"] = new_row[self.robots["opponent"]]
        self.robots[: len(rows)] = self.robots[rows]
        self.robots = self.robots[: len(rows)]
        self.positions = positions
        self._view()

    def _view(self) -> None:
        self.swarm = self.robots["swarm"].data
        self.phase = self.robots["phase"].data
        self.carrying = self.robots["carrying"].data
        self.opponent = self.robots["opponent"].data
        self.heading = cast("memoryview[float]", self.robots["heading"].data)
        self.stride = cast("memoryview[float]", self.robots["stride"].data)
        self.turn_rate = cast("memoryview[float]", self.robots["turn_rate"].data)
