"""Relaxation of overlapping bodies (specification, section 2.5). Compiled.

Each pass moves overlapping bodies apart by equal shares, based on the positions before the pass, so the order
of the robots has no effect. A pass carries a correction one body farther, so a jam needs many passes. Adding
a growing part of the last pass's move (Nesterov 1983) gives nearly the same result in a third of the passes.
"""

import math
from typing import Final

from kswarms.agents.common.arrays import Floats, Integers
from kswarms.agents.common.jit import compiled, compiled_inner
from kswarms.model.kernel.arrays import Pairs, Work
from kswarms.model.kernel.neighbours import list_close

TOLERANCE: Final = 0.9e-4
"""Overlap at which the relaxation stops (m); the specification allows 0.1 mm."""

CLOSE: Final = 2.1
"""Distance of a close pair, in radii, centre to centre."""
_PLAIN_PASSES: Final = 3
"""Passes without momentum, which suffice except in jams."""
_MAX_MOMENTUM: Final = 0.8
"""Maximum fraction of the last pass's move that a pass adds."""
_HALF_MOMENTUM: Final = 6
"""Passes with momentum after which that fraction is a half."""
_PASSES: Final = 200
"""Passes between two searches for close pairs."""
MAX_PASSES: Final = 40_000
"""Maximum number of passes. In a crowd that shoves, some hundred short searches precede the last one."""
_STUCK: Final = 1000
"""Passes after which the relaxation assumes a straight row between walls, which passes cannot separate."""
_TURN: Final = 0.01
"""Turn of the pairs of such a row (rad)."""
_FEW: Final = 100
"""Up to this number of bodies, all are moved in each pass."""
_FORGET_AFTER: Final = 4
_FORGET_EVERY: Final = 8
"""First pass, and period in passes, of removing pairs at rest: most of a jam is resolved early."""
_TOUCH: Final = 1e-9
"""Maximum overlap of bodies that only touch; rounding errors of separated bodies are smaller (m)."""
_AT_REST: Final = 1e-5
"""Maximum move of a pair at rest in one pass (m)."""


@compiled
def relax(x: Floats, y: Floats, radius: float, half: float, work: Work, pairs: Pairs, n_pairs: int) -> int:
    """Separate overlapping bodies and keep them within the walls.

    Parameters
    ----------
    x, y : ndarray of float64, shape (n,)
        Centres (m); written.
    radius, half : float
        Radius of the bodies; half the side of the arena (m).
    work : Work
        Written.
    pairs : Pairs
        All pairs that can overlap; written: close pairs.
    n_pairs : int
        Number of pairs.

    Returns
    -------
    int
        Number of passes, −1 if it did not converge.
    """
    limit = half - radius
    for i in range(len(x)):
        x[i] = min(limit, max(-limit, x[i]))
        y[i] = min(limit, max(-limit, y[i]))
    done = 0
    while done < MAX_PASSES:
        n_close = list_close(x, y, pairs, n_pairs, CLOSE * radius)
        before = done
        done = relax_close(x, y, radius, limit, work, pairs, n_close, before)
        if done == before:
            return done
    return -1


@compiled
def relax_close(
    x: Floats, y: Floats, radius: float, limit: float, work: Work, pairs: Pairs, n_close: int, done: int
) -> int:
    """Separate the close pairs in up to `_PASSES` passes, within ± `limit` (m).

    `done` passes were done before. Return `done` plus the number of passes, which is 0 if no pair overlaps.
    Other pairs may come close in these passes.
    """
    begin, n_moved = done, 0
    _reset(work)
    if done >= _STUCK:
        _bend(x, y, radius, work, pairs, n_close)
    while done < begin + _PASSES:
        if done % _FORGET_EVERY == _FORGET_AFTER:
            n_close = _forget_resting(x, y, radius, work, pairs, n_close)
        n_overlaps, worst = _measure_overlaps(x, y, radius, work, pairs, n_close)
        if worst <= TOLERANCE:
            break
        if len(x) <= _FEW:
            _move_all(x, y, limit, work, _momentum(done))
        else:
            n_moved = _move_bodies(x, y, limit, work, pairs, n_overlaps, n_moved, _momentum(done))
        done += 1
    return done


@compiled
def _reset(work: Work) -> None:
    for i in range(len(work.touches)):
        work.move_x[i] = 0.0
        work.move_y[i] = 0.0
        work.shove_x[i] = 0.0
        work.shove_y[i] = 0.0
        work.touches[i] = 0


@compiled_inner
def _offset(x: Floats, y: Floats, i: int, j: int) -> tuple[float, float]:
    return x[j] - x[i], y[j] - y[i]


@compiled_inner
def _overlap(dx: float, dy: float, radius: float) -> bool:
    return dx * dx + dy * dy < (2.0 * radius - _TOUCH) ** 2


@compiled_inner
def _bend(x: Floats, y: Floats, radius: float, work: Work, pairs: Pairs, n_close: int) -> None:
    """Rotate each overlapping pair slightly about its centre, all in the same sense, to break the row."""
    close_first, close_second = pairs.close_first, pairs.close_second
    shove_x, shove_y = work.shove_x, work.shove_y
    for c in range(n_close):
        i = close_first[c]
        j = close_second[c]
        dx, dy = _offset(x, y, i, j)
        if _overlap(dx, dy, radius):
            shove_x[i] += _TURN * dy
            shove_y[i] -= _TURN * dx
            shove_x[j] -= _TURN * dy
            shove_y[j] += _TURN * dx


