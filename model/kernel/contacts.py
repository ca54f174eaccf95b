"""Contacts of bodies: sliding with friction, relaxation of wedges (specification, section 2.5). Compiled.

A robot that drives into a body or a wall loses the normal part of its motion and slides along it; the
tangential part shrinks by μ times the blocked normal displacement (Coulomb friction). Several contacts of a
robot are handled one after the other, always the one that the motion exceeds most; the remaining overlap (a
wedge) is relaxed (`kswarms.model.kernel.relaxation`).

Two robots in contact move along their normal n, from i to j, by a common displacement c, and each takes half
of their gap g:

    c = p/2 (w_i + w_j)·n, but at least u_j·n + g/2 and at most u_i·n − g/2.

Here u is the displacement that a robot's drive commands, w the robot's displacement in the last period
(without relaxation), and p the push share. Two opposed drives of equal force cancel, so the common momentum
remains. With p = 0 a robot never pushes one that stands. A robot for which this allows u·n is not blocked and
has no contact.
"""

import math
from typing import Final

from kswarms.agents.common.arrays import Integers, Records
from kswarms.agents.common.jit import compiled_inner
from kswarms.model.kernel.arrays import MAX_CONTACTS, Memory
from kswarms.model.kernel.neighbours import list_close
from kswarms.model.kernel.relaxation import relax

JAMMED: Final = "overlapping bodies cannot be separated: too many robots, or too long a period"


@compiled_inner
def translate(m: Memory) -> None:
    """Move all bodies by one period; raise a ValueError if overlaps remain."""
    x, y, stride = m.bodies.x, m.bodies.y, m.bodies.stride
    forward_x, forward_y = m.bodies.forward_x, m.bodies.forward_y
    move_x, move_y, moved_x, moved_y = m.work.move_x, m.work.move_y, m.bodies.moved_x, m.bodies.moved_y
    count, friction = m.work.touches, m.scalars["friction"][0]
    n = len(x)
    fastest = 0.0
    for i in range(n):
        fastest = max(fastest, stride[i])
        move_x[i] = stride[i] * forward_x[i]
        move_y[i] = stride[i] * forward_y[i]
        count[i] = 0
    _meet_bodies(m, fastest)
    _meet_walls(m)
    crowded = False
    for i in range(n):
        if count[i] > 0:
            crowded = True
            move_x[i], move_y[i] = _slide(move_x[i], move_y[i], friction, m.contacts[i], count[i])
        moved_x[i] = move_x[i]
        moved_y[i] = move_y[i]
        x[i] += move_x[i]
        y[i] += move_y[i]
    if crowded:
        separate(m)


@compiled_inner
def separate(m: Memory) -> None:
    """Relax overlaps; raise a ValueError if overlaps remain."""
    radius, half, n_pairs = m.scalars["radius"][0], m.scalars["half"][0], m.scalars["n_pairs"][0]
    if relax(m.bodies.x, m.bodies.y, radius, half, m.work, m.pairs, n_pairs) < 0:
        raise ValueError(JAMMED)


@compiled_inner
def _meet_bodies(m: Memory, fastest: float) -> None:
    """Find the pairs that would overlap, and the motion towards each other that both are allowed."""
    x, y, stride, work, contacts = m.bodies.x, m.bodies.y, m.bodies.stride, m.work, m.contacts
    move_x, move_y, moved_x, moved_y = work.move_x, work.move_y, m.bodies.moved_x, m.bodies.moved_y
    count, first, second = work.touches, m.pairs.close_first, m.pairs.close_second
    radius, push_share = m.scalars["radius"][0], m.scalars["push_share"][0]
    reach = 2.0 * radius + 2.0 * fastest
    for k in range(list_close(x, y, m.pairs, m.scalars["n_pairs"][0], reach)):
        i = first[k]
        j = second[k]
        if stride[i] == 0.0 and stride[j] == 0.0:
            continue
        dx = x[j] - x[i]
        dy = y[j] - y[i]
        distance = math.sqrt(dx * dx + dy * dy)
        if distance == 0.0:
            continue  # no direction: the relaxation separates them
        dx /= distance
        dy /= distance
        gap = max(0.0, distance - 2.0 * radius)
        towards_j = move_x[i] * dx + move_y[i] * dy
        towards_i = -(move_x[j] * dx + move_y[j] * dy)
        if towards_j + towards_i <= gap:
            continue
        last = (moved_x[i] + moved_x[j]) * dx + (moved_y[i] + moved_y[j]) * dy
        least, most = 0.5 * gap - towards_i, towards_j - 0.5 * gap
        common = min(most, max(least, push_share * 0.5 * last))
        if common < most:  # else the other body blocks nothing
            _add_contact(contacts[i], count, i, dx, dy, common + 0.5 * gap)
        if common > least:
            _add_contact(contacts[j], count, j, -dx, -dy, 0.5 * gap - common)


@compiled_inner
def _meet_walls(m: Memory) -> None:
    """Find the robots that would leave the arena, and the motion towards the wall that they are allowed."""
    x, y, radius, half = m.bodies.x, m.bodies.y, m.scalars["radius"][0], m.scalars["half"][0]
    move_x, move_y, count = m.work.move_x, m.work.move_y, m.work.touches
    for i in range(len(x)):
        for axis in range(2):
            move = move_x[i] if axis == 0 else move_y[i]
            sign = 1.0 if move > 0.0 else -1.0
            towards = sign * move
            gap = max(0.0, half - radius - sign * (x[i] if axis == 0 else y[i]))
            if towards > gap:
                nx = sign if axis == 0 else 0.0
                ny = sign if axis == 1 else 0.0
                _add_contact(m.contacts[i], count, i, nx, ny, gap)


@compiled_inner
def _add_contact(contacts: Records, count: Integers, robot: int, x: float, y: float, allowed: float) -> None:
    k = count[robot]
    if k < MAX_CONTACTS:
        contacts["x"][k] = x
        contacts["y"][k] = y
        contacts["allowed"][k] = allowed
        count[robot] = k + 1


@compiled_inner
def _slide(x: float, y: float, friction: float, contacts: Records, count: int) -> tuple[float, float]:
    """Return the motion (x, y) of a robot without its blocked parts and the loss by friction."""
    normal_x, normal_y, allowed = contacts["x"], contacts["y"], contacts["allowed"]
    for _ in range(count):
        worst, most = -1, 0.0
        for k in range(count):
            excess = x * normal_x[k] + y * normal_y[k] - allowed[k]
            if excess > most:
                worst, most = k, excess
        if worst < 0:
            break
        nx = normal_x[worst]
        ny = normal_y[worst]
        tangential = y * nx - x * ny
        tangential = math.copysign(max(0.0, abs(tangential) - friction * most), tangential)
        x = allowed[worst] * nx - tangential * ny
        y = allowed[worst] * ny + tangential * nx
        allowed[worst] = math.inf  # each contact is applied once
    return x, y
