"""Bodies that overlap are parted by equal shares, over and over (specification, section 2.5). Compiled.

Each pass works on the positions that all bodies had before it, so no robot profits from its number. A jam
needs many, since each carries a correction one body farther: a part of the last pass's move is therefore
added, which grows from pass to pass as in Nesterov's method (1983). What comes out is nearly what the
passes alone come to, after a third of them.
"""

import math
from typing import Final

from kswarms.agents.common.arrays import Floats, Records
from kswarms.agents.common.jit import compiled

TOLERANCE: Final = 0.9e-4
"""Overlap at which the relaxation stops (m); the specification allows 0.1 mm."""

_CLOSE: Final = 0.1
"""Gap below which the relaxation keeps an eye on a pair, as a part of the radius."""
_PLAIN_PASSES: Final = 3
"""Passes before the relaxation gathers momentum: enough for all but jams."""
_MOST_MOMENTUM: Final = 0.8
"""Part of the last pass's move that a pass adds in the end."""
_HALF_GATHERED: Final = 6
"""Passes with momentum after which that part is a half."""
_PASSES: Final = 200
"""Passes of the relaxation before it looks again at which pairs are close."""
_ROUNDS: Final = 200
"""Looks before it gives up."""
_STUCK: Final = 1000
"""Passes after which a straight row between walls is suspected, which none of them can part."""
_TURN: Final = 0.01
"""By how much the pairs of such a row are then turned (rad)."""
_FORGET_AFTER: Final = 4
_FORGET_EVERY: Final = 8
"""Passes after which the relaxation forgets pairs at rest: most jams are resolved long before the worst."""
_TOUCH: Final = 1e-9
"""Overlap below which two bodies only touch: less is the rounding of bodies that were parted exactly (m)."""
_AT_REST: Final = 1e-5
"""Move of a pair's bodies in a pass that is too short to wait for (m)."""


@compiled
def relax(positions: Floats, radius: float, half: float, work: Records, pairs: Records, n_pairs: int) -> int:
    """Part overlapping bodies by equal shares, and keep them within the walls.

    Parameters
    ----------
    positions : ndarray of float64, shape (n, 2)
        Centres (m); written.
    radius, half : float
        Of the bodies; half the side of the arena (m).
    work : ndarray of `kswarms.model.kernel.arrays.WORK`, shape (n,)
        Written.
    pairs : ndarray of `kswarms.model.kernel.arrays.PAIR`, shape (≥ n_pairs,)
        All pairs that can overlap; written: which are close.
    n_pairs : int
        How many there are.

    Returns
    -------
    int
        Passes that were needed, −1 if all that there are did not do.
    """
    move_x, move_y, shove_x, shove_y = work["move_x"], work["move_y"], work["shove_x"], work["shove_y"]
    count, limit = work["count"], half - radius
    for i in range(len(positions)):
        positions[i, 0] = min(limit, max(-limit, positions[i, 0]))
        positions[i, 1] = min(limit, max(-limit, positions[i, 1]))
    done = 0
    for _ in range(_ROUNDS):
        n_close, worst = _find_close(positions, radius, pairs, n_pairs)
        if worst <= TOLERANCE:
            return done
        for i in range(len(positions)):
            move_x[i] = 0.0
            move_y[i] = 0.0
            shove_x[i] = 0.0
            shove_y[i] = 0.0
            count[i] = 0
        n_queued = _queue_bodies(work, pairs, n_close)
        if done >= _STUCK:
            _bend(positions, radius, work, pairs, n_close)
        for _ in range(_PASSES):
            if done % _FORGET_EVERY == _FORGET_AFTER:
                n_close = _forget_resting(positions, radius, work, pairs, n_close)
                n_queued = _queue_bodies(work, pairs, n_close)
            worst = _measure_overlaps(positions, radius, work, pairs, n_close)
            if worst <= TOLERANCE:
                break
            _part(positions, limit, work, n_queued, _momentum(done))
            done += 1
    return -1


@compiled
def _offset(positions: Floats, i: int, j: int) -> tuple[float, float]:
    return positions[j, 0] - positions[i, 0], positions[j, 1] - positions[i, 1]


@compiled
def _overlap(dx: float, dy: float, radius: float) -> bool:
    return dx * dx + dy * dy < (2.0 * radius - _TOUCH) ** 2


@compiled
def _find_close(positions: Floats, radius: float, pairs: Records, n_pairs: int) -> tuple[int, float]:
    """List the pairs with hardly a gap, and return their number and the greatest overlap (m)."""
    first, second = pairs["first"], pairs["second"]
    close_first, close_second = pairs["close_first"], pairs["close_second"]
    reach = (2.0 + _CLOSE) * radius
    nearest = reach * reach
    n_close = 0
    for k in range(n_pairs):
        dx, dy = _offset(positions, first[k], second[k])
        squared = dx * dx + dy * dy
        if squared < reach * reach:
            close_first[n_close] = first[k]
            close_second[n_close] = second[k]
            n_close += 1
            nearest = min(nearest, squared)
    return n_close, 2.0 * radius - math.sqrt(nearest)


