"""The motion kernel: moves all bodies until a robot must decide (specification, section 2.6). Compiled.

A control period is: pick-ups and deposits, the percepts of all robots at the same instant,
decisions, motion. The kernel stops wherever a decision is due, and is called again after it.
"""

import math
from typing import Final

from kswarms.agents.common.arrays import Floats, Integers, Records
from kswarms.agents.common.jit import compiled
from kswarms.agents.robot.sensing import wrap
from kswarms.model.kernel.contacts import JAMMED, part, translate
from kswarms.model.kernel.neighbours import refresh
from kswarms.model.kernel.percepts import find_pucks, perceive

# What comes next in a period.
PUCKS: Final = 0
PERCEPTS: Final = 1
MOTION: Final = 2

_RENEWALS: Final = 50
"""Lists of neighbours that one period may take: jams send bodies farther only where there is no room."""


@compiled
def advance(
    positions: Floats,
    robots: Records,
    world: Records,
    stations: Records,
    bases: Floats,
    work: Records,
    contacts: Records,
    pairs: Records,
    cell_start: Integers,
    events: Records,
    tick: int,
    until: int,
) -> tuple[int, int]:
    """Go on from period `tick` to the first decision, but not beyond the start of `until`.

    A period that has begun, with its pick-ups and deposits, comes to its percepts even if it is `until`.

    Parameters
    ----------
    positions : ndarray of float64, shape (n, 2)
        Centres (m); written.
    robots : ndarray of `kswarms.agents.robot.state.ROBOT`, shape (n,)
        Written: headings of those that turn.
    world : ndarray of `kswarms.model.kernel.arrays.WORLD`, shape (1,)
        Written: where in its period the game is, and what the neighbour lists hold.
    stations : ndarray of `kswarms.model.kernel.arrays.STATION`, shape (m,)
    bases : ndarray of float64, shape (K, 2)
        Their middles (m).
    work : ndarray of `kswarms.model.kernel.arrays.WORK`, shape (n,)
        Written.
    contacts : ndarray of `kswarms.model.kernel.arrays.CONTACT`, shape (n, MAX_CONTACTS)
        Written.
    pairs, cell_start
        As in `kswarms.model.kernel.neighbours.refresh`; written.
    events : ndarray of `kswarms.model.kernel.percepts.EVENT`, shape (n,)
        Written: what the robots must decide on.
    tick, until : int
        Control period that it is now; the one at whose start something else is scheduled.

    Returns
    -------
    tick, size : int
        The period reached, and the number of events; with none, it is `until`.

    Raises
    ------
    ValueError
        If bodies overlap that nothing parts.
    """
    heading, turn_rate = robots["heading"], robots["turn_rate"]
    forward_x, forward_y = robots["forward_x"], robots["forward_y"]
    stage = world["stage"]
    while tick < until or stage[0] != PUCKS:
        if stage[0] == PUCKS:
            stage[0] = PERCEPTS
            size = find_pucks(positions, robots, world, stations, bases, events)
            if size > 0:
                return tick, size
        if stage[0] == PERCEPTS:
            stage[0] = MOTION
            _list_neighbours(positions, world, work, pairs, cell_start)
            size = perceive(positions, robots, world, bases, work, pairs, cell_start, events)
            if size > 0:
                return tick, size
        if tick == until:
            return tick, 0
        for i in range(len(positions)):
            if turn_rate[i] != 0.0:
                heading[i] = wrap(heading[i] + turn_rate[i])
                forward_x[i] = math.cos(heading[i])
                forward_y[i] = math.sin(heading[i])
        translate(positions, robots, world, work, contacts, pairs)
        _part_strangers(positions, world, work, pairs, cell_start)
        stage[0] = PUCKS
        tick += 1
    return tick, 0


@compiled
def _list_neighbours(
    positions: Floats, world: Records, work: Records, pairs: Records, cell_start: Integers
) -> bool:
    """Make the lists of neighbours anew if they are not good any more; return whether they were not."""
    listed = refresh(
        positions,
        world["half"][0],
        world["pair_reach"][0],
        world["skin"][0],
        work["origin_x"],
        work["origin_y"],
        pairs,
        cell_start,
        work["cell_robots"],
    )
    if listed < 0:
        return False
    world["n_pairs"][0] = listed
    return True


@compiled
def _part_strangers(
    positions: Floats, world: Records, work: Records, pairs: Records, cell_start: Integers
) -> None:
    """Part those whom the motion took so far that they came upon bodies that are not on their lists."""
    for _ in range(_RENEWALS):
        if not _list_neighbours(positions, world, work, pairs, cell_start):
            return
        part(positions, world, work, pairs)
    raise ValueError(JAMMED)
