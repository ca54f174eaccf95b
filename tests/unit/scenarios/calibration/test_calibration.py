"""Calibration on synthetic games whose best world is known."""

import json
import math
from collections.abc import Generator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from kswarms.agents.common.arrays import Floats
from kswarms.agents.common.errors import InputError
from kswarms.scenarios.calibration.calibration import Setup, Stage, calibrate, ensemble_of
from kswarms.scenarios.calibration.directory import open_calibration
from kswarms.scenarios.calibration.evidence import Rows
from kswarms.scenarios.runs.outcome import Outcome
from kswarms.scenarios.runs.run import Run

SETUP = Setup(free=("friction", "gamma"), size=8, tries=16, waves=8)
TRUE = {"friction": 0.5, "gamma": 0.02}


class Player:
    """Plays runs: scores that are 0 in the true world, and an interruption after some runs."""

    def __init__(self, stop_after: float = math.inf, backwards: bool = False) -> None:
        self.runs: list[Run] = []
        self._stop_after, self._backwards = stop_after, backwards

    def __call__(self, runs: Sequence[Run]) -> Generator[tuple[Run, Outcome], None, None]:
        for run in reversed(runs) if self._backwards else runs:
            if len(self.runs) >= self._stop_after:
                raise KeyboardInterrupt
            self.runs.append(run)
            world = run.game.parameters
            scores = [math.log(getattr(world, name) / value) for name, value in TRUE.items()]
            yield run, Outcome([{"swarm": k, "pucks": score} for k, score in enumerate(scores)], [], {})


def stage(scenario: str, swarm: int, seeds: int) -> Stage:
    def outputs(rows: Rows) -> Floats:
        scores = [row["pucks"] for row in rows.swarms if row["swarm"] == swarm]
        return np.array([sum(scores) / len(scores)])

    return Stage(
        {(scenario, ""): (6,)}, seeds, outputs, (f"target-{swarm}",), lambda found: np.abs(found) / 0.3
    )


STAGES = [stage("fig-6.1a", 0, 2), stage("fig-6.1c", 1, 1)]


def run(out: Path, player: Player, fresh: bool = False, setup: Setup = SETUP) -> list[dict[str, Any]]:
    directory = open_calibration(out, {"setup": setup.model_dump(mode="json")}, player, fresh)
    waves = []
    for wave in calibrate(setup, STAGES, directory.evidence):
        directory.write(wave)
        waves.append(wave)
    return waves


def test_the_ensemble_surrounds_the_true_world(tmp_path: Path) -> None:
    found = ensemble_of(run(tmp_path / "fit", Player()), SETUP.size)
    assert found["factor"] == 1.0
    assert len(found["worlds"]) >= SETUP.size
    for world in found["worlds"]:
        off = [abs(math.log(world["parameters"][name] / value)) / 0.3 for name, value in TRUE.items()]
        assert list(world["implausibility"].values()) == pytest.approx(off, abs=1e-3)
        assert max(off) <= 1.001


def test_each_wave_has_its_own_seeds(tmp_path: Path) -> None:
    player = Player()
    waves = run(tmp_path / "fit", player)
    seeds = {"fig-6.1a": set[int](), "fig-6.1c": set[int]()}
    for played in player.runs:
        seeds[played.labels[0][0]].add(played.seed)
    assert seeds["fig-6.1a"] == {10_000 + 3 * wave + k for wave in range(len(waves)) for k in (0, 1)}
    assert seeds["fig-6.1c"] == {10_002 + 3 * wave for wave in range(len(waves))}


def test_interruptions_and_the_order_of_games_do_not_change_the_trace(tmp_path: Path) -> None:
    run(tmp_path / "whole", Player())
    for stop_after in (5, 60):
        with pytest.raises(KeyboardInterrupt):
            run(tmp_path / "parts", Player(stop_after))
    run(tmp_path / "parts", Player(backwards=True))
    whole, parts = (tmp_path / name / "calibration.json" for name in ("whole", "parts"))
    assert whole.read_bytes() == parts.read_bytes()
    again = Player()
    run(tmp_path / "whole", again)
    assert again.runs == []
    run(tmp_path / "whole", again, fresh=True)
    assert again.runs
    assert whole.read_bytes() == parts.read_bytes()


def test_another_calibration_and_other_files_are_refused(tmp_path: Path) -> None:
    run(tmp_path / "fit", Player())
    before = {path.name: path.read_bytes() for path in (tmp_path / "fit").iterdir()}
    with pytest.raises(InputError, match="has games of other settings"):
        run(tmp_path / "fit", Player(), setup=SETUP.replace(size=9))
    assert {path.name: path.read_bytes() for path in (tmp_path / "fit").iterdir()} == before
    assert json.loads(before["calibration.json"])["setup"]["size"] == 8


def test_the_ensemble_has_the_compatible_worlds_or_the_nearest() -> None:
    def world(name: str, *implausibility: float) -> dict[str, Any]:
        return {"parameters": name, "implausibility": dict(zip("ab", implausibility, strict=True))}

    x, y, z, v = world("x", 2.4, 0.1), world("y", 1.1, 1.3), world("z", 0.5, 0.6), world("v", 0.9, 0.2)
    waves = [{"worlds": [x, y, z]}, {"worlds": [v]}]
    assert ensemble_of(waves, 1) == ensemble_of(waves, 2) == {"factor": 1.0, "worlds": [z, v]}
    assert ensemble_of(waves, 3) == {"factor": 1.3, "worlds": [z, v, y]}
    assert ensemble_of([{"worlds": []}], 2) == {"factor": 1.0, "worlds": []}


@pytest.mark.parametrize("name", ["code_version", "environment"])
def test_games_of_other_code_or_versions_are_refused(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run(tmp_path / "fit", Player())
    monkeypatch.setattr(f"kswarms.scenarios.calibration.directory.{name}", lambda: "another")
    with pytest.raises(InputError, match="has games of other settings"):
        run(tmp_path / "fit", Player())


@pytest.mark.parametrize(
    ("free", "rule"),
    [
        (("friction", "friction"), "must be one or more different parameters"),
        ((), "must be one or more different parameters"),
        (("mass",), "must be among conflict_distance"),
    ],
)
def test_unknown_and_repeated_parameters_are_refused(free: tuple[str, ...], rule: str) -> None:
    with pytest.raises(InputError, match=rf"^free=.*: {rule}"):
        Setup(free=free)
