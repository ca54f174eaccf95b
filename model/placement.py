"""Starting places of robots: uniformly at random, without overlap (specification, section 3.1).

Each robot draws random places and takes the first free one. If none is free, it takes the place with the most
room among its last draws; at the end, overlaps are relaxed (`kswarms.model.kernel.relaxation`). A grid of
cells finds the robots near a place, so the effort grows with the number of robots, not with its square.
"""

import math
from typing import Final, NamedTuple

import numpy as np

from kswarms.agents.common.arrays import Floats, Integers
from kswarms.agents.common.errors import InputError
from kswarms.agents.common.jit import compiled, compiled_inner
from kswarms.agents.streams import Purpose, Words
from kswarms.model.kernel.arrays import Pairs, make_pairs, make_work
from kswarms.model.kernel.draws import draw, seed_streams
from kswarms.model.kernel.neighbours import cell_of
from kswarms.model.kernel.relaxation import CLOSE, MAX_PASSES, TOLERANCE, relax_close

_DRAWS: Final = 8464
"""Maximum number of places that a robot draws. It decides places in a crowd."""
_LAST: Final = 4096
"""If no place is free, the robot takes the best of its last draws."""
_SLACK: Final = 1.001
"""Cells are larger than the search distance by this factor, because the column of a place is rounded."""


class _Grid(NamedTuple):
    """Robots by cell, in linked lists. Places are in ± `limit` (m)."""

    limit: float
    first: Integers  # first robot of each cell, shape (cells, cells); −1 for none
    following: Integers  # next robot of the same cell, shape (n,); −1 for none


def start_poses(
    n: int, seed: int, half: float, radius: float, clearance: float, wall_clearance: float
) -> tuple[Floats, Floats]:
    """Draw positions (m), shape (n, 2), and headings (rad), shape (n,), from the streams of the robots.

    `half` is half the side of the arena; the clearances are the minimum gaps between bodies and to walls (m).
    """
    x, y, headings = np.empty((3, n))
    limit = half - radius - wall_clearance
    reach = radius + clearance / 2 + TOLERANCE  # radius of the discs that the relaxation separates
    cells = max(1, min(int(2 * limit / (_SLACK * CLOSE * reach)), int(2 * math.sqrt(n))))
    grid = _Grid(limit, np.full((cells, cells), -1), np.full(n, -1))
    with np.errstate(over="ignore"):  # unsigned integers overflow on purpose
        _draw_headings(seed_streams(seed, n, Purpose.HEADING), headings)
        streams = seed_streams(seed, n, Purpose.POSITION)
        crowded = _draw_places(streams, grid, (2 * radius + clearance) ** 2, x, y)
    if crowded and _separate(x, y, grid, reach) < 2 * radius + clearance:
        raise InputError("n", n, f"robots of radius {radius} m do not fit in a square of {2 * half} m")
    return np.column_stack((x, y)), headings


@compiled
def _draw_headings(streams: Words, headings: Floats) -> None:
    for robot in range(len(headings)):
        headings[robot] = -math.pi + 2.0 * math.pi * draw(streams, robot)


@compiled
def _draw_places(streams: Words, grid: _Grid, min_squared: float, x: Floats, y: Floats) -> bool:
    """Draw the places of all robots, in order; return whether a robot found no free place.

    A place is free if its squared distance from all earlier robots is at least `min_squared` (m²).
    """
    limit, crowded = grid.limit, False
    for robot in range(len(x)):
        most_room = -1.0
        for k in range(_DRAWS):
            own_x = -limit + 2.0 * limit * draw(streams, robot)
            own_y = -limit + 2.0 * limit * draw(streams, robot)
            room = _room(grid, x, y, own_x, own_y, min_squared)
            is_free = room >= min_squared
            if is_free or (k >= _DRAWS - _LAST and room > most_room):
                most_room = room
                x[robot] = own_x
                y[robot] = own_y
            if is_free:
                break
        crowded |= most_room < min_squared
        _add(grid, x, y, robot)
    return crowded


@compiled_inner
def _room(grid: _Grid, x: Floats, y: Floats, own_x: float, own_y: float, at_most: float) -> float:
    """Return the squared distance (m²) from a place to the nearest robot, or `at_most` if that is less."""
    cells = len(grid.first)
    column, row = cell_of(own_x, grid.limit, cells), cell_of(own_y, grid.limit, cells)
    for r in range(max(0, row - 1), min(cells, row + 2)):
        for c in range(max(0, column - 1), min(cells, column + 2)):
            robot = grid.first[r, c]
            while robot >= 0:
                dx = own_x - x[robot]
                dy = own_y - y[robot]
                at_most = min(at_most, dx * dx + dy * dy)
                robot = grid.following[robot]
    return at_most


@compiled
def _add(grid: _Grid, x: Floats, y: Floats, robot: int) -> None:
    cells = len(grid.first)
    row, column = cell_of(y[robot], grid.limit, cells), cell_of(x[robot], grid.limit, cells)
    grid.following[robot] = grid.first[row, column]
    grid.first[row, column] = robot


def _separate(x: Floats, y: Floats, grid: _Grid, reach: float) -> float:
    """Move places within the grid until discs of radius `reach` (m) overlap by at most `TOLERANCE`.

    Return the least distance of two places (m). It is smaller than promised if they do not fit.
    """
    n = len(x)
    work, pairs = make_work(n), make_pairs(4 * n)
    limit = (grid.limit + reach) - reach  # rounded as in the kernel
    np.clip(x, -limit, limit, out=x)
    np.clip(y, -limit, limit, out=y)
    before, done = -1, 0
    while True:
        n_close, distance = _list_close(x, y, grid, CLOSE * reach, pairs)
        if n_close > len(pairs.first):
            pairs = make_pairs(n_close)
        elif done == before or done >= MAX_PASSES:
            return distance
        else:
            before = done
            done = relax_close(x, y, reach, limit, work, pairs, n_close, before)


@compiled
def _list_close(x: Floats, y: Floats, grid: _Grid, reach: float, pairs: Pairs) -> tuple[int, float]:
    """List the pairs closer than `reach` (m) as close pairs, by the first and then by the second robot.

    Return their number, of which only those are written that have room, and the least distance (m).
    """
    cells = len(grid.first)
    grid.first[:] = -1
    for k in range(len(x)):
        _add(grid, x, y, len(x) - 1 - k)
    size, nearest = 0, reach * reach
    for i in range(len(x)):
        begin = size
        column, row = cell_of(x[i], grid.limit, cells), cell_of(y[i], grid.limit, cells)
        for r in range(max(0, row - 1), min(cells, row + 2)):
            for c in range(max(0, column - 1), min(cells, column + 2)):
                j = grid.first[r, c]
                while j >= 0:
                    dx = x[j] - x[i]
                    dy = y[j] - y[i]
                    squared = dx * dx + dy * dy
                    if j > i and squared < reach * reach:
                        nearest = min(nearest, squared)
                        if size < len(pairs.first):
                            _insert(pairs, begin, size, i, j)
                        size += 1
                    j = grid.following[j]
    return size, math.sqrt(nearest)


@compiled_inner
def _insert(pairs: Pairs, begin: int, size: int, i: int, j: int) -> None:
    """Insert the pair (i, j) among the pairs of i, which begin at `begin`, so that j ascends."""
    first, second = pairs.close_first, pairs.close_second
    k = size
    while k > begin and second[k - 1] > j:
        second[k] = second[k - 1]
        k -= 1
    second[k] = j
    first[size] = i
