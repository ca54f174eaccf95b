"""Random numbers of all robots at once: the first draws of the streams of one purpose. Compiled.

They equal those of `kswarms.agents.streams.stream`, whose generators take 13 µs each to create. The generator
is PCG64 (O'Neill 2014; XSL RR 128/64).
"""

from typing import Final

import numpy as np

from kswarms.agents.common.jit import compiled, compiled_inner
from kswarms.agents.streams import Purpose, Words, seed_words

_MULTIPLIER_HIGH: Final = np.uint64(0x2360ED051FC65DA4)
_MULTIPLIER_LOW: Final = np.uint64(0x4385DF649FCCF645)
_ONE: Final = np.uint64(1)
_LOWER_HALF: Final = np.uint64(0xFFFFFFFF)
_32, _58, _63, _64, _11 = (np.uint64(bits) for bits in (32, 58, 63, 64, 11))
_TO_UNIT: Final = 2.0**-53


def seed_streams(seed: int, robots: int, purpose: Purpose) -> Words:
    """Return the states of the streams of robots 0 … `robots` − 1, uint64, shape (robots, 4), for `draw`."""
    streams = seed_words(seed, robots, purpose)
    _start(streams)
    return streams


@compiled
def _start(streams: Words) -> None:
    """Turn seeds (the words of a state and of an increment, the upper one first) into states."""
    for robot in range(len(streams)):
        seed_high, seed_low, high, low = streams[robot]
        streams[robot, 2] = (high << _ONE) | (low >> _63)
        streams[robot, 3] = (low << _ONE) | _ONE
        low = streams[robot, 3] + seed_low
        streams[robot, 0] = streams[robot, 2] + seed_high + (_ONE if low < seed_low else np.uint64(0))
        streams[robot, 1] = low
        _step(streams, robot)


@compiled_inner
def _step(streams: Words, robot: int) -> None:
    """Multiply a state by the constant of the generator and add its increment, modulo 2¹²⁸."""
    high, low = streams[robot, 0], streams[robot, 1]
    a, b = low >> _32, low & _LOWER_HALF
    c, d = _MULTIPLIER_LOW >> _32, _MULTIPLIER_LOW & _LOWER_HALF
    middle = a * d + ((b * d) >> _32)
    other = b * c + (middle & _LOWER_HALF)
    carried = a * c + (middle >> _32) + (other >> _32)
    product = low * _MULTIPLIER_LOW
    streams[robot, 1] = product + streams[robot, 3]
    carry = _ONE if streams[robot, 1] < product else np.uint64(0)
    streams[robot, 0] = high * _MULTIPLIER_LOW + low * _MULTIPLIER_HIGH + carried + streams[robot, 2] + carry


@compiled
def draw(streams: Words, robot: int) -> float:
    """Return the next number of a stream, uniform in [0, 1), like `numpy.random.Generator.random`."""
    _step(streams, robot)
    mixed = streams[robot, 0] ^ streams[robot, 1]
    turn = streams[robot, 0] >> _58
    mixed = (mixed >> turn) | (mixed << ((_64 - turn) & _63))
    return float(mixed >> _11) * _TO_UNIT
