"""`kswarms calibrate` on games of few robots; resumption of a killed fit on synthetic games."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from kswarms.analysis.results import published
from kswarms.scenarios.cli import invoke

pytestmark = pytest.mark.usefixtures("empty_directory")

TINY = [
    *("calibrate", "--free", "friction,gamma", "--densities", "6", "--seeds", "1", "--generations", "2"),
    *("--population", "4", "--validation-seeds", "6"),
]

# A fit on synthetic games whose process kills itself after some games.
FIT = """
import math, os, signal, sys
from pathlib import Path
from kswarms.analysis.statistics.intervals import bootstrap_interval
from kswarms.scenarios.calibration import shares
from kswarms.scenarios.calibration.fit import Setup, calibrate

shares._SAVE_EVERY = float(sys.argv[3])
games = 0

def play(runs):
    global games
    for run in runs:
        games += 1
        if games > int(sys.argv[2]):
            os.kill(os.getpid(), signal.SIGKILL)
        yield run, min(1.0, abs(math.log(run.game.parameters.friction / 0.3)) + 0.01 * (run.seed % 7))

setup = Setup(free=("friction", "gamma"), densities=(6,), seeds=1, generations=3, population=4)
calibrate(setup, {("avoid", 6): 2.0, ("attack", 6): 0.0}, play, bootstrap_interval, Path(sys.argv[1]))
"""


@pytest.fixture
def one_row(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reduce Table 6.1 to its first row, so that a validation takes seconds."""
    table = published.table_6_1().head(1)
    monkeypatch.setattr(published, "table_6_1", lambda: table.copy())


def _fit(out: str, games: int, save_every: float = 0.0) -> int:
    return subprocess.run([sys.executable, "-c", FIT, out, str(games), str(save_every)]).returncode


@pytest.mark.slow
def test_a_killed_and_resumed_fit_has_the_trace_of_an_undisturbed_one() -> None:
    assert _fit("whole", 10_000) == 0
    assert _fit("parts", 5) == -9
    assert _fit("parts", 9, save_every=1000.0) == -9  # these games are not saved, and are played again
    assert _fit("parts", 10_000) == 0
    assert Path("parts/calibration.json").read_bytes() == Path("whole/calibration.json").read_bytes()


@pytest.mark.slow
@pytest.mark.usefixtures("one_row")
def test_calibrate_prints_its_result_and_plays_no_game_twice(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert invoke([*TINY, "--jobs", "1"]) == 0
    printed = capsys.readouterr()
    lines = dict(line.split(": ", 1) for line in printed.out.splitlines())
    assert list(lines) == ["error", "gain", "start", "parameters", "rule", "trace"]
    assert lines["trace"].strip() == "calibration/calibration.json"
    trace = json.loads(Path("calibration/calibration.json").read_text())
    assert lines["parameters"].strip() == trace["result"]["parameters"]
    assert len(trace["generations"]) == 2
    assert all(0 <= error <= 100 for generation in trace["generations"] for error in generation["errors"])
    assert "generation 2 of 2: errors" in printed.err

    monkeypatch.setattr("kswarms.scenarios.runs.sweep.play_all", None)  # calling it would fail
    assert invoke(TINY) == 0
    assert capsys.readouterr().out == printed.out


def test_a_density_outside_the_table_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["calibrate", "--densities", "6,7"]) == 2
    assert capsys.readouterr().err.startswith("kswarms: densities=7: must be among 6, 10, 16")
    assert not list(Path().iterdir())
