"""Neighbours: a grid of cells and a list of near pairs. Compiled.

The list has all pairs within a cut-off plus a skin, so no pair within the cut-off is missing until a body has
moved farther than half the skin. Grid and list are rebuilt then.
"""

import math

from kswarms.agents.common.arrays import Floats
from kswarms.agents.common.jit import compiled_inner
from kswarms.model.kernel.arrays import Memory, Pairs


def room_for_pairs(n: int, reach: float, radius: float) -> int:
    """Return the maximum number of pairs within `reach` (m) of bodies that do not overlap."""
    # Discs cover at most 91 % of the disc they lie in; the list has each pair once.
    crowd = int(0.91 * ((reach + radius) / radius) ** 2) // 2 + 2
    return min(n * crowd, n * (n - 1) // 2 + 1) + 1  # the last element is for a pair that is not near


@compiled_inner
def cell_of(coordinate: float, half: float, cells: int) -> int:
    """Return the row or column of a coordinate in the grid."""
    return min(cells - 1, max(0, int((coordinate + half) * cells / (2.0 * half))))


@compiled_inner
def refresh(m: Memory) -> bool:
    """Rebuild cells and pairs if a body has moved too far since the last rebuild; return whether it did.

    Raise a ValueError if bodies overlap so much that the pairs do not fit in ``m.pairs``.
    """
    x, y, origin_x, origin_y = m.bodies.x, m.bodies.y, m.work.origin_x, m.work.origin_y
    limit = 0.25 * m.scalars["skin"][0] * m.scalars["skin"][0]
    moved = 0
    for i in range(len(x)):
        dx = x[i] - origin_x[i]
        dy = y[i] - origin_y[i]
        moved |= 0 if dx * dx + dy * dy <= limit else 1  # 1 for NaN, before the first rebuild
    if moved == 0:
        return False
    cells = int(math.sqrt(len(m.cell_start) - 1) + 0.5)
    _sort_into_cells(m, cells)
    for i in range(len(x)):
        origin_x[i] = x[i]
        origin_y[i] = y[i]
    m.scalars["n_pairs"][0] = _list_pairs(m, cells)
    return True


@compiled_inner
def _sort_into_cells(m: Memory, cells: int) -> None:
    x, y, cell = m.bodies.x, m.bodies.y, m.work.cell
    cell_start, cell_robots, half = m.cell_start, m.work.cell_robots, m.scalars["half"][0]
    cell_start[:] = 0
    n = len(x)
    for i in range(n):
        cell[i] = cell_of(y[i], half, cells) * cells + cell_of(x[i], half, cells)
        cell_start[cell[i] + 1] += 1
    for c in range(cells * cells):
        cell_start[c + 1] += cell_start[c]
    # Fill each cell from its end, down to its start: then rows ascend in a cell.
    for k in range(n):
        i = n - 1 - k
        cell_start[cell[i] + 1] -= 1
        cell_robots[cell_start[cell[i] + 1]] = i
    for c in range(cells * cells):
        cell_start[c] = cell_start[c + 1]
    cell_start[cells * cells] = n


@compiled_inner
def _list_pairs(m: Memory, cells: int) -> int:
    """List the pairs and return their number."""
    x, y, cell = m.bodies.x, m.bodies.y, m.work.cell
    cell_start, cell_robots = m.cell_start, m.work.cell_robots
    first, second, reach = m.pairs.first, m.pairs.second, m.scalars["pair_reach"][0]
    squared = reach * reach
    size, last = 0, len(first) - 1
    for i in range(len(x)):
        own_x = x[i]
        own_y = y[i]
        row, column = divmod(cell[i], cells)
        for r in range(max(0, row - 1), min(cells, row + 2)):
            begin = cell_start[r * cells + max(0, column - 1)]
            end = cell_start[r * cells + min(cells, column + 2)]
            for k in range(begin, end):
                j = cell_robots[k]
                dx = x[j] - own_x
                dy = y[j] - own_y
                # Written in any case and counted if near: half of the branch predictions would fail.
                first[size] = i
                second[size] = j
                size += int(j > i) & int(dx * dx + dy * dy < squared)
                if size > last:
                    raise ValueError("too many pairs of neighbours: bodies overlap")
    return size


@compiled_inner
def list_close(x: Floats, y: Floats, pairs: Pairs, n_pairs: int, reach: float) -> int:
    """List the pairs closer than `reach` (m) as close pairs; return their number.

    Each pair is written and counted if it is close. With a branch, half of its predictions would fail.
    """
    first, second = pairs.first, pairs.second
    close_first, close_second = pairs.close_first, pairs.close_second
    squared = reach * reach
    size = 0
    for k in range(n_pairs):
        i = first[k]
        j = second[k]
        dx = x[j] - x[i]
        dy = y[j] - y[i]
        close_first[size] = i
        close_second[size] = j
        size += int(dx * dx + dy * dy < squared)
    return size


@compiled_inner
def within(m: Memory, own_x: float, own_y: float, distance: float) -> int:
    """List the robots within `distance` of a point (m) in ``m.work.found``; return their number.

    The cells are those of the last rebuild, since when no robot has moved farther than half the skin.
    """
    x, y, found = m.bodies.x, m.bodies.y, m.work.found
    cell_start, cell_robots = m.cell_start, m.work.cell_robots
    half, reach = m.scalars["half"][0], distance + 0.5 * m.scalars["skin"][0]
    cells = int(math.sqrt(len(cell_start) - 1) + 0.5)
    left = cell_of(own_x - reach, half, cells)
    right = cell_of(own_x + reach, half, cells)
    size = 0
    for row in range(cell_of(own_y - reach, half, cells), cell_of(own_y + reach, half, cells) + 1):
        for k in range(cell_start[row * cells + left], cell_start[row * cells + right + 1]):
            i = cell_robots[k]
            dx = x[i] - own_x
            dy = y[i] - own_y
            found[size] = i
            size += int(dx * dx + dy * dy <= distance * distance)
    return size
