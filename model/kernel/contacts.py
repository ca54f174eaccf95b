"""Bodies that touch: slide with Coulomb friction, wedges relax (specification, section 2.5).

A robot that drives into a body or a wall loses the normal part of its motion against it and slides
along it; the tangential part shrinks by μ times the normal displacement that was blocked. Two that
drive into each other share the gap that is left in proportion to their speeds. A robot with several
contacts meets them in the order of what each blocks, the most blocking first, each once; the overlap
that is left (a wedge) is relaxed (`kswarms.model.kernel.relaxation`). Compiled.
"""

import math
from typing import Final

from kswarms.agents.common.arrays import Floats, Integers, Records
from kswarms.agents.common.jit import compiled
from kswarms.model.kernel.arrays import MAX_CONTACTS
from kswarms.model.kernel.relaxation import relax

JAMMED: Final = "bodies overlap, and nothing parts them: there are too many, or periods are too long"


@compiled
def translate(
    positions: Floats, robots: Records, world: Records, work: Records, contacts: Records, pairs: Records
) -> None:
    """Move all bodies by one period.

    Parameters
    ----------
    positions : ndarray of float64, shape (n, 2)
        Centres (m); written.
    robots : ndarray of `kswarms.agents.robot.state.ROBOT`, shape (n,)
        Who drives where.
    world : ndarray of `kswarms.model.kernel.arrays.WORLD`, shape (1,)
        Size of the bodies and the arena, friction and push share.
    work : ndarray of `kswarms.model.kernel.arrays.WORK`, shape (n,)
        Written: moves, shoves and numbers of contacts.
    contacts : ndarray of `kswarms.model.kernel.arrays.CONTACT`, shape (n, MAX_CONTACTS)
        Written.
    pairs : ndarray of `kswarms.model.kernel.arrays.PAIR`, shape (capacity,)
        All pairs that can touch; written: which are close.

    Raises
    ------
    ValueError
        If overlaps remain.
    """
    radius, half, n_pairs = world["radius"][0], world["half"][0], world["n_pairs"][0]
    friction, push_share = world["friction"][0], world["push_share"][0]
    stride, forward_x, forward_y = robots["stride"], robots["forward_x"], robots["forward_y"]
    move_x, move_y, shove_x, shove_y = work["move_x"], work["move_y"], work["shove_x"], work["shove_y"]
    count = work["count"]
    n = len(positions)
    fastest = 0.0
    for i in range(n):
        fastest = max(fastest, stride[i])
        move_x[i] = stride[i] * forward_x[i]
        move_y[i] = stride[i] * forward_y[i]
        shove_x[i] = 0.0
        shove_y[i] = 0.0
        count[i] = 0
    _meet_bodies(positions, stride, radius, fastest, push_share, work, contacts, pairs, n_pairs)
    _meet_walls(positions, radius, half, work, contacts)
    crowded = False
    for i in range(n):
        if count[i] > 0:
            crowded = True
            move_x[i], move_y[i] = _slide(move_x[i], move_y[i], friction, contacts[i], count[i])
        positions[i, 0] += move_x[i] + shove_x[i]
        positions[i, 1] += move_y[i] + shove_y[i]
    if crowded:
        part(positions, world, work, pairs)


@compiled
def part(positions: Floats, world: Records, work: Records, pairs: Records) -> None:
    """Relax what overlaps; arguments and errors are those of `translate`."""
    if relax(positions, world["radius"][0], world["half"][0], work, pairs, world["n_pairs"][0]) < 0:
        raise ValueError(JAMMED)


@compiled
def _meet_bodies(
    positions: Floats,
    stride: Floats,
    radius: float,
    fastest: float,
    push_share: float,
    work: Records,
    contacts: Records,
    pairs: Records,
    n_pairs: int,
) -> None:
    """Find the pairs that would overlap, and how much of whose motion each blocks."""
    move_x, move_y, shove_x, shove_y = work["move_x"], work["move_y"], work["shove_x"], work["shove_y"]
    count, first, second = work["count"], pairs["first"], pairs["second"]
    reach = 2.0 * radius + 2.0 * fastest
    for k in range(n_pairs):
        i = first[k]
        j = second[k]
        if stride[i] == 0.0 and stride[j] == 0.0:
            continue
        dx = positions[j, 0] - positions[i, 0]
        dy = positions[j, 1] - positions[i, 1]
        squared = dx * dx + dy * dy
        if squared >= reach * reach:
            continue
        distance = math.sqrt(squared)
        if distance == 0.0:
            continue  # no direction: the relaxation parts them
        dx /= distance
        dy /= distance
        gap = max(0.0, distance - 2.0 * radius)
        towards_j = move_x[i] * dx + move_y[i] * dy
        towards_i = -(move_x[j] * dx + move_y[j] * dy)
        excess = towards_j + towards_i - gap
        if excess <= 0.0:
            continue
        driven = max(0.0, towards_j) + max(0.0, towards_i)
        if towards_j > 0.0:
            share = excess * towards_j / driven
            _add_contact(contacts[i], count, i, dx, dy, towards_j, (1.0 - push_share) * share)
            shove_x[j] += push_share * share * dx
            shove_y[j] += push_share * share * dy
        if towards_i > 0.0:
            share = excess * towards_i / driven
            _add_contact(contacts[j], count, j, -dx, -dy, towards_i, (1.0 - push_share) * share)
            shove_x[i] -= push_share * share * dx
            shove_y[i] -= push_share * share * dy


@compiled
def _meet_walls(positions: Floats, radius: float, half: float, work: Records, contacts: Records) -> None:
    """Find who would leave the arena."""
    move_x, move_y, count = work["move_x"], work["move_y"], work["count"]
    for i in range(len(positions)):
        for axis in range(2):
            move = move_x[i] if axis == 0 else move_y[i]
            sign = 1.0 if move > 0.0 else -1.0
            towards = sign * move
            gap = max(0.0, half - radius - sign * positions[i, axis])
            if towards > gap:
                nx = sign if axis == 0 else 0.0
                ny = sign if axis == 1 else 0.0
                _add_contact(contacts[i], count, i, nx, ny, towards, towards - gap)


@compiled
def _add_contact(
    contacts: Records, count: Integers, robot: int, x: float, y: float, towards: float, blocked: float
) -> None:
    k = count[robot]
    if k < MAX_CONTACTS:
        contacts["x"][k] = x
        contacts["y"][k] = y
        contacts["allowed"][k] = towards - blocked
        contacts["blocked"][k] = blocked
        count[robot] = k + 1


@compiled
def _slide(x: float, y: float, friction: float, contacts: Records, count: int) -> tuple[float, float]:
    """Take from a robot's motion (x, y) what its contacts block, and what their friction costs."""
    normal_x, normal_y = contacts["x"], contacts["y"]
    allowed, blocked = contacts["allowed"], contacts["blocked"]
    for _ in range(count):
        worst = 0
        for k in range(1, count):
            if blocked[k] > blocked[worst]:
                worst = k
        blocked[worst] = -1.0  # met: not to be found again
        nx = normal_x[worst]
        ny = normal_y[worst]
        normal = x * nx + y * ny
        excess = normal - allowed[worst]
        if excess <= 0.0:
            continue
        tangential = y * nx - x * ny
        slid = max(0.0, abs(tangential) - friction * excess)
        tangential = slid if tangential > 0.0 else -slid
        x = allowed[worst] * nx - tangential * ny
        y = allowed[worst] * ny + tangential * nx
    return x, y
