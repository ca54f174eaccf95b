"""Neighbours: a grid of cells and a list of near pairs. Compiled.

The list has all pairs within a cut-off plus a skin, so no pair within the cut-off is missing until a body has
moved farther than half the skin. Grid and list are rebuilt then.
"""

import math

from kswarms.agents.common.jit import compiled
from kswarms.model.kernel.arrays import Memory


def room_for_pairs(n: int, reach: float, radius: float) -> int:
    """Return the maximum number of pairs within `reach` (m) of bodies that do not overlap."""
    # Discs cover at most 91 % of the disc they lie in; the list has each pair once.
    crowd = int(0.91 * ((reach + radius) / radius) ** 2) // 2 + 2
    return min(n * crowd, n * (n - 1) // 2 + 1)


@compiled
def cell_of(coordinate: float, half: float, cells: int) -> int:
    """Return the row or column of a coordinate in the grid."""
    return min(cells - 1, max(0, int((coordinate + half) * cells / (2.0 * half))))


@compiled
def refresh(m: Memory) -> bool:
    """Rebuild cells and pairs if a body has moved too far since the last rebuild; return whether it did.

    Raise a ValueError if bodies overlap so much that the pairs do not fit in ``m.pairs``.
    """
    positions, origin_x, origin_y = m.positions, m.work["origin_x"], m.work["origin_y"]
    limit = 0.25 * m.scalars["skin"][0] * m.scalars["skin"][0]
    is_valid = True
    for i in range(len(positions)):
        dx = positions[i, 0] - origin_x[i]
        dy = positions[i, 1] - origin_y[i]
        if not dx * dx + dy * dy <= limit:  # true for NaN, before the first rebuild
            is_valid = False
            break
    if is_valid:
        return False
    cells = int(math.sqrt(len(m.cell_start) - 1) + 0.5)
    _sort_into_cells(m, cells)
    for i in range(len(positions)):
        origin_x[i] = positions[i, 0]
        origin_y[i] = positions[i, 1]
    m.scalars["n_pairs"][0] = _list_pairs(m, cells)
    return True


@compiled
def _sort_into_cells(m: Memory, cells: int) -> None:
    positions, cell_start, cell_robots = m.positions, m.cell_start, m.work["cell_robots"]
    half = m.scalars["half"][0]
    cell_start[:] = 0
    n = len(positions)
    for i in range(n):
        cell = cell_of(positions[i, 1], half, cells) * cells + cell_of(positions[i, 0], half, cells)
        cell_start[cell + 1] += 1
    for cell in range(cells * cells):
        cell_start[cell + 1] += cell_start[cell]
    # Fill each cell from its end, down to its start: then rows ascend in a cell.
    for k in range(n):
        i = n - 1 - k
        cell = cell_of(positions[i, 1], half, cells) * cells + cell_of(positions[i, 0], half, cells)
        cell_start[cell + 1] -= 1
        cell_robots[cell_start[cell + 1]] = i
    for cell in range(cells * cells):
        cell_start[cell] = cell_start[cell + 1]
    cell_start[cells * cells] = n


@compiled
def _list_pairs(m: Memory, cells: int) -> int:
    """List the pairs and return their number."""
    positions, cell_start, cell_robots = m.positions, m.cell_start, m.work["cell_robots"]
    first, second = m.pairs["first"], m.pairs["second"]
    half, reach = m.scalars["half"][0], m.scalars["pair_reach"][0]
    size = 0
    for i in range(len(positions)):
        x = positions[i, 0]
        y = positions[i, 1]
        column = cell_of(x, half, cells)
        row = cell_of(y, half, cells)
        for r in range(max(0, row - 1), min(cells, row + 2)):
            begin = cell_start[r * cells + max(0, column - 1)]
            end = cell_start[r * cells + min(cells, column + 2)]
            for k in range(begin, end):
                j = cell_robots[k]
                if j <= i:
                    continue
                dx = positions[j, 0] - x
                dy = positions[j, 1] - y
                if dx * dx + dy * dy < reach * reach:
                    if size == len(first):
                        raise ValueError("too many pairs of neighbours: bodies overlap")
                    first[size] = i
                    second[size] = j
                    size += 1
    return size


@compiled
def within(m: Memory, x: float, y: float, distance: float) -> int:
    """List the robots of all cells that a disc touches in ``m.work["found"]``; return their number.

    The disc has its centre at (x, y) and the radius `distance` (m). All robots that were in the disc at the
    last rebuild are included.
    """
    cell_start, cell_robots, found = m.cell_start, m.work["cell_robots"], m.work["found"]
    half = m.scalars["half"][0]
    cells = int(math.sqrt(len(cell_start) - 1) + 0.5)
    left = cell_of(x - distance, half, cells)
    right = cell_of(x + distance, half, cells)
    size = 0
    for row in range(cell_of(y - distance, half, cells), cell_of(y + distance, half, cells) + 1):
        for k in range(cell_start[row * cells + left], cell_start[row * cells + right + 1]):
            found[size] = cell_robots[k]
            size += 1
    return size
