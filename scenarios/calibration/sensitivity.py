"""Sensitivity of a measure to the free parameters, by elementary effects.

The method is that of Morris (Technometrics 33, 1991, 161-174). A trajectory changes one parameter after the
other, each by two thirds of its range in the prior. An elementary effect is the change of the measure divided
by the change of the position in the unit cube.
"""

from collections.abc import Callable, Sequence
from typing import Any, Final, NamedTuple

import numpy as np
from SALib.analyze import morris as effects
from SALib.sample import morris as design

from kswarms.agents.common.arrays import Floats
from kswarms.scenarios.calibration.evidence import Curves, Evidence, Rows, runs_of
from kswarms.scenarios.calibration.prior import to_world

FIRST_SEED: Final = 20_000
"""Seed of the first game; no calibration uses it."""
_LEVELS: Final = 4
_SEED: Final = 20_000


class Index(NamedTuple):
    """Morris's indices of a parameter, in units of the measure for its whole range."""

    parameter: str
    mu_star: float
    """Mean of the absolute elementary effects: how much the parameter matters."""
    mu_star_interval: float
    """Half the width of its 95 % interval (bootstrap over trajectories)."""
    sigma: float
    """Standard deviation of the effects: how much they depend on the other parameters."""
    mu: float
    """Mean effect, with its sign."""


def positions(free: Sequence[str], trajectories: int) -> Floats:
    """Return the positions of all trajectories, shape (trajectories · (parameters + 1), parameters)."""
    found = design.sample(_problem(free), trajectories, num_levels=_LEVELS, seed=_SEED)
    return np.asarray(found, dtype=np.float64)


def indices(free: Sequence[str], values: Callable[[Floats], Floats], trajectories: int) -> list[Index]:
    """Return the indices of parameters, the most important first.

    `values` returns the measure at positions in the unit cube, shape (positions,).
    """
    at = positions(free, trajectories)
    found = effects.analyze(_problem(free), at, values(at), num_levels=_LEVELS, seed=_SEED)
    columns = [found[name] for name in ("mu_star", "mu_star_conf", "sigma", "mu")]
    rows = [Index(name, *map(float, row)) for name, *row in zip(free, *columns, strict=True)]
    return sorted(rows, key=lambda row: -row.mu_star)


def sensitivity(
    free: Sequence[str],
    curves: Curves,
    seeds: int,
    measure: Callable[[Rows], float],
    evidence: Evidence,
    trajectories: int,
) -> list[Index]:
    """Return the indices of a measure of games, each world with the same seeds."""

    def values(at: Floats) -> Floats:
        plans = [runs_of(to_world(free, position), curves, FIRST_SEED, seeds) for position in at]
        return np.array([measure(rows) for rows in evidence.rows(plans)])

    return indices(free, values, trajectories)


def _problem(free: Sequence[str]) -> dict[str, Any]:
    return {"num_vars": len(free), "names": list(free), "bounds": [[0.0, 1.0]] * len(free)}
