"""Waves: a sample of the positions that are compatible with all targets.

The method is approximate Bayesian computation by population Monte Carlo (Beaumont et al., Biometrika 96,
2009, 983-990) with the distance of history matching, the maximum implausibility over the targets. Each wave
accepts positions up to a factor on all tolerances; the factor falls to 1 from wave to wave. The prior is
uniform in the unit cube. A position is judged stage by stage and rejected at the first stage that it misses.
This accepts the same positions as judging all stages.
"""

from collections.abc import Callable, Generator
from typing import Final, NamedTuple

import numpy as np
from pydantic import Field
from scipy.stats import qmc

from kswarms.agents.common.arrays import Floats
from kswarms.agents.common.descriptions import FrozenModel

SEED: Final = 10_000
"""Seed of the positions."""

Judge = Callable[[Floats, int, int], Floats]
"""``judge(positions, wave, stage)`` returns the implausibility of each position at a stage, from 1."""


class Sampling(FrozenModel):
    """Settings of a sample.

    Attributes
    ----------
    size : int
        Positions that a wave accepts.
    batch : int
        Positions that are judged together.
    tries : int
        Maximum number of positions in a wave.
    waves : int
        Maximum number of waves.
    factor : float
        Factor on the tolerances in the first wave. The next is the median of the implausibilities that the
        wave accepted, at least 1.
    """

    size: int = Field(30, ge=2, le=10_000)
    batch: int = Field(32, ge=1, le=10_000)
    tries: int = Field(512, ge=2, le=1_000_000)
    waves: int = Field(6, ge=1, le=1000)
    factor: float = Field(3.0, ge=1)


class Wave(NamedTuple):
    """Accepted positions of a wave, with their implausibilities and importance weights (sum 1)."""

    factor: float
    tried: int
    passed: tuple[int, ...]
    """Number of positions that passed each stage."""
    positions: Floats
    implausibility: Floats
    weights: Floats


def sample(dimension: int, stages: int, judge: Judge, settings: Sampling) -> Generator[Wave]:
    """Yield waves until one accepts enough positions with factor 1, or too few positions with any factor."""
    factor, before = settings.factor, None
    for number in range(settings.waves):
        wave = _wave(number, factor, before, dimension, stages, judge, settings)
        yield wave
        if factor == 1.0 or len(wave.positions) < settings.size:
            return
        factor, before = max(1.0, float(np.median(wave.implausibility))), wave


def _wave(
    number: int,
    factor: float,
    before: Wave | None,
    dimension: int,
    stages: int,
    judge: Judge,
    settings: Sampling,
) -> Wave:
    rng = np.random.default_rng((SEED, number))
    design = qmc.Halton(dimension, rng=rng)
    positions, worst = np.empty((0, dimension)), np.empty(0)
    tried, passed = 0, [0] * stages
    while len(positions) < settings.size and tried < settings.tries:
        count = min(settings.batch, settings.tries - tried)
        batch = design.random(count) if before is None else _perturb(before, count, rng)
        implausibility = np.zeros(count)
        tried += count
        for stage in range(1, stages + 1):
            if len(batch):
                implausibility = np.maximum(implausibility, judge(batch, number, stage))
                kept = implausibility <= factor
                batch, implausibility = batch[kept], implausibility[kept]
            passed[stage - 1] += len(batch)
        positions = np.concatenate([positions, batch])
        worst = np.concatenate([worst, implausibility])
    weights = np.ones(len(positions)) if before is None else 1 / _density(before, positions)
    return Wave(factor, tried, tuple(passed), positions, worst, weights / max(weights.sum(), 1e-300))


def _perturb(wave: Wave, count: int, rng: np.random.Generator) -> Floats:
    """Return positions in the unit cube, each drawn around an accepted one."""
    scale = np.linalg.cholesky(_covariance(wave))
    found: list[Floats] = []
    while len(found) < count:
        parent = wave.positions[rng.choice(len(wave.positions), p=wave.weights)]
        position = parent + scale @ rng.standard_normal(len(parent))
        if (position >= 0).all() and (position < 1).all():
            found.append(position)
    return np.array(found)


def _covariance(wave: Wave) -> Floats:
    """Return twice the weighted covariance of the accepted positions, without correlations."""
    mean = wave.weights @ wave.positions
    variance = wave.weights @ (wave.positions - mean) ** 2
    return np.diag(2 * np.maximum(variance, 1e-6))


def _density(wave: Wave, positions: Floats) -> Floats:
    """Return the density of the proposals at positions, up to a constant."""
    scaled = positions / np.sqrt(np.diag(_covariance(wave)))
    parents = wave.positions / np.sqrt(np.diag(_covariance(wave)))
    squared = ((scaled[:, None, :] - parents[None, :, :]) ** 2).sum(axis=2)
    density: Floats = np.exp(-0.5 * squared) @ wave.weights
    return np.maximum(density, 1e-300)
