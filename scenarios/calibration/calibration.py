"""Calibration: an ensemble of worlds whose every target is within its tolerance.

The result depends only on the settings and the targets, not on interruptions and the number of workers: a
resumed calibration is computed again from the games that it finds in its file.
"""

from collections.abc import Callable, Generator, Mapping, Sequence
from typing import Any, Final, NamedTuple, Self

import numpy as np
from pydantic import model_validator

from kswarms.agents.common.arrays import Floats
from kswarms.agents.common.errors import InputError
from kswarms.model.description.parameters import text_of
from kswarms.scenarios.calibration.evidence import Curves, Evidence, Rows, runs_of
from kswarms.scenarios.calibration.prior import PRIOR, to_world
from kswarms.scenarios.calibration.waves import Sampling, sample

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
    """The games of a stage, and the function that judges their rows."""

    curves: Curves
    seeds: int
    judge: Callable[[Rows], Mapping[str, float]]
    """Returns the implausibility of each target by its id; a world is judged by the greatest."""


def calibrate(setup: Setup, stages: Sequence[Stage], evidence: Evidence) -> Generator[dict[str, Any]]:
    """Yield each wave as JSON: its factor, and its accepted worlds with their implausibilities."""
    seeds_of_wave = sum(stage.seeds for stage in stages)
    judged: dict[tuple[bytes, int], dict[str, float]] = {}

    def judge(positions: Floats, wave: int, stage: int) -> Floats:
        games = stages[stage - 1]
        first_seed = FIRST_SEED + wave * seeds_of_wave + sum(each.seeds for each in stages[: stage - 1])
        worlds = [to_world(setup.free, position) for position in positions]
        plans = [runs_of(world, games.curves, first_seed, games.seeds) for world in worlds]
        worst = []
        for position, rows in zip(positions, evidence.rows(plans), strict=True):
            found = judged[position.tobytes(), stage] = dict(games.judge(rows))
            worst.append(max(found.values()))
        return np.array(worst)

    def world_of(position: Floats) -> dict[str, Any]:
        by_target: dict[str, float] = {}
        for stage in range(1, len(stages) + 1):
            by_target |= judged[position.tobytes(), stage]
        world = text_of(to_world(setup.free, position))
        return {"parameters": world, "implausibility": {name: round(x, 4) for name, x in by_target.items()}}

    for wave in sample(len(setup.free), len(stages), judge, setup):
        yield {
            "factor": wave.factor,
            "tried": wave.tried,
            "passed": list(wave.passed),
            "worlds": [
                {**world_of(position), "weight": float(weight)}
                for position, weight in zip(wave.positions, wave.weights, strict=True)
            ],
        }


def ensemble_of(waves: Sequence[Mapping[str, Any]], size: int) -> dict[str, Any]:
    """Return the worlds of the last wave if it accepted enough of them.

    Otherwise, return the `size` worlds of all waves that are nearest to the targets. ``factor`` is the
    smallest common factor on the tolerances with which they meet all targets.
    """
    *_, last = waves
    if len(last["worlds"]) >= size:
        return {"factor": last["factor"], "worlds": last["worlds"]}
    nearest = sorted((world for wave in waves for world in wave["worlds"]), key=_worst)[:size]
    equal = [{**world, "weight": 1 / len(nearest)} for world in nearest]
    return {"factor": max(map(_worst, nearest), default=last["factor"]), "worlds": equal}


def _worst(world: Mapping[str, Any]) -> float:
    return float(max(world["implausibility"].values()))
