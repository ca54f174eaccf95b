"""Emulator: a linear model of the outputs of games, with which many positions are judged without games."""

from typing import Final, NamedTuple, Self

import numpy as np

from kswarms.agents.common.arrays import Floats

_STRENGTHS: Final = np.logspace(-3, 3, 25)
"""Candidates for the strength of the regularization."""


class Emulator(NamedTuple):
    """Ridge regression of each output on the position, within the range of the known outputs."""

    centre: Floats
    slope: Floats
    mean: Floats
    low: Floats
    high: Floats

    @classmethod
    def fit(cls, positions: Floats, outputs: Floats) -> Self:
        """Fit outputs, shape (n, k), at positions, shape (n, d), n >= 2.

        Each output has the strength of regularization with the smallest leave-one-out error.
        """
        centre, mean = positions.mean(axis=0), outputs.mean(axis=0)
        left, scale, right = np.linalg.svd(positions - centre, full_matrices=False)
        projected = left.T @ (outputs - mean)
        best = np.full(outputs.shape[1], np.inf)
        slope = np.zeros((positions.shape[1], outputs.shape[1]))
        for strength in _STRENGTHS:
            shrunk = scale**2 / (scale**2 + strength)
            leverage = (left**2) @ shrunk + 1 / len(positions)
            residual = outputs - mean - (left * shrunk) @ projected
            error = ((residual / np.maximum(1 - leverage, 1e-9)[:, None]) ** 2).sum(axis=0)
            better = error < best
            best[better] = error[better]
            found = right.T @ ((scale / (scale**2 + strength))[:, None] * projected)
            slope[:, better] = found[:, better]
        return cls(centre, slope, mean, outputs.min(axis=0), outputs.max(axis=0))

    def predict(self, positions: Floats) -> Floats:
        """Return the outputs at positions, shape (m, d), as an array of shape (m, k)."""
        linear = self.mean + (positions - self.centre) @ self.slope
        return np.asarray(np.clip(linear, self.low, self.high))
