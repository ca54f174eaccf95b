"""Random streams, identified by (seed, robot, purpose).

Every robot has a stream for each kind of decision. Two games with the same seed therefore draw the same
numbers for the same decisions, and an additional robot does not change the numbers of the others.
"""

from collections.abc import Iterator
from enum import IntEnum
from itertools import chain
from typing import Any, Final

import numpy as np
from numpy.random import PCG64, Generator, SeedSequence
from numpy.random.bit_generator import ISpawnableSeedSequence
from numpy.typing import NDArray

from kswarms.agents.common.arrays import Floats

_FIRST_BLOCK: Final = 4
_LARGEST_BLOCK: Final = 64
_POOL: Final = 4
"""Words in the pool of a `SeedSequence`."""
_INIT_A: Final = 0x43B0D7E5
_MULTIPLY_A: Final = 0x931E8875
_INIT_B: Final = 0x8B51F9DD
_MULTIPLY_B: Final = 0x58F38DED
_MIX_LEFT: Final = np.uint32(0xCA01F9DD)
_MIX_RIGHT: Final = np.uint32(0x4973F715)
_SHIFT: Final = np.uint32(16)

Words = NDArray[np.uint64]

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


def seed_words(seed: int, robots: int, purpose: Purpose) -> Words:
    """Return the seeds of the streams of robots 0 … `robots` − 1, uint64, shape (robots, 4).

    They are the words that `SeedSequence` generates for a PCG64, computed together, which takes a fraction of
    the time.
    """
    pool = [np.full(robots, word, dtype=np.uint32) for word in SeedSequence(seed).pool]
    extra = max(0, (seed.bit_length() + 31) // 32 - _POOL)
    constant = _INIT_A * pow(_MULTIPLY_A, _POOL * (_POOL + extra), 2**32)
    numbers, purposes = np.arange(robots, dtype=np.uint32), np.full(robots, int(purpose), dtype=np.uint32)
    for words in (numbers, purposes):  # the spawn key
        for k in range(_POOL):
            mixed, constant = _hash(words, constant, _MULTIPLY_A)
            pool[k] = _MIX_LEFT * pool[k] - _MIX_RIGHT * mixed
            pool[k] ^= pool[k] >> _SHIFT
    constant = _INIT_B
    seeds = np.zeros((robots, 4), dtype=np.uint64)
    for k in range(2 * _POOL):
        words, constant = _hash(pool[k % _POOL], constant, _MULTIPLY_B)
        seeds[:, k // 2] |= words.astype(np.uint64) << np.uint64(32 * (k % 2))
    return seeds


def _hash(words: NDArray[np.uint32], constant: int, multiplier: int) -> tuple[NDArray[np.uint32], int]:
    following = constant * multiplier % 2**32
    mixed = (words ^ np.uint32(constant % 2**32)) * np.uint32(following)
    return mixed ^ (mixed >> _SHIFT), following


class Seeds:
    """The seeds of all robots of a game, by purpose; each table is computed on first use."""

    def __init__(self, seed: int, robots: int) -> None:
        self.seed = seed
        self._robots = robots
        self._words: dict[Purpose, Words] = {}

    def words(self, robot: int, purpose: Purpose) -> Words:
        """Return the seed of a stream, shape (4,)."""
        words = self._words.get(purpose)
        if words is None:
            words = self._words[purpose] = seed_words(self.seed, self._robots, purpose)
        row: Words = words[robot]
        return row


class _Seed(ISpawnableSeedSequence):
    """The `SeedSequence` of a stream, with the words for a PCG64 at hand."""

    def __init__(self, seeds: Seeds, robot: int, purpose: Purpose) -> None:
        self._words = seeds.words(robot, purpose)
        self._key = seeds.seed, robot, purpose
        self._sequence: SeedSequence | None = None

    def generate_state(self, n_words: int, dtype: Any = np.uint32) -> Any:
        if n_words == len(self._words) and dtype is np.uint64:
            return self._words
        return self._whole().generate_state(n_words, dtype)

    def spawn(self, n_children: int) -> list[Any]:
        return self._whole().spawn(n_children)

    def _whole(self) -> SeedSequence:
        if self._sequence is None:
            seed, robot, purpose = self._key
            self._sequence = SeedSequence(seed, spawn_key=(robot, int(purpose)))
        return self._sequence


class Streams:
    """The streams of one robot, see `stream`; each is created on first use. `seeds` of the game save time."""

    def __init__(self, seed: int, robot: int, seeds: Seeds | None = None) -> None:
        self._seeds = seeds
        self.seed = seed
        self.robot = robot
        self._streams: dict[Purpose, Generator] = {}

    def generator(self, purpose: Purpose) -> Generator:
        """Return the stream for a purpose, always the same object."""
        generator = self._streams.get(purpose)
        if generator is None:
            seeds, robot = self._seeds, self.robot
            if seeds is None:
                generator = stream(self.seed, robot, purpose)
            else:
                generator = Generator(PCG64(_Seed(seeds, robot, purpose)))  # type: ignore[arg-type]  # as numpy allows
            self._streams[purpose] = generator
        return generator

    def blocks(self, purpose: Purpose, method: str, *arguments: float) -> Iterator[Floats]:
        """Yield arrays of numbers that a method of the stream draws, such as ``uniform`` with its two limits.

        The numbers are those of single draws. A block takes a fraction of their time. The blocks grow,
        because a robot of a large swarm may need few numbers.
        """
        draw = getattr(self.generator(purpose), method)
        size = _FIRST_BLOCK
        while True:
            yield draw(*arguments, size)
            size = min(2 * size, _LARGEST_BLOCK)

    def draws(self, purpose: Purpose, method: str, *arguments: float) -> Iterator[float]:
        """Return an iterator over the numbers of `blocks`."""
        return chain.from_iterable(map(np.ndarray.tolist, self.blocks(purpose, method, *arguments)))
