"""Calibration on synthetic games whose best world is known."""

import json
import math
from collections.abc import Generator, Sequence
from pathlib import Path
from typing import Any

import pytest

from kswarms.agents.common.errors import InputError
from kswarms.model.description.parameters import parse_parameters
from kswarms.scenarios.calibration.calibration import Setup, Stage, calibrate, ensemble_of
from kswarms.scenarios.calibration.directory import open_calibration
from kswarms.scenarios.calibration.evidence import Rows
from kswarms.scenarios.runs.outcome import Outcome
from kswarms.scenarios.runs.run import Run

SETUP = Setup(free=("friction", "gamma"), size=8, batch=16, tries=400, factor=3.0)
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
            scores = [abs(math.log(getattr(world, name) / value)) for name, value in TRUE.items()]
            yield run, Outcome([{"swarm": k, "pucks": score} for k, score in enumerate(scores)], [], {})


def judge_of(swarm: int) -> Any:
    def judge(rows: Rows) -> dict[str, float]:
        scores = [row["pucks"] for row in rows.swarms if row["swarm"] == swarm]
        return {f"target-{swarm}": sum(scores) / len(scores) / 0.3}

    return judge


STAGES = [
    Stage({("fig-6.1a", ""): (6,)}, 2, judge_of(0)),
    Stage({("fig-6.1c", ""): (6,)}, 1, judge_of(1)),
]


def run(out: Path, player: Player, fresh: bool = False, setup: Setup = SETUP) -> list[dict[str, Any]]:
    directory = open_calibration(out, {"setup": setup.model_dump(mode="json")}, player, fresh)
    waves = []
    for wave in calibrate(setup, STAGES, directory.evidence):
        directory.write(wave)
        waves.append(wave)
    return waves


def test_the_ensemble_surrounds_the_true_world(tmp_path: Path) -> None:
    *_, last = run(tmp_path / "fit", Player())
    assert last["factor"] == 1.0
    assert len(last["worlds"]) >= SETUP.size
    for world in last["worlds"]:
        parameters = parse_parameters(world["parameters"])
        off = [abs(math.log(getattr(parameters, name) / value)) / 0.3 for name, value in TRUE.items()]
        found = [world["implausibility"][f"target-{k}"] for k in (0, 1)]
        assert found == pytest.approx(off, abs=1e-3)
        assert max(off) <= 1.001
    assert sum(world["weight"] for world in last["worlds"]) == pytest.approx(1)


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


def test_the_ensemble_is_the_last_wave_or_the_nearest_worlds_of_all() -> None:
    def world(name: str, *implausibility: float) -> dict[str, Any]:
        by_target = dict(zip("ab", implausibility, strict=True))
        return {"parameters": name, "implausibility": by_target, "weight": 0.1}

    first = {"factor": 2.5, "worlds": [world("x", 2.4, 0.1), world("y", 1.1, 1.3), world("z", 0.5, 0.6)]}
    last = {"factor": 1.0, "worlds": [world("v", 0.9, 0.2)]}
    assert ensemble_of([first, last], 1) == {"factor": 1.0, "worlds": last["worlds"]}
    nearest = ensemble_of([first, last], 3)
    assert [(each["parameters"], each["weight"]) for each in nearest["worlds"]] == [
        ("z", 1 / 3),
        ("v", 1 / 3),
        ("y", 1 / 3),
    ]
    assert nearest["factor"] == 1.3
    assert ensemble_of([{"factor": 1.5, "worlds": []}], 2) == {"factor": 1.5, "worlds": []}


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