@compiled_inner
def _forget_resting(x: Floats, y: Floats, radius: float, work: Work, pairs: Pairs, n_close: int) -> int:
    """Keep the close pairs that overlap or move; return their number."""
    close_first, close_second = pairs.close_first, pairs.close_second
    move_x, move_y = work.move_x, work.move_y
    kept = 0
    for c in range(n_close):
        i = close_first[c]
        j = close_second[c]
        dx, dy = _offset(x, y, i, j)
        moves = abs(move_x[i]) + abs(move_y[i]) + abs(move_x[j]) + abs(move_y[j])
        close_first[kept] = i
        close_second[kept] = j
        kept += int(moves > _AT_REST) | int(_overlap(dx, dy, radius))
    return kept


@compiled
def _measure_overlaps(
    x: Floats, y: Floats, radius: float, work: Work, pairs: Pairs, n_close: int
) -> tuple[int, float]:
    """Add half of each overlap to the corrections of both bodies; return the number and the greatest (m)."""
    shove_x, shove_y, touches = work.shove_x, work.shove_y, work.touches
    first, second = pairs.overlap_first, pairs.overlap_second
    n_overlaps = _list_overlaps(x, y, radius, pairs, n_close)
    worst = 0.0
    for c in range(n_overlaps):
        i = first[c]
        j = second[c]
        dx, dy = _offset(x, y, i, j)
        distance = math.sqrt(dx * dx + dy * dy)
        overlap = max(0.0, 2.0 * radius - distance)
        worst = max(worst, overlap)
        if distance == 0.0:  # exactly on top of each other: separate them along x
            dx, distance = 1.0, 1.0
        part = 0.5 * overlap / distance
        shove_x[i] -= part * dx
        shove_y[i] -= part * dy
        shove_x[j] += part * dx
        shove_y[j] += part * dy
        touches[i] += int(overlap > _TOUCH)
        touches[j] += int(overlap > _TOUCH)
    return n_overlaps, worst


@compiled_inner
def _list_overlaps(x: Floats, y: Floats, radius: float, pairs: Pairs, n_close: int) -> int:
    """List the close pairs that overlap, as `list_close` does; return their number."""
    close_first, close_second = pairs.close_first, pairs.close_second
    first, second = pairs.overlap_first, pairs.overlap_second
    size = 0
    for c in range(n_close):
        dx, dy = _offset(x, y, close_first[c], close_second[c])
        first[size] = close_first[c]
        second[size] = close_second[c]
        size += int(dx * dx + dy * dy < 4.0 * radius * radius)
    return size


@compiled
def _momentum(done: int) -> float:
    """Return the fraction of the last pass's move that is added after `done` passes."""
    passes = done - _PLAIN_PASSES + 1
    return min(_MAX_MOMENTUM, max(0.0, passes / (passes + _HALF_MOMENTUM)))


@compiled
def _next_move(move: float, shove: float, touches: int, momentum: float) -> float:
    """Return the move of a body in this pass, from its last one and the sum of its corrections (m).

    A body that overlaps no longer loses its momentum, which would push it into the next body.
    """
    kept = min(1, touches)
    # The sum of three or more corrections would overshoot; twice their mean does not.
    scale = 2.0 / max(2, touches)
    return momentum * (kept * move) + scale * shove


@compiled
def _move_all(x: Floats, y: Floats, limit: float, work: Work, momentum: float) -> None:
    """Do the same as `_move_bodies` in loops over all bodies, which use vector instructions."""
    _move_along(x, work.move_x, work.shove_x, work.touches, limit, momentum)
    _move_along(y, work.move_y, work.shove_y, work.touches, limit, momentum)
    for i in range(len(x)):
        work.touches[i] = 0


@compiled_inner
def _move_along(
    place: Floats, move: Floats, shove: Floats, touches: Integers, limit: float, momentum: float
) -> None:
    for i in range(len(place)):
        move[i] = _next_move(move[i], shove[i], touches[i], momentum)
        place[i] = min(limit, max(-limit, place[i] + move[i]))
        shove[i] = 0.0


@compiled
def _move_bodies(
    x: Floats,
    y: Floats,
    limit: float,
    work: Work,
    pairs: Pairs,
    n_overlaps: int,
    n_moved: int,
    momentum: float,
) -> int:
    """Move the overlapping bodies by their summed corrections, within the walls, and reset the sums.

    The first `n_moved` bodies of the queue moved in the last pass. Return the number of bodies moved.
    """
    move_x, move_y, shove_x, shove_y = work.move_x, work.move_y, work.shove_x, work.shove_y
    touches, queued, queue = work.touches, work.queued, work.queue
    for q in range(n_moved):
        i = queue[q]
        if touches[i] == 0:
            move_x[i] = 0.0
            move_y[i] = 0.0
    size = 0
    for c in range(n_overlaps):
        for i in (pairs.overlap_first[c], pairs.overlap_second[c]):
            queue[size] = i
            size += 1 - queued[i]
            queued[i] = 1
    for q in range(size):
        i = queue[q]
        move_x[i] = _next_move(move_x[i], shove_x[i], touches[i], momentum)
        move_y[i] = _next_move(move_y[i], shove_y[i], touches[i], momentum)
        x[i] = min(limit, max(-limit, x[i] + move_x[i]))
        y[i] = min(limit, max(-limit, y[i] + move_y[i]))
        shove_x[i] = 0.0
        shove_y[i] = 0.0
        touches[i] = 0
        queued[i] = 0
    return size
