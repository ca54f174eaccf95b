"""Motion with contacts in plain numpy, all pairs, written from the specification (section 2.5)."""

import math
from typing import NamedTuple

import numpy as np

from kswarms.agents.common.arrays import Floats
from kswarms.model.kernel.relaxation import TOLERANCE

# Constants of the relaxation, as in the compiled code: they affect the final positions in a jam.
NO_OVERLAP = 1e-9
"""Bodies that overlap by less (m) only touch; rounding must not change how many overlaps are counted."""
PLAIN_PASSES = 3
"""Passes without momentum."""
ROUNDS = 50
WATCHED_GAP = 0.1
"""Gap of a watched pair, in radii; pairs that are farther apart are ignored until the next round."""
FORGET_AFTER, FORGET_EVERY = 4, 8
"""Passes after which pairs at rest without overlap are ignored until the next round."""
AT_REST = 1e-5
"""Maximum sum of the last corrections of the four coordinates of a pair at rest (m)."""


class Ground(NamedTuple):
    """Constants of bodies and arena; lengths in metres."""

    radius: float
    half: float
    friction: float
    push_share: float
    max_momentum: float = 0.8  # maximum fraction of a body's last correction that is added to the next


class Contact(NamedTuple):
    """Contact of a robot with an obstacle."""

    normal: Floats  # unit vector towards it
    allowed: float  # allowed displacement towards it (m)


def offsets(positions: Floats) -> tuple[Floats, Floats, Floats]:
    """Return the vectors from i to j (x and y) and their lengths, shape (n, n); the diagonal is infinite."""
    dx, dy = (positions[None, :, k] - positions[:, None, k] for k in (0, 1))
    distance = np.hypot(dx, dy)
    np.fill_diagonal(distance, np.inf)
    return dx, dy, distance


def translate(positions: Floats, moved: Floats, wanted: Floats, ground: Ground) -> None:
    """Move all bodies by their displacements, subject to contacts.

    Writes `positions` and `moved`, the displacements of the last period without relaxation, shape (n, 2).
    """
    contacts = meet_bodies(positions, moved, wanted, ground)
    for robot, found in enumerate(contacts):
        found += meet_walls(positions[robot], wanted[robot], ground)
    moved[:] = [slide(want, found, ground.friction) for want, found in zip(wanted, contacts, strict=True)]
    positions += moved
    if any(contacts):
        relax(positions, ground)


def meet_bodies(positions: Floats, moved: Floats, wanted: Floats, ground: Ground) -> list[list[Contact]]:
    """Return each robot's contacts with others."""
    dx, dy, distance = offsets(positions)
    normal = np.stack((dx, dy), axis=2) / distance[:, :, None]
    gap = np.maximum(0.0, distance - 2 * ground.radius)
    own = (wanted[:, None, :] * normal).sum(axis=2)  # of i towards j
    others = -own.T  # of j away from i
    momentum = ground.push_share / 2 * ((moved[:, None, :] + moved[None, :, :]) * normal).sum(axis=2)
    closing = own - others > gap
    with np.errstate(invalid="ignore"):  # the diagonal
        common = np.clip(momentum, others + gap / 2, own - gap / 2)
    contacts: list[list[Contact]] = [[] for _ in positions]
    for i, j in np.argwhere(closing & (common < own - gap / 2)):  # else j does not block i
        contacts[i].append(Contact(normal[i, j], common[i, j] + gap[i, j] / 2))
    return contacts


def meet_walls(place: Floats, want: Floats, ground: Ground) -> list[Contact]:
    """Return a robot's contacts with walls."""
    contacts = []
    for normal in np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]]):
        gap = max(0.0, ground.half - ground.radius - place @ normal)
        approach = want @ normal
        if approach > gap:
            contacts.append(Contact(normal, gap))
    return contacts


def slide(want: Floats, contacts: list[Contact], friction: float) -> Floats:
    """Return a displacement without its blocked normal parts and the friction of its tangential parts."""
    move, rest = want.copy(), list(contacts)
    while rest:
        lost, k = max((float(move @ contact.normal) - contact.allowed, k) for k, contact in enumerate(rest))
        contact = rest.pop(k)
        if lost <= 0:
            break
        along = move - (move @ contact.normal) * contact.normal
        length = math.hypot(*along)
        kept = max(0.0, 1 - friction * lost / length) if length > 0 else 0.0
        move = contact.allowed * contact.normal + kept * along
    return move


def relax(positions: Floats, ground: Ground) -> None:
    """Separate all overlapping bodies at once by equal shares, until no overlap exceeds the tolerance.

    A round ends when the overlaps of the watched pairs are small; the next round considers all pairs.
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
    raise AssertionError("the relaxation does not converge")


def _momentum(passes: int, ground: Ground) -> float:
    since = passes - PLAIN_PASSES
    return min(ground.max_momentum, (since + 1) / (since + 7)) if since >= 0 else 0.0


def _overlaps(positions: Floats, ground: Ground) -> Floats:
    """Return the overlap of each pair, shape (n, n); gaps are negative."""
    return 2 * ground.radius - offsets(positions)[2]


def _halves(positions: Floats, overlap: Floats) -> Floats:
    """Return each body's correction: half the sum of its overlaps; for three or more, their mean."""
    dx, dy, distance = offsets(positions)
    share = -0.5 * overlap / distance
    count = (overlap > NO_OVERLAP).sum(axis=1)
    scale: Floats = 2 / np.maximum(2, count)
    return np.column_stack(((share * dx).sum(axis=1) * scale, (share * dy).sum(axis=1) * scale))
