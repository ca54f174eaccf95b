"""Motion with contacts in plain numpy, all pairs, written from the specification (section 2.5)."""

import math
from typing import NamedTuple

import numpy as np

from kswarms.agents.common.arrays import Floats
from kswarms.model.kernel.relaxation import TOLERANCE

# How the relaxation goes about it: numbers of the compiled code, which change where a jam comes to rest.
NO_OVERLAP = 1e-9
"""Bodies that overlap by less (m) just touch: how many are counted must not hang on the last bit."""
PLAIN_PASSES = 3
"""Passes before momentum sets in."""
ROUNDS = 50
WATCHED_GAP = 0.1
"""Part of the radius: pairs farther apart are not looked at before the next round."""
FORGET_AFTER, FORGET_EVERY = 4, 8
"""In which passes pairs that have come apart and rest are dropped until the next round."""
AT_REST = 1e-5
"""A pair rests if its four coordinates were corrected by no more than this in all (m)."""


class Ground(NamedTuple):
    """What bodies move on and are made of: lengths in metres."""

    radius: float
    half: float
    friction: float
    push_share: float
    most_momentum: float = 0.8  # part of an overlapping body's last correction that is added to the next


class Contact(NamedTuple):
    """An obstacle in a robot's way."""

    normal: Floats  # unit vector towards it
    allowed: float  # displacement towards it that is left to the robot (m)
    blocked: float  # and that it loses (m)


def offsets(positions: Floats) -> tuple[Floats, Floats, Floats]:
    """Return (n, n) arrays: the vector from i to j in x and y, and the distance, infinite to itself."""
    dx, dy = (positions[None, :, k] - positions[:, None, k] for k in (0, 1))
    distance = np.hypot(dx, dy)
    np.fill_diagonal(distance, np.inf)
    return dx, dy, distance


def translate(positions: Floats, wanted: Floats, ground: Ground) -> None:
    """Move all bodies by their displacements, subject to contacts; writes `positions`, shape (n, 2)."""
    contacts, shoves = meet_bodies(positions, wanted, ground)
    for robot, found in enumerate(contacts):
        found += meet_walls(positions[robot], wanted[robot], ground)
    moves = [slide(want, found, ground.friction) for want, found in zip(wanted, contacts, strict=True)]
    positions += np.array(moves) + shoves
    if any(contacts):
        relax(positions, ground)


def meet_bodies(positions: Floats, wanted: Floats, ground: Ground) -> tuple[list[list[Contact]], Floats]:
    """Return each robot's contacts with others, and by how much others shove it (n, 2)."""
    dx, dy, distance = offsets(positions)
    normal = np.stack((dx, dy), axis=2) / distance[:, :, None]
    approach = (wanted[:, None, :] * normal).sum(axis=2)  # of i towards j
    excess = approach + approach.T - np.maximum(0.0, distance - 2 * ground.radius)
    contacts: list[list[Contact]] = [[] for _ in positions]
    shoves = np.zeros_like(positions)
    for i, j in np.argwhere((excess > 0) & (approach > 0)):
        part = excess[i, j] * approach[i, j] / (approach[i, j] + max(0.0, approach[j, i]))
        blocked = (1 - ground.push_share) * part
        contacts[i].append(Contact(normal[i, j], approach[i, j] - blocked, blocked))
        shoves[j] += ground.push_share * part * normal[i, j]
    return contacts, shoves


def meet_walls(place: Floats, want: Floats, ground: Ground) -> list[Contact]:
    """Return a robot's contacts with walls."""
    contacts = []
    for normal in np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]]):
        gap = max(0.0, ground.half - ground.radius - place @ normal)
        approach = want @ normal
        if approach > gap:
            contacts.append(Contact(normal, gap, approach - gap))
    return contacts


def slide(want: Floats, contacts: list[Contact], friction: float) -> Floats:
    """Return a displacement without its blocked normal parts and the friction of its tangential parts."""
    move = want.copy()
    for contact in sorted(contacts, key=lambda contact: -contact.blocked):
        towards = move @ contact.normal
        lost = towards - contact.allowed
        if lost > 0:
            along = move - towards * contact.normal
            length = math.hypot(*along)
            kept = max(0.0, 1 - friction * float(lost) / length) if length > 0 else 0.0
            move = contact.allowed * contact.normal + kept * along
    return move


def relax(positions: Floats, ground: Ground) -> None:
    """Part overlapping bodies by equal shares, all at once, until no overlap exceeds the tolerance.

    A round ends when the watched overlaps are small enough; the next looks at all pairs again.
    """
    limit = ground.half - ground.radius
    np.clip(positions, -limit, limit, out=positions)
    passes = 0
    for _ in range(ROUNDS):
        if _overlaps(positions, ground).max() <= TOLERANCE:
            return
        watched = _overlaps(positions, ground) > -WATCHED_GAP * ground.radius
        last = np.zeros_like(positions)
        while True:
            overlap = _overlaps(positions, ground)
            if passes % FORGET_EVERY == FORGET_AFTER:
                moves = np.abs(last).sum(axis=1)
                watched &= (overlap > NO_OVERLAP) | (moves[:, None] + moves[None, :] > AT_REST)
                last[~watched.any(axis=1)] = 0.0
            overlap[~watched | (overlap < 0)] = 0.0
            if overlap.max() <= TOLERANCE:
                break
            kept = np.where((overlap > NO_OVERLAP).any(axis=1), _momentum(passes, ground), 0.0)
            last = _halves(positions, overlap) + kept[:, None] * last
            positions += last
            np.clip(positions, -limit, limit, out=positions)
            passes += 1
    raise AssertionError("the bodies do not come apart")


def _momentum(passes: int, ground: Ground) -> float:
    since = passes - PLAIN_PASSES
    return min(ground.most_momentum, (since + 1) / (since + 7)) if since >= 0 else 0.0


def _overlaps(positions: Floats, ground: Ground) -> Floats:
    """Return the overlap of each pair, shape (n, n); gaps are negative."""
    return 2 * ground.radius - offsets(positions)[2]


def _halves(positions: Floats, overlap: Floats) -> Floats:
    """Return each body's correction: half of each of its overlaps, of three and more twice their mean."""
    dx, dy, distance = offsets(positions)
    share = -0.5 * overlap / distance
    count = (overlap > NO_OVERLAP).sum(axis=1)
    scale: Floats = 2 / np.maximum(2, count)
    return np.column_stack(((share * dx).sum(axis=1) * scale, (share * dy).sum(axis=1) * scale))
