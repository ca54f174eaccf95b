"""Studies that are killed, interrupted or damaged, or run out of disk space: they keep finished runs."""

import json
import os
import signal
import sqlite3
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest

from kswarms.model.game_model import GameModel
from kswarms.scenarios.cli import invoke
from kswarms.scenarios.study.database import LEDGER_FILE
from kswarms.scenarios.study.study import Study
from tests.helpers.interrupts import wait_for_end_of_group
from tests.helpers.tiny_study import RUN, TINY, Fault, read_sessions, read_tables, uninterrupted_tables

pytestmark = pytest.mark.usefixtures("tiny_file")


def finished_runs() -> set[str]:
    return set(pq.read_table("results/runs.parquet")["run"].to_pylist())


def test_ctrl_c_keeps_finished_runs(
    before_games: Callable[[Fault], None], capsys: pytest.CaptureFixture[str]
) -> None:
    games = []

    def interrupt(model: GameModel) -> None:
        games.append(model.game.size)
        if len(games) == 8:
            raise KeyboardInterrupt

    before_games(interrupt)
    assert invoke(RUN) == 130
    first, last = capsys.readouterr().err.splitlines()
    assert first == "kswarms: results has the finished runs; repeat the command to resume"
    assert last == "kswarms: interrupted"
    assert read_sessions()[0]["status"] == "stopped: KeyboardInterrupt"
    assert len(finished_runs()) == 7
    assert invoke(RUN) == 0
    assert len(games) == 40 + 1
    assert read_tables("results") == uninterrupted_tables()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "to_all"),
    [
        (signal.SIGINT, True),
        pytest.param(signal.SIGHUP, True, marks=pytest.mark.full),  # handled like SIGINT
        (signal.SIGTERM, False),
    ],
)
def test_signals_stop_worker_processes_and_keep_finished_runs(number: signal.Signals, to_all: bool) -> None:
    # Over half a minute of games, so that the signal arrives before the last, even on a slow machine.
    words = ["run", "fig-6.2", "--densities", "50", "--seeds", "500", "--no-figures", "--jobs", "2"]
    with subprocess.Popen(
        [sys.executable, "-m", "kswarms.scenarios.cli", *words, "--progress", "json"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as process:
        assert process.stderr is not None
        line = json.loads(process.stderr.readline())
        assert (line["done"], line["failed"], line["total"], line["scenario"]) == (1, 0, 500, "fig-6.2")
        assert line["seconds_left"] > 0
        if to_all:
            os.killpg(process.pid, number)  # like a terminal, also to the workers
        else:
            process.send_signal(number)  # like a batch system
        out, err = process.communicate(timeout=20)
    assert process.returncode == 128 + number
    assert out == ""
    assert "Traceback" not in err
    assert err.splitlines()[-1].startswith("kswarms: interrupted")
    wait_for_end_of_group(process.pid)
    finished = finished_runs()
    assert 1 <= len(finished) < 500
    assert read_sessions()[0]["status"] == f"stopped: {number.name}"
    assert invoke([*words, "--seeds", "2", "--jobs", "1", "--quiet"]) == 0
    assert read_sessions()[1]["runs"]["done before"] >= 1
    assert finished <= finished_runs()


def test_a_full_disk_stops_the_sweep_and_keeps_finished_runs(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    whole = uninterrupted_tables()
    real = sqlite3.connect

    def small(path: Path, **options: Any) -> sqlite3.Connection:
        connection: sqlite3.Connection = real(path, **options)
        connection.execute("PRAGMA max_page_count = 30")
        return connection

    with monkeypatch.context() as patch:
        patch.setattr(sqlite3, "connect", small)
        assert invoke(RUN) == 1
    assert capsys.readouterr().err == "kswarms: results/ledger.sqlite: database or disk is full\n"
    assert not Path("results/runs.parquet").exists()
    assert invoke(RUN) == 0
    assert 0 < read_sessions()[-1]["runs"]["done before"] < 40
    assert read_tables("results") == whole


@pytest.mark.parametrize("failing", ["write_table", "replace"])
def test_tables_that_cannot_be_written_stay_unchanged(
    failing: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke([*RUN, "--seeds", "1"]) == 0
    before = read_tables("results")

    def full(*_arguments: object) -> None:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(pq.ParquetWriter if failing == "write_table" else Path, failing, full)
        assert invoke([*RUN, "--seeds", "2"]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("kswarms: [Errno 28] No space left on device")
    assert read_tables("results") == before
    assert not list(Path("results").glob(".unfinished-tables*"))
    assert invoke(RUN) == 0
    assert read_tables("results") == uninterrupted_tables()


@pytest.mark.parametrize(
    "name", ["runs.parquet", "manifest.json", ".unfinished-0123456789abcdef.json", "lock"]
)
def test_truncated_files_are_replaced(name: str) -> None:
    whole = uninterrupted_tables()
    assert invoke([*RUN, "--seeds", "3"]) == 0
    half = Path("whole", name).read_bytes()[:100] if Path("whole", name).exists() else b'{"half'
    Path("results", name).write_bytes(half)
    left_over = Path("results/.unfinished-tables-x")
    left_over.mkdir()
    (left_over / "runs.parquet").write_bytes(half)
    assert invoke(RUN) == 0
    assert read_tables("results") == whole
    assert not list(Path("results").glob(".unfinished*"))
    assert json.loads(Path("results/manifest.json").read_text())["scenarios"] == {"tiny": TINY.to_toml()}


def test_a_truncated_commit_is_ignored() -> None:
    whole = uninterrupted_tables()
    child = os.fork()
    if child == 0:  # exits without closing the ledger, so the last commits are in its journal
        with Study(Path("results")) as study:
            for k, _ in enumerate(study.play(study.plan([TINY], records=["robots"]), records=["robots"])):
                if k == 30:
                    os._exit(0)
    os.waitpid(child, 0)
    journal = Path("results", f"{LEDGER_FILE}-wal")
    journal.write_bytes(journal.read_bytes()[:-1000])
    assert invoke(RUN) == 0
    assert 0 < read_sessions()[-1]["runs"]["done before"] < 31
    assert read_tables("results") == whole


@pytest.mark.parametrize(
    "statement",
    [
        "UPDATE runs SET swarms = 'nonsense'",
        "UPDATE runs SET swarms = '[{}]'",
        "UPDATE records SET rows = x'00'",
        "UPDATE sessions SET about = 'nonsense'",
    ],
)
def test_a_damaged_ledger_is_reported_in_one_line_and_tables_stay_unchanged(
    statement: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke([*RUN, "--seeds", "1"]) == 0
    before = read_tables("results")
    with sqlite3.connect(Path("results", LEDGER_FILE)) as ledger:
        ledger.execute(statement)
    ledger.close()
    assert invoke([*RUN, "--seeds", "1"]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert "ledger.sqlite: is damaged (" in line
    assert read_tables("results") == before
