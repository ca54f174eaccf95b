"""Who is near whom: a grid of cells and a list of near pairs, both kept while the bodies stay close.

The pairs are those within a cut-off plus a skin when the list was made; as long as no body has
moved farther than half the skin since, no pair within the cut-off is missing. Compiled.
"""

import math

from kswarms.agents.common.arrays import Floats, Integers, Records
from kswarms.agents.common.jit import compiled


def room_for_pairs(n: int, reach: float, radius: float) -> int:
    """Return how many pairs of bodies that do not overlap can be nearer than `reach` (m)."""
    # Discs cover at most 91 % of the disc they lie in; a half list has each pair once.
    crowd = int(0.91 * ((reach + radius) / radius) ** 2) // 2 + 2
    return min(n * crowd, n * (n - 1) // 2 + 1)


@compiled
def cell_of(coordinate: float, half: float, cells: int) -> int:
    """Return the row or column of the grid that a coordinate lies in."""
    return min(cells - 1, max(0, int((coordinate + half) * cells / (2.0 * half))))


@compiled
def refresh(
    positions: Floats,
    half: float,
    reach: float,
    skin: float,
    origin_x: Floats,
    origin_y: Floats,
    pairs: Records,
    cell_start: Integers,
    cell_robots: Integers,
) -> int:
    """Make the lists anew if a body has moved too far since they were made.

    Parameters
    ----------
    positions : ndarray of float64, shape (n, 2)
        Centres (m).
    half, reach, skin : float
        Half the side of the arena; cut-off plus skin; skin (m).
    origin_x, origin_y : ndarray of float64, shape (n,)
        Positions for which the lists were made, NaN before the first time; written.
    pairs : ndarray of `kswarms.model.kernel.arrays.PAIR`, shape (capacity,)
        The near pairs; written.
    cell_start : ndarray of int64, shape (cells² + 1,)
        Where each cell's robots begin in `cell_robots`; written.
    cell_robots : ndarray of int64, shape (n,)
        Robots ordered by cell, ascending in each; written.

    Returns
    -------
    int
        Number of pairs, or −1 if the lists are good as they are.

    Raises
    ------
    ValueError
        If bodies overlap so much that the pairs do not fit.
    """
    limit = 0.25 * skin * skin
    good = True
    for i in range(len(positions)):
        dx = positions[i, 0] - origin_x[i]
        dy = positions[i, 1] - origin_y[i]
        if not dx * dx + dy * dy <= limit:  # true for the NaN of the first time
            good = False
            break
    if good:
        return -1
    cells = int(math.sqrt(len(cell_start) - 1) + 0.5)
    _sort_into_cells(positions, half, cells, cell_start, cell_robots)
    for i in range(len(positions)):
        origin_x[i] = positions[i, 0]
        origin_y[i] = positions[i, 1]
    return _list_pairs(positions, half, cells, reach, pairs, cell_start, cell_robots)


@compiled
def _sort_into_cells(
    positions: Floats, half: float, cells: int, cell_start: Integers, cell_robots: Integers
) -> None:
    cell_start[:] = 0
    n = len(positions)
    for i in range(n):
        cell = cell_of(positions[i, 1], half, cells) * cells + cell_of(positions[i, 0], half, cells)
        cell_start[cell + 1] += 1
    for cell in range(cells * cells):
        cell_start[cell + 1] += cell_start[cell]
    # Filled from the back, so that the starts end up where they were and numbers ascend in a cell.
    for k in range(n):
        i = n - 1 - k
        cell = cell_of(positions[i, 1], half, cells) * cells + cell_of(positions[i, 0], half, cells)
        cell_start[cell + 1] -= 1
        cell_robots[cell_start[cell + 1]] = i
    for cell in range(cells * cells):
        cell_start[cell] = cell_start[cell + 1]
    cell_start[cells * cells] = n


@compiled
def _list_pairs(
    positions: Floats,
    half: float,
    cells: int,
    reach: float,
    pairs: Records,
    cell_start: Integers,
    cell_robots: Integers,
) -> int:
    first, second = pairs["first"], pairs["second"]
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
                    if size == len(pairs):
                        raise ValueError("more near pairs than bodies that do not overlap can form")
                    first[size] = i
                    second[size] = j
                    size += 1
    return size


@compiled
def within(
    x: float,
    y: float,
    distance: float,
    half: float,
    cell_start: Integers,
    cell_robots: Integers,
    found: Integers,
) -> int:
    """Collect the robots of all cells that a disc touches: at least all robots whose origin is in it.

    Parameters
    ----------
    x, y, distance : float
        Centre and radius of the disc (m).
    half : float
        Half the side (m).
    cell_start, cell_robots
        As in `refresh`.
    found : ndarray of int64, shape (n,)
        Receives the robots.

    Returns
    -------
    int
        How many there are.
    """
    cells = int(math.sqrt(len(cell_start) - 1) + 0.5)
    left = cell_of(x - distance, half, cells)
    right = cell_of(x + distance, half, cells)
    size = 0
    for row in range(cell_of(y - distance, half, cells), cell_of(y + distance, half, cells) + 1):
        for k in range(cell_start[row * cells + left], cell_start[row * cells + right + 1]):
            found[size] = cell_robots[k]
            size += 1
    return size
