"""The kernel's view of a game: constants of the world, and working memory for each robot."""

from typing import Final

import numpy as np

from kswarms.agents.body import SENSORS

WORLD: Final = np.dtype(
    [
        ("half", np.float64),  # half the side of the arena (m)
        ("radius", np.float64),  # of every body (m)
        ("conflict_reach", np.float64),  # conflict distance, centre to centre (m)
        ("front_cosine", np.float64),  # cosine of the front half-angle
        ("flight_range", np.float64),  # free distances are cut off there (m)
        ("active_range", np.float64),  # a sensor is active below it (m)
        ("ring_reach", np.float64),  # how far from a centre others matter to the ring (m)
        ("wall_reach", np.float64),  # wall distance, from the centre (m)
        ("wall_half_angle", np.float64),  # between the rays that look for walls (rad)
        ("base_range", np.float64),  # the own base is seen within it (m)
        ("station_radius", np.float64),  # (m)
        ("base_radius", np.float64),  # (m)
        ("friction", np.float64),  # Coulomb coefficient
        ("push_share", np.float64),
        ("pair_reach", np.float64),  # pairs nearer than this are listed (m)
        ("skin", np.float64),  # what the list allows for motion (m)
        ("preempt", np.int64),
        # What the kernel writes:
        ("stage", np.int64),  # what comes next in this period
        ("n_pairs", np.int64),  # pairs listed now
        ("free", np.float64, (SENSORS,)),  # free distances of one robot (m)
    ]
)
"""Constants of a game, and the kernel's own state."""

STATION: Final = np.dtype([("x", np.float64), ("y", np.float64), ("supply", np.int64)])
"""A supply station: its middle (m) and the pucks left, negative for no limit."""

PAIR: Final = np.dtype(
    [
        ("first", np.int64),  # the robot with the lower number
        ("second", np.int64),
        ("close_first", np.int64),  # in row k, the k-th pair that is about to touch
        ("close_second", np.int64),
    ]
)
"""Two robots near each other."""

WORK: Final = np.dtype(
    [
        ("move_x", np.float64),  # displacement in this period (m)
        ("move_y", np.float64),
        ("shove_x", np.float64),  # what others add to it; in the relaxation, one pass's correction (m)
        ("shove_y", np.float64),
        ("count", np.int64),  # contacts; in the relaxation, overlaps
        ("queued", np.int64),  # whether the relaxation may move it
        ("queue", np.int64),  # in row k, the k-th robot that it may move
        ("origin_x", np.float64),  # position for which the neighbours were listed (m)
        ("origin_y", np.float64),
        ("cell_robots", np.int64),  # robots ordered by cell
        ("found", np.int64),  # robots around one robot
        ("nearest", np.int64),  # robot ahead
        ("squared", np.float64),  # its distance, squared (m²)
    ]
)
"""Working memory of the kernel, one row for each robot."""

CONTACT: Final = np.dtype(
    [
        ("x", np.float64),  # unit vector towards the obstacle
        ("y", np.float64),
        ("allowed", np.float64),  # displacement towards it that is allowed (m)
        ("blocked", np.float64),  # and that is blocked (m)
    ]
)
"""One contact of a robot."""

MAX_CONTACTS: Final = 12
"""Contacts a body can have: six discs fit around a disc, and there are walls; the rest is reserve."""
