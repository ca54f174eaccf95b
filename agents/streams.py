"""Random streams named by (seed, robot, purpose).

Every draw of a game comes from the stream of the robot that draws and of the decision it draws
for. So two games with one seed differ only where they differ, and one robot more leaves the draws
of the others alone.
"""

from enum import IntEnum
from typing import Final

from numpy.random import PCG64, Generator, SeedSequence

WORLD: Final = 2**32 - 1
"""Robot number under which the world itself draws."""


class Purpose(IntEnum):
    """What a stream is for. Values are part of every result: never change one, only add."""

    POSITION = 0
    HEADING = 1
    LEG = 2
    WANDER = 3
    WALL = 4
    VACANT = 5
    STATIONS = 6
    EXPLORE = 7
    POLICY = 8


def stream(seed: int, robot: int, purpose: Purpose) -> Generator:
    """Return the generator of one robot for one purpose, at its start.

    Parameters
    ----------
    seed : int
        Seed of the run, ≥ 0.
    robot : int
        Number of the robot in its game, or `WORLD`.
    purpose : Purpose
        The decision that the draws are for.
    """
    return Generator(PCG64(SeedSequence(seed, spawn_key=(robot, int(purpose)))))


class Streams:
    """The streams of one robot, each begun when it is first drawn from.

    Parameters
    ----------
    seed, robot : int
        As in `stream`.
    """

    def __init__(self, seed: int, robot: int) -> None:
        self.seed = seed
        self.robot = robot
        self._begun: dict[Purpose, Generator] = {}

    def draws(self, purpose: Purpose) -> Generator:
        """Return the stream for a purpose, where it now is."""
        draws = self._begun.get(purpose)
        if draws is None:
            draws = self._begun[purpose] = stream(self.seed, self.robot, purpose)
        return draws
