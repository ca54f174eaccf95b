"""`kswarms calibrate` on games of few robots; resumption of a killed calibration."""

import json
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from kswarms.scenarios.cli import invoke

pytestmark = pytest.mark.usefixtures("empty_directory")

TARGETS = """
name = "tiny"
seeds = [1, 1]
[[targets]]
id = "attackers-score-less"
tolerance = 20
[targets.claim]
kind = "compare"
left = { scenario = "fig-6.1b" }
relation = "<"
right = { scenario = "fig-6.1a" }
densities = [6]
[[targets]]
id = "few-flee-within"
tolerance = 60
stage = 2
[targets.claim]
kind = "share above"
quantity = { measure = "learned_flight_within", scenario = "fig-6.8", swarm = 2 }
above = 10
densities = [6]
"""
TINY = [
    *("calibrate", "--targets", "tiny.toml", "--free", "friction,gamma", "--size", "2", "--tries", "2"),
    *("--jobs", "1"),
]


@pytest.fixture(autouse=True)
def _tiny(empty_directory: Path) -> None:
    Path("tiny.toml").write_text(TARGETS)


@pytest.mark.slow
def test_calibrate_prints_its_waves_and_plays_no_game_twice(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert invoke(TINY) == 0
    printed = capsys.readouterr()
    first, *_, worlds, last = printed.out.splitlines()
    assert first == "wave 1: of 2 worlds, 2 are near all targets, and 2 meet them"
    assert "ensemble: 2 worlds within" in printed.out
    assert worlds == "worlds: calibration/ensemble.csv"
    assert last == "trace: calibration/calibration.json"
    (header, *rows) = Path("calibration/ensemble.csv").read_text().splitlines()
    assert header == "friction,gamma"
    assert len(rows) == 2
    trace = json.loads(Path("calibration/calibration.json").read_text())
    assert trace["targets"]["name"] == "tiny"
    for world in trace["waves"][0]["worlds"]:
        assert set(world["parameters"]) == {"friction", "gamma"}
        assert set(world["implausibility"]) == {"attackers-score-less", "few-flee-within"}
    monkeypatch.setattr("kswarms.scenarios.runs.sweep.play_all", None)  # calling it would fail
    assert invoke(TINY) == 0
    assert capsys.readouterr().out == printed.out


# The process of a calibration kills itself before its fourth game.
KILLED = """
import os, signal, sys
from kswarms.model.game_model import GameModel
from kswarms.scenarios.cli import invoke

def play(model, real=GameModel.play, games=[]):
    games.append(model)
    if len(games) == 4:
        os.kill(os.getpid(), signal.SIGKILL)
    real(model)

GameModel.play = play
invoke(sys.argv[1:])
"""


@pytest.mark.slow
def test_a_killed_and_resumed_calibration_has_the_trace_of_an_undisturbed_one() -> None:
    assert invoke([*TINY, "--out", "whole"]) == 0
    killed = subprocess.run([sys.executable, "-c", KILLED, *TINY, "--out", "parts"], check=False)
    assert killed.returncode == -signal.SIGKILL
    assert len(Path("parts/games.jsonl").read_text().splitlines()) == 1 + 3
    assert invoke([*TINY, "--out", "parts"]) == 0
    assert Path("parts/calibration.json").read_bytes() == Path("whole/calibration.json").read_bytes()


@pytest.mark.parametrize(
    ("old", "new", "error"),
    [
        ("fig-6.8", "fig-9", "scenario='fig-9': must be one of `kswarms list`"),
        ("densities = [6]", "densities = [7]", "n=7: must be a multiple of 2"),
    ],
)
def test_targets_without_games_are_refused_and_nothing_is_written(
    old: str, new: str, error: str, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("tiny.toml").write_text(TARGETS.replace(old, new))
    assert invoke(TINY) == 2
    assert capsys.readouterr().err.startswith(f"kswarms: {error}")
    assert [path.name for path in Path().iterdir()] == ["tiny.toml"]


@pytest.mark.parametrize(
    ("words", "error"),
    [
        (["--targets", "absent.toml"], "targets='absent.toml': must be a readable file"),
        (["--free", "mass"], "free='mass': must be among conflict_distance"),
        (["--size", "1"], "size=1: must be greater than or equal to 2"),
    ],
)
def test_invalid_settings_are_refused_and_nothing_is_written(
    words: list[str], error: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke([*TINY, *words]) == 2
    assert capsys.readouterr().err.startswith(f"kswarms: {error}")
    assert [path.name for path in Path().iterdir()] == ["tiny.toml"]


def test_targets_that_no_world_is_near_are_an_error_after_the_trace(
    capsys: pytest.CaptureFixture[str],
) -> None:
    far = TARGETS.replace("stage = 2\n", "").replace("seeds = [1, 1]", "seeds = [1]")
    far = far.replace("tolerance = 20", "tolerance = 0.001").replace('relation = "<"', 'relation = ">"')
    Path("tiny.toml").write_text(far)
    assert invoke([*TINY, "--waves", "1"]) == 2
    printed = capsys.readouterr()
    assert printed.out.splitlines()[0] == "wave 1: of 2 worlds, 0 are near all targets, and 0 meet them"
    assert printed.err.startswith("kswarms: factor=1.5: must be larger: no world is near all targets")
    assert json.loads(Path("calibration/calibration.json").read_text())["ensemble"]["worlds"] == []
    assert not Path("calibration/ensemble.csv").exists()
