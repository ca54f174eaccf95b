"""Arrays of the kernel. Lengths are in metres, angles in radians, times in control periods."""

from typing import Final, NamedTuple

import numpy as np

from kswarms.agents.body import SENSORS
from kswarms.agents.common.arrays import Floats, Integers, Records

SCALARS: Final = np.dtype(
    [
        ("half", np.float64),  # half the side of the arena
        ("radius", np.float64),  # of every body
        ("conflict_reach", np.float64),  # conflict distance, centre to centre
        ("front_cosine", np.float64),  # cosine of the front half-angle
        ("flight_range", np.float64),  # cut-off of free distances
        ("active_range", np.float64),  # a sensor is active up to it
        ("ring_reach", np.float64),  # other robots within it, centre to centre, affect the sensors
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

PAIR: Final = np.dtype(
    [
        ("first", np.int64),  # the robot with the lower row
        ("second", np.int64),
        ("close_first", np.int64),  # row k: the k-th pair that nearly touches
        ("close_second", np.int64),
    ]
)
"""Two robots near each other."""

WORK: Final = np.dtype(
    [
        ("move_x", np.float64),  # displacement in this period
        ("move_y", np.float64),
        ("shove_x", np.float64),  # displacement by others; in the relaxation, correction of one pass
        ("shove_y", np.float64),
        ("count", np.int64),  # contacts; in the relaxation, overlaps
        ("queued", np.int64),  # whether the relaxation may move it
        ("queue", np.int64),  # row k: the k-th robot that the relaxation may move
        ("origin_x", np.float64),  # position at the last rebuild of the pairs, NaN before the first
        ("origin_y", np.float64),
        ("cell_robots", np.int64),  # robots ordered by cell, ascending in each cell
        ("found", np.int64),  # result of `within`: robots near a point
        ("nearest", np.int64),  # nearest robot ahead, -1 for none
        ("squared", np.float64),  # its distance, squared
    ]
)
"""Working memory, one row per robot."""

CONTACT: Final = np.dtype(
    [
        ("x", np.float64),  # unit vector towards the obstacle
        ("y", np.float64),
        ("allowed", np.float64),  # allowed displacement towards it
        ("blocked", np.float64),  # blocked displacement towards it
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


class Memory(NamedTuple):
    """Arrays of one game with n robots, S stations and K swarms."""

    positions: Floats  # float64, shape (n, 2): centres
    robots: Records  # `kswarms.agents.robot.state.ROBOT`, shape (n,)
    scalars: Records  # `SCALARS`, shape (1,)
    stations: Records  # `STATION`, shape (S,)
    bases: Floats  # float64, shape (K, 2): centres
    work: Records  # `WORK`, shape (n,)
    contacts: Records  # `CONTACT`, shape (n, MAX_CONTACTS)
    pairs: Records  # `PAIR`, shape (capacity,)
    cell_start: Integers  # int64, shape (cells² + 1,): start of each cell in the `WORK` field ``cell_robots``
    events: Records  # `EVENT`, shape (n,)
