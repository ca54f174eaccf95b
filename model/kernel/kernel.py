"""The kernel of one game: allocates its memory and calls the compiled code."""

import math
from collections.abc import Callable
from functools import partial
from typing import Final

import numpy as np

from kswarms.agents.common.arrays import Integers, Records
from kswarms.agents.robot.state import RobotStates
from kswarms.model.description.arena import Arena
from kswarms.model.description.game import Game
from kswarms.model.kernel.advance import PUCKS, advance
from kswarms.model.kernel.arrays import (
    CONTACT,
    EVENT,
    MAX_CONTACTS,
    SCALARS,
    STATION,
    Blocks,
    pair_block,
    work_blocks,
)
from kswarms.model.kernel.neighbours import room_for_pairs

_MAX_CELLS: Final = 1024
"""Maximum number of grid rows; larger arenas get larger cells."""


class Kernel:
    """Moves the bodies of one game in the state arrays `states`.

    Attributes
    ----------
    blocks : Blocks
        Arrays of the compiled code.
    events : ndarray of `kswarms.model.kernel.arrays.EVENT`, shape (n,)
        Decisions due since the last call of `advance`.
    fields : list of memoryview, shape (n,)
        Fields of the events, in order; reading single numbers is faster than from the array.
    supply : ndarray of int64, shape (S,)
        Pucks left at each station, −1 for no limit.
    advance : callable
        ``advance(tick, until) -> (tick, size)`` moves the bodies from period `tick` to the next decision, at
        most to the start of `until`; it returns the period reached and the number of `events`.
    """

    def __init__(self, game: Game, arena: Arena, states: RobotStates) -> None:
        n = len(states.positions)
        scalars = make_scalars(game, arena)
        stations: Records = np.zeros(len(arena.stations), dtype=STATION)
        stations["x"], stations["y"] = arena.stations.T
        stations["supply"] = game.supply or -1
        pair_reach = float(scalars["pair_reach"][0])
        cells = max(1, min(_MAX_CELLS, int(2 * arena.half / pair_reach)))
        self.events: Records = np.zeros(n, dtype=EVENT)
        floats, integers, rows = work_blocks(n)
        self.blocks = Blocks(
            x=states.positions[:, 0],
            y=states.positions[:, 1],
            motion=states.motion,
            roles=states.roles,
            work_floats=floats,
            work_integers=integers,
            work_rows=rows,
            pairs=pair_block(room_for_pairs(n, pair_reach, game.body.radius)),
            scalars=scalars,
            stations=stations,
            bases=arena.bases,
            contacts=np.zeros((n, MAX_CONTACTS), dtype=CONTACT),
            cell_start=np.zeros(cells * cells + 1, dtype=np.int64),
            events=self.events,
        )
        self.fields = [self.events[name].data for name in EVENT.names or ()]
        self.supply: Integers = stations["supply"]
        advance(self.blocks, 0, 0)  # compiles, or loads the cached code; moves nothing
        # The dispatcher of a compiled function looks up the types of all arguments at each call, which takes
        # longer than the call. They never change in a game, so the machine code is called directly.
        overloads = getattr(advance, "overloads", None)  # None with NUMBA_DISABLE_JIT=1
        function = next(iter(overloads.values())).entry_point if overloads else advance
        self.advance: Callable[[int, int], tuple[int, int]] = partial(function, self.blocks)

    def resume(self, before: "Kernel") -> None:
        """Continue the period of a kernel with more robots; the last stage with decisions is repeated."""
        self.supply[:] = before.supply
        self.blocks.scalars["stage"] = max(PUCKS, before.blocks.scalars["stage"][0] - 1)


def make_scalars(game: Game, arena: Arena) -> Records:
    """Return the constants of a game, ndarray of `kswarms.model.kernel.arrays.SCALARS`, shape (1,)."""
    parameters, body = game.parameters, game.body
    radius, scale = body.radius, body.sensing_scale
    fastest = body.top_speed * parameters.period * max(max(s.drive, s.drive_action) for s in game.swarms)
    scalars: Records = np.zeros(1, dtype=SCALARS)
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
        scalars[name] = value
    # In a period, two robots approach by at most two strides, and relaxation moves each by up to three more.
    touching = 2 * radius + 8 * fastest
    scalars["pair_reach"] = np.maximum(scalars["conflict_reach"], touching) + scalars["skin"]
    return scalars
