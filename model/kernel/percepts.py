"""What happens to a robot that it must decide on: the state events of a control period (section 2.6).

All robots perceive the same instant. One robot gets at most one event of the program or conflict kind
in an instant; picking up and depositing come before, on their own. Compiled.
"""

import math
from typing import Final

import numpy as np

from kswarms.agents.body import SENSORS
from kswarms.agents.common.arrays import Floats, Integers, Records
from kswarms.agents.common.jit import compiled
from kswarms.agents.robot.sensing import sense, walls_met, wrap
from kswarms.agents.robot.state import ACTION, HOME, HOME_TURN, HOMING_ERROR, LEG, LEG_OVER, TURN
from kswarms.model.kernel.neighbours import within

# Kinds of events.
PICK_UP: Final = 1
DEPOSIT: Final = 2
CONFLICT: Final = 3
HOMING: Final = 4
WALL: Final = 5
TURN_DUE: Final = 6
LEG_DUE: Final = 7


EVENT: Final = np.dtype(
    [
        ("robot", np.int64),
        ("kind", np.int64),
        ("other", np.int64),  # the robot ahead at a conflict, the station at a pick-up
        ("active", np.int64),  # sensors with something near, n'_i of Eq. 5.4
        ("vacant", np.int64),  # the most vacant directions, one bit for each sensor
        ("angle", np.float64),  # from the heading to the robot ahead, or to the own base (rad)
    ]
)
"""What one robot must decide on."""


@compiled
def find_pucks(
    positions: Floats, robots: Records, world: Records, stations: Records, bases: Floats, events: Records
) -> int:
    """Find who stands on a station with pucks, empty, or on the own base with a puck.

    Parameters
    ----------
    positions : ndarray of float64, shape (n, 2)
        Centres (m).
    robots : ndarray of `kswarms.agents.robot.state.ROBOT`, shape (n,)
    world : ndarray of `kswarms.model.kernel.arrays.WORLD`, shape (1,)
    stations : ndarray of `kswarms.model.kernel.arrays.STATION`, shape (m,)
    bases : ndarray of float64, shape (K, 2)
        Their middles (m).
    events : ndarray of `EVENT`, shape (n,)
        Written.

    Returns
    -------
    int
        Number of events.
    """
    station_reach, base_reach = world["station_radius"][0] ** 2, world["base_radius"][0] ** 2
    swarm, carrying = robots["swarm"], robots["carrying"]
    station_x, station_y, supply = stations["x"], stations["y"], stations["supply"]
    size = 0
    for i in range(len(positions)):
        x = positions[i, 0]
        y = positions[i, 1]
        if carrying[i]:
            dx = x - bases[swarm[i], 0]
            dy = y - bases[swarm[i], 1]
            if dx * dx + dy * dy < base_reach:
                events[size]["robot"] = i
                events[size]["kind"] = DEPOSIT
                size += 1
        else:
            for s in range(len(stations)):
                dx = x - station_x[s]
                dy = y - station_y[s]
                if dx * dx + dy * dy < station_reach and supply[s] != 0:
                    events[size]["robot"] = i
                    events[size]["kind"] = PICK_UP
                    events[size]["other"] = s
                    size += 1
                    break
    return size


@compiled
def _look_ahead(
    positions: Floats, robots: Records, world: Records, work: Records, pairs: Records, n_pairs: int
) -> None:
    """Find the nearest robot ahead of each robot within the conflict distance, −1 if there is none.

    Pairs of robots that both resolve a conflict are passed over unless such a robot may meet another.
    """
    forward_x, forward_y = robots["forward_x"], robots["forward_y"]
    nearest, squares = work["nearest"], work["squared"]
    first, second, phase = pairs["first"], pairs["second"], robots["phase"]
    preempt = world["preempt"][0]
    limit, front_cosine = world["conflict_reach"][0] ** 2, world["front_cosine"][0]
    for i in range(len(positions)):
        nearest[i] = -1
        squares[i] = limit
    for k in range(n_pairs):
        i = first[k]
        j = second[k]
        if phase[i] == ACTION and phase[j] == ACTION and not preempt:
            continue
        dx = positions[j, 0] - positions[i, 0]
        dy = positions[j, 1] - positions[i, 1]
        squared = dx * dx + dy * dy
        if squared > limit:
            continue
        ahead = front_cosine * math.sqrt(squared)
        if squared <= squares[i] and dx * forward_x[i] + dy * forward_y[i] >= ahead:
            nearest[i] = j
            squares[i] = squared
        if squared <= squares[j] and -dx * forward_x[j] - dy * forward_y[j] >= ahead:
            nearest[j] = i
            squares[j] = squared


