"""Number of conflicts that begin in each cell of the arena."""

import numpy as np
import pandas as pd

CELL = 0.05
"""Side of a cell (m)."""


def conflict_density(conflicts: pd.DataFrame, half: float = 1.0) -> np.ndarray:
    """Return the number of conflicts that begin in each cell, averaged over the games.

    The column `run`, if there is one, identifies the game; `half` is half the side of the arena (m). The
    result is a square matrix of float64; rows are cells in y from below, columns cells in x from the left.
    """
    edges = np.linspace(-half, half, round(2 * half / CELL) + 1)
    counts, *_ = np.histogram2d(conflicts["y"], conflicts["x"], bins=(edges, edges))
    games = conflicts["run"].nunique() if "run" in conflicts else 1
    return np.asarray(counts / max(games, 1))
