"""Number of conflicts that begin in each cell of the arena."""

import math
from typing import Final

import numpy as np
import pandas as pd

from kswarms.analysis.results.tables import check_frame

_CELL: Final = 0.05
_MAX_CELLS: Final = 1000
"""Maximum number of cells in a row; larger arenas have larger cells."""


def cell_side(half: float) -> float:
    """Return the side of a cell (m) in an arena; `half` is half its side (m)."""
    return _CELL * max(1, math.ceil(2 * half / _CELL / _MAX_CELLS))


def conflict_density(conflicts: pd.DataFrame, half: float = 1.0) -> np.ndarray:
    """Return the number of conflicts that begin in each cell, averaged over the games.

    The column `run`, if there is one, identifies the game; `half` is half the side of the arena (m). The
    result is a square matrix of float64; rows are cells in y from below, columns cells in x from the left.
    """
    conflicts = check_frame(conflicts, "conflicts", ["x", "y"])
    edges = np.linspace(-half, half, round(2 * half / cell_side(half)) + 1)
    counts, *_ = np.histogram2d(conflicts["y"], conflicts["x"], bins=(edges, edges))
    games = conflicts["run"].nunique() if "run" in conflicts else 1
    return np.asarray(counts / max(games, 1))
