"""Studies that end suddenly: by kills, Ctrl-C, full disks and damage, what was played is kept and goes on."""

import json
import os
import random
import shutil
import signal
import sqlite3
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from kswarms.model.game_model import GameModel
from kswarms.scenarios.cli import invoke
from kswarms.scenarios.study.database import LEDGER_FILE
from kswarms.scenarios.study.study import Study
from tests.helpers.interrupts import heed_interrupts
from tests.helpers.tiny_study import RUN, TINY, Fault, contents, sessions, undisturbed

pytestmark = pytest.mark.usefixtures("with_a_file_of_scenarios")

INTERRUPTED = ["kswarms: results keeps the finished runs; the same command resumes", "kswarms: interrupted"]
NOBODY = 99_999_999
"""Number that no process has."""
KSWARMS = [sys.executable, "-m", "kswarms.scenarios.cli"]


@pytest.mark.parametrize("moments", [5, pytest.param(50, marks=pytest.mark.full)])
def test_a_sweep_killed_at_any_moment_goes_on_to_the_same_tables(moments: int) -> None:
    whole = undisturbed()
    shutil.rmtree("whole")
    started = time.monotonic()
    assert undisturbed() == whole
    length = time.monotonic() - started
    draws = random.Random(moments)
    played = []
    for moment in range(moments):
        directory = f"killed-{moment}"
        # Forked, for a new process would spend most of the moments on its imports.
        child = os.fork()
        if child == 0:
            invoke([*RUN, "--out", directory])
            os._exit(0)
        time.sleep((moment + draws.random()) / moments * length)
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        assert invoke([*RUN, "--out", directory]) == 0
        assert contents(directory) == whole
        played.append(sessions(directory)[-1]["runs"]["done before"])
        assert sessions(directory)[-1]["status"] == "done"
        assert not list(Path(directory).glob(".unfinished*"))
    assert len(set(played)) > 2, "all moments were before the first run or after the last"


def test_ctrl_c_in_the_own_process_keeps_what_is_done(
    break_games: Callable[[Fault], None], capsys: pytest.CaptureFixture[str]
) -> None:
    games = []

    def interrupt(model: GameModel) -> None:
        games.append(model.game.size)
        if len(games) == 8:
            raise KeyboardInterrupt

    break_games(interrupt)
    assert invoke(RUN) == 130
    assert capsys.readouterr().err.splitlines() == INTERRUPTED
    assert sessions("results")[0]["status"] == "stopped: KeyboardInterrupt"
    assert len(set(pq.read_table("results/runs.parquet")["run"].to_pylist())) == 7
    assert invoke(RUN) == 0
    assert len(games) == 80 + 1
    assert contents("results") == undisturbed()


@pytest.mark.slow
def test_ctrl_c_stops_the_workers_and_keeps_what_is_done() -> None:
    # More than half a minute of games, so that the signal comes before the last however late it is.
    words = ["run", "fig-6.2", "--densities", "50", "--seeds", "500", "--no-figures", "--jobs", "2"]
    with subprocess.Popen(
        [*KSWARMS, *words, "--progress", "json"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=heed_interrupts,
    ) as process:
        assert process.stderr is not None
        line = json.loads(process.stderr.readline())
        assert (line["done"], line["failed"], line["total"], line["scenario"]) == (1, 0, 500, "fig-6.2")
        assert line["seconds_left"] > 0
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to the workers too
        out, err = process.communicate(timeout=20)
    assert process.returncode == 130
    assert out == ""
    assert "Traceback" not in err
    assert err.splitlines()[-2:] == INTERRUPTED
    done = set(pq.read_table("results/runs.parquet")["run"].to_pylist())
    assert 1 <= len(done) < 500
    assert sessions("results")[0]["status"] == "stopped: KeyboardInterrupt"
    assert invoke([*words, "--seeds", "2", "--jobs", "1", "--quiet"]) == 0
    assert sessions("results")[1]["runs"]["done before"] >= 1
    assert done <= set(pq.read_table("results/runs.parquet")["run"].to_pylist())


def test_a_full_disk_stops_the_sweep_and_keeps_what_was_played(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    whole = undisturbed()
    real = sqlite3.connect

    def small(path: Path) -> sqlite3.Connection:
        connection = real(path)
        connection.execute("PRAGMA max_page_count = 40")
        return connection

    with monkeypatch.context() as patch:
        patch.setattr(sqlite3, "connect", small)
        assert invoke([*RUN, "--out", "full"]) == 1
    assert capsys.readouterr().err == "kswarms: full/ledger.sqlite: database or disk is full\n"
    assert not Path("full/runs.parquet").exists()
    assert invoke([*RUN, "--out", "full"]) == 0
    assert 0 < sessions("full")[-1]["runs"]["done before"] < 80
    assert contents("full") == whole


@pytest.mark.parametrize("failing", ["write_table", "replace"])
def test_tables_that_cannot_be_written_stay_as_they_were(
    failing: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke([*RUN, "--seeds", "1"]) == 0
    before = contents("results")

    def full(*_arguments: object) -> None:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(pq.ParquetWriter if failing == "write_table" else Path, failing, full)
        assert invoke(RUN) == 1
    assert capsys.readouterr().err == "kswarms: [Errno 28] No space left on device\n"
    assert contents("results") == before
    assert not list(Path("results").glob(".unfinished-tables*"))
    whole = undisturbed()
    assert invoke(RUN) == 0
    assert contents("results") == whole


@pytest.mark.parametrize(
    "name", ["runs.parquet", "manifest.json", f".unfinished-{NOBODY}-manifest.json", "lock"]
)
def test_half_a_file_is_written_anew(name: str) -> None:
    whole = undisturbed()
    assert invoke([*RUN, "--seeds", "3"]) == 0
    half = Path("whole", name).read_bytes()[:100] if Path("whole", name).exists() else b'{"half'
    Path("results", name).write_bytes(half)
    left_over = Path("results/.unfinished-tables-x")
    left_over.mkdir()
    (left_over / "runs.parquet").write_bytes(half)
    assert invoke(RUN) == 0
    assert contents("results") == whole
    assert not list(Path("results").glob(".unfinished*"))
    assert json.loads(Path("results/manifest.json").read_text())["scenarios"] == {"tiny": TINY.to_toml()}


def test_half_a_commit_is_forgotten() -> None:
    whole = undisturbed()
    child = os.fork()
    if child == 0:  # ends without closing its ledger, so what was committed last stands beside the file
        with Study(Path("results")) as study:
            for k, _ in enumerate(study.play(study.plan([TINY], records=["robots"]), records=["robots"])):
                if k == 30:
                    os._exit(0)
    os.waitpid(child, 0)
    journal = Path("results", f"{LEDGER_FILE}-wal")
    journal.write_bytes(journal.read_bytes()[:-1000])
    assert invoke(RUN) == 0
    assert 0 < sessions("results")[-1]["runs"]["done before"] < 31
    assert contents("results") == whole
