"""Events: the decisions that robots must take in a control period (section 2.6). Compiled.

All robots perceive the same instant. Pick-ups and deposits come first. Then each robot has at most one event.
"""

import math

from kswarms.agents.body import SENSORS
from kswarms.agents.common.arrays import Floats
from kswarms.agents.common.jit import compiled_inner
from kswarms.agents.robot.sensing import sense, walls_met, wrap
from kswarms.agents.robot.state import ACTION, HOME, HOME_TURN, HOMING_ERROR, LEG, LEG_OVER, TURN
from kswarms.model.kernel.arrays import CONFLICT, DEPOSIT, HOMING, LEG_DUE, PICK_UP, TURN_DUE, WALL, Memory
from kswarms.model.kernel.neighbours import within


@compiled_inner
def find_pucks(m: Memory) -> int:
    """Find empty robots at stations with pucks, and robots with a puck at their base.

    Returns the number of events, which are written to ``m.events``.
    """
    bodies, bases, events = m.bodies, m.bases, m.events
    station_reach, base_reach = m.scalars["station_radius"][0] ** 2, m.scalars["base_radius"][0] ** 2
    swarm, carrying = bodies.swarm, bodies.carrying
    station_x, station_y, supply = m.stations["x"], m.stations["y"], m.stations["supply"]
    size = 0
    for i in range(len(swarm)):
        x = bodies.x[i]
        y = bodies.y[i]
        if carrying[i]:
            dx = x - bases[swarm[i], 0]
            dy = y - bases[swarm[i], 1]
            if dx * dx + dy * dy < base_reach:
                events[size]["robot"] = i
                events[size]["kind"] = DEPOSIT
                size += 1
        else:
            for s in range(len(supply)):
                dx = x - station_x[s]
                dy = y - station_y[s]
                if dx * dx + dy * dy < station_reach and supply[s] != 0:
                    events[size]["robot"] = i
                    events[size]["kind"] = PICK_UP
                    events[size]["other"] = s
                    size += 1
                    break
    return size


@compiled_inner
def _look_ahead(m: Memory) -> None:
    """Find the nearest robot ahead of each robot within the conflict distance.

    Pairs of robots that both resolve a conflict are skipped unless actions can be interrupted.
    """
    x, y, phase = m.bodies.x, m.bodies.y, m.bodies.phase
    forward_x, forward_y = m.bodies.forward_x, m.bodies.forward_y
    nearest, squares = m.work.nearest, m.work.squared
    first, second, scalars = m.pairs.close_first, m.pairs.close_second, m.scalars
    limit, front_cosine = scalars["conflict_reach"][0] ** 2, scalars["front_cosine"][0]
    for i in range(len(x)):
        nearest[i] = -1
        squares[i] = limit
    busy = ACTION if scalars["preempt"][0] == 0 else -1
    size = 0
    for k in range(scalars["n_pairs"][0]):  # without branches, as in `list_close`
        i = m.pairs.first[k]
        j = m.pairs.second[k]
        dx = x[j] - x[i]
        dy = y[j] - y[i]
        first[size] = i
        second[size] = j
        size += int(dx * dx + dy * dy <= limit) & (int(phase[i] != busy) | int(phase[j] != busy))
    for k in range(size):
        i = first[k]
        j = second[k]
        dx = x[j] - x[i]
        dy = y[j] - y[i]
        squared = dx * dx + dy * dy
        ahead = front_cosine * math.sqrt(squared)
        if squared <= squares[i] and dx * forward_x[i] + dy * forward_y[i] >= ahead:
            nearest[i] = j
            squares[i] = squared
        if squared <= squares[j] and -dx * forward_x[j] - dy * forward_y[j] >= ahead:
            nearest[j] = i
            squares[j] = squared


@compiled_inner
def perceive(m: Memory) -> int:
    """Find the event of each robot, the first that applies: conflict, home, wall, turn, leg.

    Returns the number of events, which are written to ``m.events``.
    """
    bodies, scalars, bases = m.bodies, m.scalars, m.bases
    radius, half, preempt = scalars["radius"][0], scalars["half"][0], scalars["preempt"][0]
    wall_reach, wall_half_angle = scalars["wall_reach"][0], scalars["wall_half_angle"][0]
    flight_range, active_range = scalars["flight_range"][0], scalars["active_range"][0]
    farthest, base_reach = max(flight_range, active_range), scalars["base_range"][0] ** 2
    forward_x, forward_y, heading = bodies.forward_x, bodies.forward_y, bodies.heading
    phase, swarm, opponent, carrying = bodies.phase, bodies.swarm, bodies.opponent, bodies.carrying
    nearest, found, free = m.work.nearest, m.work.found, scalars["free"][0]
    _look_ahead(m)
    size = 0
    for i in range(len(phase)):
        doing = phase[i]
        x = bodies.x[i]
        y = bodies.y[i]
        other = nearest[i]
        event = m.events[size]
        if other >= 0 and (doing != ACTION or (preempt and other != opponent[i])):
            n_found = within(m, x, y, 2.0 * radius + farthest)
            forward = forward_x[i], forward_y[i]
            sense(i, *forward, bodies.x, bodies.y, found, n_found, radius, half, farthest, free)
            active, vacant = _read_ring(free, flight_range, active_range)
            event["robot"] = i
            event["kind"] = CONFLICT
            event["other"] = other
            event["active"] = active
            event["vacant"] = vacant
            event["angle"] = wrap(math.atan2(bodies.y[other] - y, bodies.x[other] - x) - heading[i])
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
        elif doing != LEG:  # idle, or shoved out of the range of the base
            kind = LEG_DUE
        if kind != 0:
            event["robot"] = i
            event["kind"] = kind
            size += 1
    return size


@compiled_inner
def _read_ring(free: Floats, flight_range: float, active_range: float) -> tuple[int, int]:
    """Return the number of active sensors, and the most vacant directions (a bit per sensor)."""
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
