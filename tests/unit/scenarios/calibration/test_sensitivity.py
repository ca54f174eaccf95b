"""Morris's indices of functions whose effects are known, and of synthetic games."""

import math
from collections.abc import Generator, Sequence
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("SALib", reason="needs the extra `sensitivity`")

from kswarms.agents.common.arrays import Floats
from kswarms.scenarios.calibration.evidence import Evidence, Rows
from kswarms.scenarios.calibration.sensitivity import indices, positions, sensitivity
from kswarms.scenarios.runs.outcome import Outcome
from kswarms.scenarios.runs.run import Run

FREE = ("friction", "gamma", "leg_mean")


def test_a_trajectory_changes_one_parameter_after_the_other() -> None:
    at = positions(FREE, 5)
    assert at.shape == (20, 3)
    assert at.min() >= 0.0
    assert at.max() <= 1.0
    for trajectory in at.reshape(5, 4, 3):
        steps = np.abs(np.diff(trajectory, axis=0))
        assert sorted(steps.argmax(axis=1).tolist()) == [0, 1, 2]
        assert steps.sum(axis=1) == pytest.approx(2 / 3)


def test_linear_effects_are_exact_and_interactions_have_a_spread() -> None:
    def linear(at: Floats) -> Floats:
        return np.asarray(3 * at[:, 0] - at[:, 1])

    found = {row.parameter: row for row in indices(FREE, linear, 8)}
    assert list(found) == ["friction", "gamma", "leg_mean"]
    assert (found["friction"].mu_star, found["friction"].sigma) == pytest.approx((3.0, 0.0), abs=1e-9)
    assert (found["gamma"].mu_star, found["gamma"].mu) == pytest.approx((1.0, -1.0))
    assert found["leg_mean"].mu_star == pytest.approx(0.0, abs=1e-9)

    product = indices(FREE, lambda at: np.asarray(4 * at[:, 0] * at[:, 2]), 8)
    assert {row.parameter for row in product if row.sigma > 0.2} == {"friction", "leg_mean"}


def test_games_of_all_worlds_are_measured(tmp_path: Path) -> None:
    played: list[Run] = []

    def play(runs: Sequence[Run]) -> Generator[tuple[Run, Outcome], None, None]:
        for run in runs:
            played.append(run)
            yield run, Outcome([{"swarm": 1, "pucks": math.log(run.game.parameters.friction)}], [], {})

    def mean(rows: Rows) -> float:
        return float(np.mean([row["pucks"] for row in rows.swarms]))

    evidence = Evidence(tmp_path / "games.jsonl", {}, play)
    first, *others = sensitivity(FREE, {("fig-6.1a", ""): (6,)}, 2, mean, evidence, 3)
    assert first.parameter == "friction"
    assert first.mu_star == pytest.approx(math.log(1.5 / 0.15), rel=1e-3)  # over the whole range
    assert all(row.mu_star == pytest.approx(0.0, abs=1e-9) for row in others)
    assert {run.seed for run in played} == {20_000, 20_001}