@compiled
def perceive(
    positions: Floats,
    robots: Records,
    world: Records,
    bases: Floats,
    work: Records,
    pairs: Records,
    cell_start: Integers,
    events: Records,
) -> int:
    """Find what each robot must decide on: conflict, home, wall, turn, leg, in this order.

    Parameters
    ----------
    positions : ndarray of float64, shape (n, 2)
        Centres (m).
    robots : ndarray of `kswarms.agents.robot.state.ROBOT`, shape (n,)
    world : ndarray of `kswarms.model.kernel.arrays.WORLD`, shape (1,)
        Written: ``free``.
    bases : ndarray of float64, shape (K, 2)
        Their middles (m).
    work : ndarray of `kswarms.model.kernel.arrays.WORK`, shape (n,)
        Written: ``nearest``, ``squared`` and ``found``.
    pairs, cell_start
        As in `kswarms.model.kernel.neighbours.refresh`.
    events : ndarray of `EVENT`, shape (n,)
        Written.

    Returns
    -------
    int
        Number of events.
    """
    radius, half, preempt = world["radius"][0], world["half"][0], world["preempt"][0]
    wall_reach, wall_half_angle = world["wall_reach"][0], world["wall_half_angle"][0]
    flight_range, active_range = world["flight_range"][0], world["active_range"][0]
    base_reach = world["base_range"][0] ** 2
    forward_x, forward_y = robots["forward_x"], robots["forward_y"]
    heading, phase, swarm = robots["heading"], robots["phase"], robots["swarm"]
    opponent, carrying = robots["opponent"], robots["carrying"]
    nearest, cell_robots, found = work["nearest"], work["cell_robots"], work["found"]
    free = world["free"][0]
    _look_ahead(positions, robots, world, work, pairs, world["n_pairs"][0])
    size = 0
    for i in range(len(positions)):
        doing = phase[i]
        x = positions[i, 0]
        y = positions[i, 1]
        other = nearest[i]
        event = events[size]
        if other >= 0 and (doing != ACTION or (preempt and other != opponent[i])):
            n_found = within(x, y, world["ring_reach"][0], half, cell_start, cell_robots, found)
            farthest = max(flight_range, active_range)
            sense(i, forward_x[i], forward_y[i], positions, found, n_found, radius, half, farthest, free)
            active, vacant = _read_ring(free, flight_range, active_range)
            event["robot"] = i
            event["kind"] = CONFLICT
            event["other"] = other
            event["active"] = active
            event["vacant"] = vacant
            event["angle"] = wrap(math.atan2(positions[other, 1] - y, positions[other, 0] - x) - heading[i])
            size += 1
            continue
        if doing == ACTION or doing == TURN or doing == HOME_TURN:
            continue
        if carrying[i]:
            dx = bases[swarm[i], 0] - x
            dy = bases[swarm[i], 1] - y
            if dx * dx + dy * dy <= base_reach:
                error = wrap(math.atan2(dy, dx) - heading[i])
                if doing != HOME or abs(error) > HOMING_ERROR:
                    event["robot"] = i
                    event["kind"] = HOMING
                    event["angle"] = error
                    size += 1
                continue
        kind = 0
        if walls_met(x, y, heading[i], half, wall_reach, wall_half_angle) != 0:
            kind = WALL
        elif doing == LEG_OVER:
            kind = TURN_DUE
        elif doing != LEG:  # idle, or shoved out of sight of the base
            kind = LEG_DUE
        if kind != 0:
            event["robot"] = i
            event["kind"] = kind
            size += 1
    return size


@compiled
def _read_ring(free: Floats, flight_range: float, active_range: float) -> tuple[int, int]:
    """Return the number of active sensors, and the most vacant directions as bits."""
    most = -math.inf
    active = 0
    for sensor in range(SENSORS):
        most = max(most, min(free[sensor], flight_range))
        if free[sensor] <= active_range:
            active += 1
    vacant = 0
    for sensor in range(SENSORS):
        if min(free[sensor], flight_range) >= most:
            vacant += 1 << sensor
    return active, vacant
