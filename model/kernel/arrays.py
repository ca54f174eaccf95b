"""Arrays of the kernel. Lengths are in metres, angles in radians, times in control periods."""

from typing import Final, NamedTuple

import numpy as np

from kswarms.agents.body import SENSORS
from kswarms.agents.common.arrays import Floats, Integers, Records, Rows
from kswarms.agents.common.jit import compiled_inner
from kswarms.agents.robot.state import Bodies

SCALARS: Final = np.dtype(
    [
        ("half", np.float64),  # half the side of the arena
        ("radius", np.float64),  # of every body
        ("conflict_reach", np.float64),  # conflict distance, centre to centre
        ("front_cosine", np.float64),  # cosine of the front half-angle
        ("flight_range", np.float64),  # cut-off of free distances
        ("active_range", np.float64),  # a sensor is active up to it
        ("wall_reach", np.float64),  # wall distance, from the centre
        ("wall_half_angle", np.float64),  # between the rays that detect walls
        ("base_range", np.float64),  # the own base is visible within it
        ("station_radius", np.float64),
        ("base_radius", np.float64),
        ("friction", np.float64),  # Coulomb coefficient
        ("push_share", np.float64),
        ("pair_reach", np.float64),  # pairs within it, centre to centre, are listed
        ("skin", np.float64),  # margin of pair_reach, for motion until the next rebuild of the list
        ("preempt", np.int64),
        # Written by the kernel:
        ("stage", np.int64),  # next stage of this period
        ("n_pairs", np.int64),  # pairs listed
        ("free", np.float64, (SENSORS,)),  # free distances of one robot
    ]
)
"""Constants of a game, and scalar state of the kernel."""

STATION: Final = np.dtype([("x", np.float64), ("y", np.float64), ("supply", np.int64)])
"""A supply station: its centre and the pucks left, negative for no limit."""


class Pairs(NamedTuple):
    """Pairs of robots near each other, arrays of length `capacity`."""

    first: Rows  # the robot with the lower row
    second: Rows
    close_first: Rows  # row k: the k-th pair that nearly touches
    close_second: Rows
    overlap_first: Rows  # the same for pairs that overlap, in the relaxation
    overlap_second: Rows


class Work(NamedTuple):
    """Working memory, arrays of length n, one element more for `Rows`."""

    move_x: Floats  # displacement in this period; in the relaxation, in one pass
    move_y: Floats
    shove_x: Floats  # sum of the corrections of one pass of the relaxation
    shove_y: Floats
    origin_x: Floats  # position at the last rebuild of the pairs, NaN before the first
    origin_y: Floats
    squared: Floats  # distance of the nearest robot ahead, squared
    touches: Integers  # contacts; in the relaxation, overlaps
    queued: Integers  # 1 if it is in the queue
    cell: Integers  # cell at the last rebuild
    nearest: Integers  # nearest robot ahead, -1 for none
    queue: Rows  # row k: the k-th robot that the relaxation moves
    cell_robots: Rows  # robots ordered by cell, ascending in each cell
    found: Rows  # result of `within`: robots near a point

CONTACT: Final = np.dtype(
    [
        ("x", np.float64),  # unit vector towards the obstacle
        ("y", np.float64),
        ("allowed", np.float64),  # allowed displacement towards it
    ]
)
"""One contact of a robot."""

MAX_CONTACTS: Final = 12
"""Maximum number of contacts of a body: six discs fit around a disc, and there are walls."""

EVENT: Final = np.dtype(
    [
        ("robot", np.int64),
        ("kind", np.int64),  # one of the constants below
        ("other", np.int64),  # robot ahead in a conflict; station at a pick-up
        ("active", np.int64),  # number of active sensors, n'_i of Eq. 5.4
        ("vacant", np.int64),  # most vacant directions, one bit per sensor
        ("angle", np.float64),  # from the heading to the robot ahead, or to the own base
    ]
)
"""A decision that a robot must take."""

