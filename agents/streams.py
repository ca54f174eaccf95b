"""Random streams, identified by (seed, robot, purpose).

Every robot has a stream for each kind of decision. Two games with the same seed therefore draw the same
numbers for the same decisions, and an additional robot does not change the numbers of the others.
"""

from collections.abc import Iterator
from enum import IntEnum
from typing import Final

from numpy.random import PCG64, Generator, SeedSequence

_FIRST_BLOCK: Final = 4
_LARGEST_BLOCK: Final = 16
ENVIRONMENT: Final = 2**32 - 1  # in place of a robot's number, for streams of the environment


class Purpose(IntEnum):
    """Purpose of a stream. Results depend on the values: add new ones, but never change one."""

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
    """Return a new generator of a stream; `robot` is its number in the game, or `ENVIRONMENT`."""
    return Generator(PCG64(SeedSequence(seed, spawn_key=(robot, int(purpose)))))


class Streams:
    """The streams of one robot, see `stream`; each is created on first use."""

    def __init__(self, seed: int, robot: int) -> None:
        self.seed = seed
        self.robot = robot
        self._streams: dict[Purpose, Generator] = {}

    def generator(self, purpose: Purpose) -> Generator:
        """Return the stream for a purpose, always the same object."""
        generator = self._streams.get(purpose)
        if generator is None:
            generator = self._streams[purpose] = stream(self.seed, self.robot, purpose)
        return generator

    def draws(self, purpose: Purpose, method: str, *arguments: float) -> Iterator[float]:
        """Yield the numbers that a method of the stream draws, such as ``uniform`` with its two limits.

        The numbers are those of single draws. They are drawn in blocks, which takes a fraction of the time.
        The blocks grow, because a robot of a large swarm may need few of them.
        """
        draw = getattr(self.generator(purpose), method)
        size = _FIRST_BLOCK
        while True:
            yield from draw(*arguments, size).tolist()
            size = min(2 * size, _LARGEST_BLOCK)