@compiled
def _bend(positions: Floats, radius: float, work: Records, pairs: Records, n_close: int) -> None:
    """Turn each overlapping pair a little about its middle, all the same way, out of the row it stands in."""
    close_first, close_second = pairs["close_first"], pairs["close_second"]
    shove_x, shove_y = work["shove_x"], work["shove_y"]
    for c in range(n_close):
        i = close_first[c]
        j = close_second[c]
        dx, dy = _offset(positions, i, j)
        if _overlap(dx, dy, radius):
            shove_x[i] += _TURN * dy
            shove_y[i] -= _TURN * dx
            shove_x[j] -= _TURN * dy
            shove_y[j] += _TURN * dx


@compiled
def _queue_bodies(work: Records, pairs: Records, n_close: int) -> int:
    """List the bodies of the close pairs, and return their number."""
    close_first, close_second = pairs["close_first"], pairs["close_second"]
    queued, queue = work["queued"], work["queue"]
    for i in range(len(work)):
        queued[i] = 0
    size = 0
    for c in range(n_close):
        for i in (close_first[c], close_second[c]):
            if not queued[i]:
                queued[i] = 1
                queue[size] = i
                size += 1
    return size


@compiled
def _forget_resting(positions: Floats, radius: float, work: Records, pairs: Records, n_close: int) -> int:
    """Keep of the close pairs those that overlap or of which a body moves; return their number."""
    close_first, close_second = pairs["close_first"], pairs["close_second"]
    move_x, move_y = work["move_x"], work["move_y"]
    kept = 0
    for c in range(n_close):
        i = close_first[c]
        j = close_second[c]
        dx, dy = _offset(positions, i, j)
        moves = abs(move_x[i]) + abs(move_y[i]) + abs(move_x[j]) + abs(move_y[j])
        if moves > _AT_REST or _overlap(dx, dy, radius):
            close_first[kept] = i
            close_second[kept] = j
            kept += 1
    return kept


@compiled
def _measure_overlaps(positions: Floats, radius: float, work: Records, pairs: Records, n_close: int) -> float:
    """Add up, for each body, half of each of its overlaps; return the greatest overlap (m)."""
    close_first, close_second = pairs["close_first"], pairs["close_second"]
    shove_x, shove_y, count = work["shove_x"], work["shove_y"], work["count"]
    worst = 0.0
    for c in range(n_close):
        i = close_first[c]
        j = close_second[c]
        dx, dy = _offset(positions, i, j)
        # Without a branch for pairs that do not overlap: in a jam it would be guessed wrong half of the time.
        distance = math.sqrt(dx * dx + dy * dy)
        overlap = max(0.0, 2.0 * radius - distance)
        worst = max(worst, overlap)
        if distance == 0.0:  # exactly on top of each other: part them along x
            dx, distance = 1.0, 1.0
        part = 0.5 * overlap / distance
        shove_x[i] -= part * dx
        shove_y[i] -= part * dy
        shove_x[j] += part * dx
        shove_y[j] += part * dy
        overlapping = 1 if overlap > _TOUCH else 0
        count[i] += overlapping
        count[j] += overlapping
    return worst


@compiled
def _momentum(done: int) -> float:
    """Return the part of the last pass's move that a pass after `done` others adds."""
    gathered = done - _PLAIN_PASSES + 1
    return min(_MOST_MOMENTUM, max(0.0, gathered / (gathered + _HALF_GATHERED)))


@compiled
def _part(positions: Floats, limit: float, work: Records, n_queued: int, momentum: float) -> None:
    """Move the queued bodies apart as measured, not beyond the walls, and forget the measures.

    A body that is free stops at once: one that went on would be flung into the next.
    """
    move_x, move_y, shove_x, shove_y = work["move_x"], work["move_y"], work["shove_x"], work["shove_y"]
    count, queue = work["count"], work["queue"]
    for q in range(n_queued):
        i = queue[q]
        # Three and more corrections at once would overshoot: twice their mean does not.
        scale = 2.0 / max(2, count[i])
        kept = momentum if count[i] > 0 else 0.0
        move_x[i] = kept * move_x[i] + scale * shove_x[i]
        move_y[i] = kept * move_y[i] + scale * shove_y[i]
        positions[i, 0] = min(limit, max(-limit, positions[i, 0] + move_x[i]))
        positions[i, 1] = min(limit, max(-limit, positions[i, 1] + move_y[i]))
        shove_x[i] = 0.0
        shove_y[i] = 0.0
        count[i] = 0