# Kinds of events.
PICK_UP: Final = 1
DEPOSIT: Final = 2
CONFLICT: Final = 3
HOMING: Final = 4
WALL: Final = 5
TURN_DUE: Final = 6
LEG_DUE: Final = 7


class Blocks(NamedTuple):
    """All arrays of one game with n robots, S stations and K swarms.

    Fields of the same type share an array: a call of compiled code takes 10 ns for each array.
    """

    x: Floats  # the columns of the positions
    y: Floats
    motion: Floats  # float fields of `Bodies`, shape (7, ≥ n)
    roles: Integers  # integer fields of `Bodies`, shape (4, ≥ n)
    work_floats: Floats  # `Work`, shape (7, n)
    work_integers: Integers  # shape (4, n)
    work_rows: Rows  # shape (3, n + 1)
    pairs: Rows  # `Pairs`, shape (6, capacity)
    scalars: Records
    stations: Records
    bases: Floats
    contacts: Records
    cell_start: Integers
    events: Records


class Memory(NamedTuple):
    """The fields of `Blocks`."""

    bodies: Bodies
    scalars: Records  # `SCALARS`, shape (1,)
    stations: Records  # `STATION`, shape (S,)
    bases: Floats  # float64, shape (K, 2): centres
    work: Work
    contacts: Records  # `CONTACT`, shape (n, MAX_CONTACTS)
    pairs: Pairs
    cell_start: Integers  # int64, shape (cells² + 1,): start of each cell in the `WORK` field ``cell_robots``
    events: Records  # `EVENT`, shape (n,)


def work_blocks(n: int) -> tuple[Floats, Integers, Rows]:
    """Return the memory of `Work` for n robots."""
    kinds = list(Work.__annotations__.values())
    floats = np.zeros((kinds.count(Floats), n))
    floats[Work._fields.index("origin_x")] = np.nan  # no neighbours listed yet
    rows = np.zeros((kinds.count(Rows), n + 1), dtype=np.uint32)
    return floats, np.zeros((kinds.count(Integers), n), dtype=np.int64), rows


def pair_block(capacity: int) -> Rows:
    """Return the memory of `Pairs` for at most `capacity` pairs."""
    return np.zeros((len(Pairs._fields), capacity), dtype=np.uint32)


def make_work(n: int) -> Work:
    """Return working memory for n robots."""
    return Work(*(row for block in work_blocks(n) for row in block))


def make_pairs(capacity: int) -> Pairs:
    """Return a list for at most `capacity` pairs."""
    return Pairs(*pair_block(capacity))


# Compiled functions cannot return arrays to Python, since numba's reference counting is off.


@compiled_inner
def _work_of(floats: Floats, integers: Integers, rows: Rows) -> Work:
    return Work(
        floats[0], floats[1], floats[2], floats[3], floats[4], floats[5], floats[6],
        integers[0], integers[1], integers[2], integers[3],
        rows[0], rows[1], rows[2],
    )  # fmt: skip


@compiled_inner
def _pairs_of(block: Rows) -> Pairs:
    return Pairs(block[0], block[1], block[2], block[3], block[4], block[5])


@compiled_inner
def memory_of(blocks: Blocks) -> Memory:
    """Return the fields of `blocks`, in compiled code."""
    n, motion, roles = len(blocks.events), blocks.motion, blocks.roles
    bodies = Bodies(
        blocks.x, blocks.y,
        motion[0][:n], motion[1][:n], motion[2][:n], motion[3][:n], motion[4][:n],
        motion[5][:n], motion[6][:n],
        roles[0][:n], roles[1][:n], roles[2][:n], roles[3][:n],
    )  # fmt: skip
    return Memory(
        bodies,
        blocks.scalars,
        blocks.stations,
        blocks.bases,
        _work_of(blocks.work_floats, blocks.work_integers, blocks.work_rows),
        blocks.contacts,
        _pairs_of(blocks.pairs),
        blocks.cell_start,
        blocks.events,
    )
