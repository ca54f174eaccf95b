"""The compiled kernel of one game, with the memory it works in."""

import math
from collections.abc import Callable
from functools import partial
from typing import Final

import numpy as np

from kswarms.agents.common.arrays import Integers, Records
from kswarms.agents.robot.state import RobotStates
from kswarms.model.description.arena import Arena
from kswarms.model.description.game import Game
from kswarms.model.kernel.advance import advance
from kswarms.model.kernel.arrays import CONTACT, MAX_CONTACTS, PAIR, STATION, WORK, WORLD
from kswarms.model.kernel.neighbours import room_for_pairs
from kswarms.model.kernel.percepts import EVENT

_MOST_CELLS: Final = 1024
"""Rows of the grid of cells at most: that of a vast arena has larger cells, not more of them."""


class Kernel:
    """Moves the bodies of one game.

    Parameters
    ----------
    game : Game
        What is played.
    arena : Arena
        Where.
    states : RobotStates
        The robots; written.

    Attributes
    ----------
    events : ndarray of `kswarms.model.kernel.percepts.EVENT`, shape (n,)
        What the robots must decide on since the last call of `advance`.
    fields : list of memoryview, shape (n,)
        Its fields, in their order: to read a few numbers, faster than the array.
    supply : ndarray of int64, shape (stations,)
        Pucks left at each station, −1 for no limit.
    advance : callable
        ``advance(tick, until) -> (tick, size)`` moves the bodies from period `tick` to the next decision, at
        most to the start of `until`; returns the period reached, and the number of `events` there.
    """

    def __init__(self, game: Game, arena: Arena, states: RobotStates) -> None:
        n = len(states.positions)
        self.events: Records = np.zeros(n, dtype=EVENT)
        self.fields = [self.events[name].data for name in EVENT.names or ()]
        stations: Records = np.zeros(len(arena.stations), dtype=STATION)
        stations["x"], stations["y"] = arena.stations.T
        stations["supply"] = game.supply or -1
        self.supply: Integers = stations["supply"]
        world = make_world(game, arena)
        pair_reach = float(world["pair_reach"][0])
        cells = max(1, min(_MOST_CELLS, int(2 * arena.half / pair_reach)))
        work: Records = np.zeros(n, dtype=WORK)
        work["origin_x"] = np.nan  # no neighbours listed yet
        arguments = (
            states.positions,
            states.robots,
            world,
            stations,
            arena.bases,
            work,
            np.zeros((n, MAX_CONTACTS), dtype=CONTACT),
            np.zeros(room_for_pairs(n, pair_reach, game.body.radius), dtype=PAIR),
            np.zeros(cells * cells + 1, dtype=np.int64),
            self.events,
        )
        advance(
            *arguments, 0, 0
        )  # compiles, or loads what is cached; at the start of period 0 it does nothing
        # The dispatcher of a compiled function looks up the types of all arguments at each call, which here
        # takes longer than the call. They never change in a game, so the machine code is called directly.
        machine_code = next(iter(advance.overloads.values())).entry_point  # type: ignore[attr-defined]
        self.advance: Callable[[int, int], tuple[int, int]] = partial(machine_code, *arguments)


def make_world(game: Game, arena: Arena) -> Records:
    """Return the constants of a game as the kernel reads them.

    Returns
    -------
    ndarray of `kswarms.model.kernel.arrays.WORLD`, shape (1,)
    """
    parameters, body = game.parameters, game.body
    radius, scale = body.radius, body.sensing_scale
    fastest = body.top_speed * parameters.period * max(max(s.drive, s.drive_action) for s in game.swarms)
    world: Records = np.zeros(1, dtype=WORLD)
    values = {
        "half": arena.half,
        "radius": radius,
        "conflict_reach": 2 * radius + scale * parameters.conflict_distance,
        "front_cosine": math.cos(parameters.front_half_angle),
        "flight_range": scale * parameters.flight_range,
        "active_range": scale * parameters.active_range,
        "wall_reach": radius + scale * parameters.wall_distance,
        "wall_half_angle": parameters.wall_half_angle,
        "base_range": scale * parameters.base_range,
        "station_radius": parameters.station_radius,
        "base_radius": parameters.base_radius,
        "friction": parameters.friction,
        "push_share": parameters.push_share,
        "skin": 0.9 * radius,
        "preempt": parameters.preempt,
    }
    for name, value in values.items():
        world[name] = value
    # Two that meet head on close in by two strides in a period; relaxation may move each by three more.
    touching = 2 * radius + 8 * fastest
    world["pair_reach"] = np.maximum(world["conflict_reach"], touching) + world["skin"]
    farthest = np.maximum(world["flight_range"], world["active_range"])
    world["ring_reach"] = 2 * radius + farthest + world["skin"] / 2
    return world
