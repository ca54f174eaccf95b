"""Calibration: an ensemble of worlds that meet all targets.

The result depends only on the settings and the targets, not on interruptions and the number of workers: a
resumed calibration is computed again from the games that it finds in its file.
"""

from collections.abc import Callable, Generator, Mapping, Sequence
from typing import Any, Final, NamedTuple, Self

import numpy as np
from pydantic import model_validator

from kswarms.agents.common.arrays import Floats
from kswarms.agents.common.errors import InputError
from kswarms.scenarios.calibration.evidence import Curves, Evidence, Rows, runs_of
from kswarms.scenarios.calibration.prior import PRIOR, to_world, values_at
from kswarms.scenarios.calibration.waves import Judge, Sampling, sample

FIRST_SEED: Final = 10_000
"""Seed of the first game. Each wave has other seeds; the catalogue has those from 0."""


class Setup(Sampling):
    """Settings of a calibration: those of the sample, and the free parameters."""

    free: tuple[str, ...] = tuple(PRIOR)

    @model_validator(mode="after")
    def _check(self) -> Self:
        for name in self.free:
            if name not in PRIOR:
                raise InputError("free", name, f"must be among {', '.join(PRIOR)}")
        if not self.free or len(set(self.free)) < len(self.free):
            raise InputError("free", ",".join(self.free), "must be one or more different parameters")
        return self


class Stage(NamedTuple):
    """The games of a stage, and the targets that they are judged by."""

    curves: Curves
    seeds: int
    outputs: Callable[[Rows], Floats]
    """Returns the outputs of the games of a world, shape (outputs,)."""
    targets: tuple[str, ...]
    judge: Judge
    """Returns the implausibility of each target; a world is judged by the greatest."""


def calibrate(setup: Setup, stages: Sequence[Stage], evidence: Evidence) -> Generator[dict[str, Any]]:
    """Yield each wave as JSON: its worlds that played all games, with the implausibility of each target."""
    seeds_of_wave = sum(stage.seeds for stage in stages)
    targets = [name for stage in stages for name in stage.targets]

    def play(positions: Floats, wave: int, number: int) -> Floats:
        stage = stages[number - 1]
        first_seed = FIRST_SEED + wave * seeds_of_wave + sum(each.seeds for each in stages[: number - 1])
        worlds = [to_world(setup.free, position) for position in positions]
        plans = [runs_of(world, stage.curves, first_seed, stage.seeds) for world in worlds]
        return np.array([stage.outputs(rows) for rows in evidence.rows(plans)])

    for wave in sample(len(setup.free), play, [stage.judge for stage in stages], setup):
        yield {
            "passed": list(wave.passed),
            "worlds": [
                {
                    "parameters": values_at(setup.free, position),
                    "implausibility": {name: round(x, 4) for name, x in zip(targets, found, strict=True)},
                }
                for position, found in zip(wave.positions, wave.implausibility.tolist(), strict=True)
            ],
        }


def ensemble_of(waves: Sequence[Mapping[str, Any]], size: int) -> dict[str, Any]:
    """Return the worlds of all waves that meet all targets, or the `size` nearest if there are fewer.

    ``factor`` is the smallest common factor on the tolerances with which these worlds meet all targets, at
    least 1.
    """
    worlds = sorted((world for wave in waves for world in wave["worlds"]), key=worst_of)
    compatible = [world for world in worlds if worst_of(world) <= 1]
    chosen = compatible if len(compatible) >= size else worlds[:size]
    return {"factor": max([1.0, *map(worst_of, chosen)]), "worlds": chosen}


def worst_of(world: Mapping[str, Any]) -> float:
    """Return the greatest implausibility of a world."""
    return float(max(world["implausibility"].values()))
