"""Signals of batch systems and closed terminals end commands as Ctrl-C does: no finished run is lost."""

import os
import pty
import re
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest

from kswarms.model.game_model import GameModel
from kswarms.scenarios.cli import invoke
from tests.helpers.tiny_study import RUN, Fault, read_sessions, read_tables, uninterrupted_tables

pytestmark = pytest.mark.usefixtures("tiny_file")

STATUS = {signal.SIGINT: 130, signal.SIGTERM: 143, signal.SIGHUP: 129}
WORDS = {
    "contribution": ["tiny.toml", "--condition", "", "--n", "4", "--seeds", "2", "--jobs", "1"],
    "replay": ["results", "RUN"],
    "film": ["tiny.toml", "--out", "film.gif"],
    "conflicts": ["tiny.toml"],
    "calibrate": ["--jobs", "1"],
}


@pytest.mark.parametrize("number", STATUS)
def test_a_signal_keeps_finished_runs_and_writes_tables(
    number: signal.Signals, before_games: Callable[[Fault], None], capsys: pytest.CaptureFixture[str]
) -> None:
    games = []

    def send(model: GameModel) -> None:
        games.append(model)
        if len(games) == 8:
            signal.raise_signal(number)

    handlers = [signal.getsignal(each) for each in STATUS]
    before_games(send)
    assert invoke(RUN) == STATUS[number]
    by = "" if number == signal.SIGINT else f" by {number.name}"
    assert capsys.readouterr().err.splitlines() == [
        "kswarms: results has the finished runs; repeat the command to resume",
        f"kswarms: interrupted{by}",
    ]
    assert [signal.getsignal(each) for each in STATUS] == handlers
    assert read_sessions()[0]["status"] == f"stopped: {number.name}"
    assert len(read_tables("results")) == 3
    assert invoke(RUN) == 0
    assert len(games) == 40 + 1
    assert read_sessions()[1]["runs"]["done before"] == 7
    assert read_tables("results") == uninterrupted_tables()


@pytest.mark.parametrize("first", [None, signal.SIGTERM])
def test_a_signal_does_not_interrupt_the_writing_of_tables(
    first: signal.Signals | None, before_games: Callable[[Fault], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = uninterrupted_tables()
    games = []

    def send(model: GameModel) -> None:
        games.append(model)
        if first and len(games) == 40:
            signal.raise_signal(first)

    real = Path.replace
    replaced = []

    def replace(path: Path, target: Path) -> Path:
        if path.suffix == ".parquet":
            signal.raise_signal(signal.SIGHUP)
            replaced.append(path.name)
        return real(path, target)

    before_games(send)
    with monkeypatch.context() as patch:
        patch.setattr(Path, "replace", replace)
        assert invoke(RUN) == (143 if first else 129)
    assert len(replaced) == 3
    assert read_sessions()[0]["status"] == (f"stopped: {first.name}" if first else "done")
    if first:
        assert invoke(RUN) == 0
    assert read_tables("results") == whole
    assert not list(Path("results").glob(".unfinished*"))


@pytest.mark.parametrize("moment", ["install", "restore"])
def test_a_signal_while_handlers_are_changed_is_no_traceback(
    moment: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    real, calls = signal.signal, []

    def change(number: int, handler: Any) -> Any:
        before = real(number, handler)
        calls.append(number)
        if len(calls) == (2 if moment == "install" else 4):
            signal.raise_signal(signal.SIGTERM)
        return before

    before = [signal.getsignal(number) for number in STATUS]
    with monkeypatch.context() as patch:
        patch.setattr(signal, "signal", change)
        assert invoke(["list"]) == 143
    for number, handler in zip(STATUS, before, strict=True):
        signal.signal(number, handler)
    assert capsys.readouterr().err == "kswarms: interrupted by SIGTERM\n"


def test_an_ignored_signal_stays_ignored(before_games: Callable[[Fault], None]) -> None:
    before_games(lambda model: signal.raise_signal(signal.SIGHUP))
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)  # as `nohup` does
    try:
        assert invoke([*RUN, "--seeds", "1"]) == 0
    finally:
        signal.signal(signal.SIGHUP, before)


@pytest.mark.parametrize("command", WORDS)
def test_signals_end_every_command(
    command: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke([*RUN, "--seeds", "1"]) == 0
    run = pq.read_table("results/runs.parquet")["run"][0].as_py()
    before = set(Path().rglob("*"))
    real = GameModel.__init__

    def start(model: GameModel, *arguments: Any, **options: Any) -> None:
        real(model, *arguments, **options)
        signal.raise_signal(signal.SIGTERM)

    monkeypatch.setattr(GameModel, "__init__", start)
    words = [run if word == "RUN" else word for word in WORDS[command]]
    assert invoke([command, *words]) == 143
    assert capsys.readouterr().err.splitlines()[-1] == "kswarms: interrupted by SIGTERM"
    left = set(Path().rglob("*")) - before
    assert command == "calibrate" or not left  # a fit keeps its trace, and is resumed
    assert not [path for path in left if ".unfinished" in path.name]


@pytest.mark.parametrize("style", ["bar", "json"])
def test_a_closed_terminal_loses_no_results(style: str) -> None:
    words = [word for word in RUN if word != "--quiet"]
    child, terminal = pty.fork()
    if child == 0:
        sys.stdout, sys.stderr = os.fdopen(1, "w"), os.fdopen(2, "w")  # pytest replaced them
        os._exit(invoke([*words, "--seeds", "2000", "--progress", style]))
    shown = b""
    while not re.search(rb'"done": 1,|[1-9]\d*/8000', shown):  # until the first run is finished
        shown += os.read(terminal, 1000)
    os.close(terminal)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 129
    assert read_sessions()[0]["status"] == "stopped: SIGHUP"
    assert len(read_tables("results")) == 3


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGTERM, pytest.param(signal.SIGHUP, marks=pytest.mark.full)])
def test_signals_end_the_page(number: signal.Signals) -> None:
    pytest.importorskip("solara")
    command = [sys.executable, "-m", "kswarms.scenarios.cli", "explore", "--no-browser", "--port", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline().startswith("page: ")
        process.send_signal(number)
        err = process.communicate(timeout=60)[1]
    assert process.returncode == STATUS[number]
    assert err == f"kswarms: interrupted by {number.name}\n"
