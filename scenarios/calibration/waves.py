"""Waves: positions in the unit cube whose games meet all targets.

The method is history matching (Craig et al., Bayesian Statistics 5, 1996; Vernon et al., Bayesian Analysis 5,
2010, 619-670). A wave plays games at some positions. Emulators learn from the games of all waves, and the
next wave plays only at positions where the emulated games meet all targets. A position is compatible only if
its own games meet them. Positions are judged stage by stage: those far from the targets of one stage play no
games of the next.
"""

from collections.abc import Callable, Generator, Sequence
from typing import Final, NamedTuple

import numpy as np
from pydantic import Field
from scipy.stats import qmc

from kswarms.agents.common.arrays import Floats
from kswarms.agents.common.descriptions import FrozenModel
from kswarms.scenarios.calibration.emulator import Emulator

SEED: Final = 10_000
"""Seed of the positions."""
CANDIDATES: Final = 2**16
"""Positions for which a wave emulates games."""

Play = Callable[[Floats, int, int], Floats]
"""``play(positions, wave, stage)`` returns the outputs of games, shape (positions, outputs)."""
Judge = Callable[[Floats], Floats]
"""Returns the implausibility of each target, shape (positions, targets), from the outputs of a stage."""


class Sampling(FrozenModel):
    """Settings of a sample.

    Attributes
    ----------
    size : int
        Number of compatible positions that ends the sample.
    tries : int
        Positions of a wave.
    waves : int
        Maximum number of waves.
    factor : float
        A position whose implausibility exceeds this number plays no games of the next stage. The first wave
        has twice this number, so that the emulators learn from more positions.
    """

    size: int = Field(30, ge=2, le=10_000)
    tries: int = Field(64, ge=2, le=10_000)
    waves: int = Field(4, ge=1, le=1000)
    factor: float = Field(1.5, ge=1)


class Wave(NamedTuple):
    """The positions of a wave that played all games, and the implausibility of each target."""

    passed: tuple[int, ...]
    """Number of positions that played each stage, and of those that passed the last."""
    positions: Floats
    implausibility: Floats


class Games(NamedTuple):
    """Positions and the outputs of their games."""

    positions: Floats
    outputs: Floats


def sample(dimension: int, play: Play, stages: Sequence[Judge], settings: Sampling) -> Generator[Wave]:
    """Yield waves until there are enough compatible positions in all of them."""
    known: list[list[Games]] = [[] for _ in stages]
    compatible = 0
    for number in range(settings.waves):
        positions = _choose(dimension, number, known, stages, settings.tries)
        factor = settings.factor * (1 if number else 2)
        passed, implausibility = [len(positions)], np.empty((len(positions), 0))
        for stage, judge in enumerate(stages, 1):
            if len(positions):
                outputs = play(positions, number, stage)
                known[stage - 1].append(Games(positions, outputs))
                implausibility = np.hstack([implausibility, judge(outputs)])
                kept = implausibility.max(axis=1) <= factor
                positions, implausibility = positions[kept], implausibility[kept]
            passed.append(len(positions))
        yield Wave(tuple(passed), positions, implausibility)
        compatible += int((implausibility.max(axis=1, initial=0) <= 1).sum())
        if compatible >= settings.size:
            return


def _choose(
    dimension: int,
    number: int,
    known: Sequence[Sequence[Games]],
    stages: Sequence[Judge],
    count: int,
) -> Floats:
    """Return the first candidates whose emulated games meet all targets, and if too few do, the nearest."""
    design = qmc.Halton(dimension, rng=np.random.default_rng((SEED, number)))
    if number == 0:
        return design.random(count)
    candidates = design.random(CANDIDATES)
    worst = np.ones(CANDIDATES)
    for judge, games in zip(stages, known, strict=True):
        if sum(len(each.positions) for each in games) > 1:
            learned = Games(*map(np.concatenate, zip(*games, strict=True)))
            emulated = Emulator.fit(*learned).predict(candidates)
            worst = np.maximum(worst, judge(emulated).max(axis=1))
    return candidates[np.argsort(worst, kind="stable")[:count]]
