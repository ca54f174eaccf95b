"""The kernel: moves all bodies until a robot must decide (specification, section 2.6). Compiled.

The stages of a control period are pick-ups and deposits, percepts of all robots, decisions, and motion. The
kernel returns before decisions, and is called again after them.
"""

import math
from typing import Final

from kswarms.agents.common.jit import compiled, compiled_inner
from kswarms.agents.robot.sensing import wrap
from kswarms.agents.robot.state import Bodies
from kswarms.model.kernel.arrays import Blocks, Memory, memory_of
from kswarms.model.kernel.contacts import JAMMED, separate, translate
from kswarms.model.kernel.neighbours import refresh
from kswarms.model.kernel.percepts import find_pucks, perceive

# Stages of a period.
PUCKS: Final = 0
PERCEPTS: Final = 1
MOTION: Final = 2

_MAX_REFRESHES: Final = 50
"""Maximum number of rebuilds of the pairs in one period; more are needed only if the bodies have no room."""


@compiled
def advance(blocks: Blocks, tick: int, until: int) -> tuple[int, int]:
    """Advance from control period `tick` to the first decision, but not beyond the start of `until`.

    Return the period reached, which is `until` without events, and the number of events in
    ``blocks.events``. If the pick-ups and deposits of period `until` are done, its percepts are done too, but
    no motion. Raise a ValueError if overlapping bodies cannot be separated.
    """
    m = memory_of(blocks)
    stage = m.scalars["stage"]
    while tick < until or stage[0] != PUCKS:
        if stage[0] == PUCKS:
            stage[0] = PERCEPTS
            size = find_pucks(m)
            if size > 0:
                return tick, size
        if stage[0] == PERCEPTS:
            stage[0] = MOTION
            refresh(m)
            size = perceive(m)
            if size > 0:
                return tick, size
        if tick == until:
            return tick, 0
        _turn(m.bodies)
        translate(m)
        _separate_unlisted(m)
        stage[0] = PUCKS
        tick += 1
    return tick, 0


@compiled_inner
def _turn(bodies: Bodies) -> None:
    """Turn all bodies by one period."""
    heading, turn_rate = bodies.heading, bodies.turn_rate
    forward_x, forward_y = bodies.forward_x, bodies.forward_y
    for i in range(len(heading)):
        if turn_rate[i] != 0.0:
            heading[i] = wrap(heading[i] + turn_rate[i])
            forward_x[i] = math.cos(heading[i])
            forward_y[i] = math.sin(heading[i])


@compiled_inner
def _separate_unlisted(m: Memory) -> None:
    """Separate bodies that moved so far that they may overlap bodies with which they are not listed."""
    for _ in range(_MAX_REFRESHES):
        if not refresh(m):
            return
        separate(m)
    raise ValueError(JAMMED)
