"""Studies: what they keep through kills, full disks and damage, and what they refuse to mix."""

import json
import os
import random
import shlex
import shutil
import signal
import sqlite3
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import mesa
import pyarrow.parquet as pq
import pytest

from agents.errors import InputError
from model.foraging import GameModel
from model.plain import ForagingModel
from scenarios import runs as runs_module
from scenarios.cli import invoke
from scenarios.description import Condition, Scenario, SwarmRule
from scenarios.ledger import FILE, Ledger, find_run
from scenarios.runner import Failure, play
from scenarios.runs import expand
from scenarios.study import Study, holder
from tests.interrupts import heed_interrupts

TINY = Scenario(
    id="tiny",
    title="Games of two seconds",
    densities=(4, 6),
    seeds=20,
    conditions=(
        Condition(swarms=(SwarmRule(policy="avoid"), SwarmRule(policy="attack")), duration=2.0),
        Condition(
            name="learner",
            swarms=(SwarmRule(policy="avoid"), SwarmRule(policy="inter-learner")),
            learning=2.0,
            duration=2.0,
        ),
    ),
)
RUN = ["run", "tiny.toml", "--jobs", "1", "--quiet", "--no-figures", "--record", "robots"]
TABLES = ("runs.parquet", "policies.parquet", "robots.parquet")
INTERRUPTED = ["kswarms: results keeps what was played; the same command goes on", "kswarms: interrupted"]
KSWARMS = [sys.executable, "-m", "scenarios.cli"]

Fault = Callable[[GameModel], None]


@pytest.fixture(autouse=True)
def _with_a_file_of_scenarios(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let relative paths lead into a directory of the test's own, which workers can leave for the package."""
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(path or str(Path.cwd()) for path in sys.path))
    monkeypatch.chdir(tmp_path)
    Path("tiny.toml").write_text(TINY.to_toml())


@pytest.fixture
def break_games(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[Fault], None]]:
    """Let something happen before each game."""
    real = GameModel.play

    def install(fault: Fault) -> None:
        def broken(model: GameModel) -> None:
            fault(model)
            real(model)

        monkeypatch.setattr(GameModel, "play", broken)

    return install  # type: ignore[return-value]


def contents(directory: str) -> list[bytes]:
    return [Path(directory, name).read_bytes() for name in TABLES]


def undisturbed() -> list[bytes]:
    assert invoke([*RUN, "--out", "whole"]) == 0
    return contents("whole")


def sessions(directory: str) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = json.loads(Path(directory, "manifest.json").read_text())["sessions"]
    return found


# ------------------------------------------------------------------------------------------------ sudden ends


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


@pytest.mark.parametrize("name", ["runs.parquet", "manifest.json", ".unfinished-1-manifest.json", "lock"])
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
    journal = Path("results", f"{FILE}-wal")
    journal.write_bytes(journal.read_bytes()[:-1000])
    assert invoke(RUN) == 0
    assert 0 < sessions("results")[-1]["runs"]["done before"] < 31
    assert contents("results") == whole


# ------------------------------------------------------------------------------------------ who may play here


def test_two_sweeps_on_one_directory_do_not_meet(capsys: pytest.CaptureFixture[str]) -> None:
    with Study(Path("results"), "kswarms run tiny.toml") as study:
        study.plan([TINY])
        user = holder(Path("results"))
        assert user.startswith(f"process {os.getpid()} on ")
        assert invoke(RUN) == 2
        refusal = capsys.readouterr().err
        assert refusal == f"kswarms: out='results': is in use by {user}; wait for it, or name another\n"
        assert "(kswarms run tiny.toml)" in refusal
        assert invoke(["status", "results"]) == 0
        assert f"in use by: {user}" in capsys.readouterr().out
    assert holder(Path("results")) == ""
    assert invoke(RUN) == 0


@pytest.mark.parametrize("foreign", ["runs.parquet", "policies.parquet"])
def test_tables_without_their_ledger_are_not_replaced(
    foreign: str, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("results").mkdir()
    Path("results", foreign).write_text("my jogging diary")
    assert invoke(RUN) == 2
    assert capsys.readouterr().err == (
        f"kswarms: out='results': has a {foreign} but no ledger.sqlite; name another\n"
    )
    assert Path("results", foreign).read_text() == "my jogging diary"
    assert [path.name for path in Path("results").iterdir()] == [foreign]


def test_a_ledger_of_something_else_is_refused_and_left_alone(capsys: pytest.CaptureFixture[str]) -> None:
    Path("text").mkdir()
    Path("text", FILE).write_text("my jogging diary")
    Path("other").mkdir()
    with sqlite3.connect(Path("other", FILE)) as db:
        db.execute("CREATE TABLE jogging (km REAL)")
    db.close()
    shutil.copytree("other", "later")
    with sqlite3.connect(Path("later", FILE)) as db:
        db.executescript("PRAGMA application_id = 1803772781; PRAGMA user_version = 2")
    db.close()
    for name, reason in (("text", "file is not"), ("other", "it is not"), ("later", "form 2 where 1 is")):
        before = Path(name, FILE).read_bytes()
        assert invoke([*RUN, "--out", name]) == 2
        assert f"='{name}/{FILE}': must be a ledger of kswarms ({reason}" in capsys.readouterr().err
        assert Path(name, FILE).read_bytes() == before


# ------------------------------------------------------------------------------------------ what does not mix


def test_a_curve_described_otherwise_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke([*RUN, "--seeds", "2"]) == 0
    before = contents("results")
    longer = tuple(condition.replace(duration=3.0) for condition in TINY.conditions)
    # Other densities, so that no point of the curve is there already.
    Path("tiny.toml").write_text(TINY.replace(conditions=longer, densities=(8,)).to_toml())
    assert invoke(RUN) == 2
    refusal = "out='results': has runs of a tiny described otherwise; name another, or give it another id"
    assert capsys.readouterr().err == f"kswarms: {refusal}\n"
    assert contents("results") == before
    assert len(sessions("results")) == 1
    Path("tiny.toml").write_text(TINY.replace(conditions=longer, id="longer").to_toml())
    assert invoke(RUN) == 0
    assert set(pq.read_table("results/runs.parquet")["scenario"].to_pylist()) == {"tiny", "longer"}


def test_learned_policies_that_changed_make_another_curve(tmp_path: Path) -> None:
    arm = {"opponent": 1, "action": "fight", "reward": 1.0, "time": 1.0, "count": 1.0, "q": 0.1}
    file = tmp_path / "learned.json"
    content = {"format": "kswarms-policies-1", "swarm": 2, "robots": [[arm]]}
    file.write_text(json.dumps(content))
    swarms = (SwarmRule(policy="avoid"), SwarmRule(policy=f"learned(file='{file}')"))
    loading = TINY.replace(conditions=(Condition(swarms=swarms, duration=1.0),), seeds=1)
    with Study(Path("results")) as study:
        (run, *_) = study.plan([loading])
    file.write_text(json.dumps(content | {"robots": [[arm | {"action": "flight"}]]}))
    with Study(Path("results")) as study, pytest.raises(InputError, match="described otherwise"):
        study.plan([loading.replace(densities=(8,))])
    with pytest.raises(InputError, match="what its game loads has changed"):
        find_run(Path("results"), run.digest)


def test_runs_of_another_version_are_refused(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke([*RUN, "--seeds", "1"]) == 0
    before = contents("results")
    for module in ("scenarios.runs", "scenarios.ledger", "scenarios.study"):
        monkeypatch.setattr(f"{module}.package_version", lambda: "9.0.0")
    version = runs_module.version("kswarms")
    assert invoke(RUN) == 2
    assert capsys.readouterr().err == (
        f"kswarms: out='results': has runs of kswarms {version}, this is 9.0.0; name another\n"
    )
    assert contents("results") == before


def test_runs_of_other_code_are_told_of(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with monkeypatch.context() as patch:
        for module in ("scenarios.ledger", "scenarios.runner"):
            patch.setattr(f"{module}.code_version", lambda: "0.1.0 before")
        assert invoke([*RUN, "--seeds", "1"]) == 0
        assert capsys.readouterr().err == ""
    assert invoke(RUN) == 0
    assert capsys.readouterr().err == (
        "kswarms: results keeps runs of other code, 0.1.0 before; to play them anew, name another --out\n"
    )
    assert invoke(["status", "results"]) == 0
    assert "played by: kswarms 0.1.0 before, 4 runs" in capsys.readouterr().out


# ------------------------------------------------------------------------------------------- what is played


def test_what_two_figures_share_is_played_once_also_in_two_sessions(
    break_games: Callable[[Fault], None],
) -> None:
    games = []
    break_games(lambda model: games.append(model.game.size))
    tale = TINY.replace(id="tale", densities=(6, 8), seeds=3)
    with Study(Path("results")) as study:
        list(study.play(study.plan([TINY.replace(seeds=2), tale])))
    assert len(games) == 2 * (2 + 3 + 3)  # two curves: N = 4 of the one, 6 of both, 8 of the other
    with Study(Path("results")) as study:
        assert len(study.plan([TINY.replace(seeds=2), tale, tale.replace(id="again")])) == 0
    again = pq.read_table("results/runs.parquet").to_pylist()
    assert {row["run"] for row in again if row["scenario"] == "again"} == {
        row["run"] for row in again if row["scenario"] == "tale"
    }


def test_a_run_without_the_record_asked_for_is_played_again(break_games: Callable[[Fault], None]) -> None:
    assert invoke([*RUN[:-2], "--seeds", "1"]) == 0
    games = []
    break_games(lambda model: games.append(model.game.size))
    assert invoke([*RUN, "--seeds", "2"]) == 0
    assert len(games) == 8
    assert invoke([*RUN[:-2], "--seeds", "2"]) == 0
    assert len(games) == 8
    assert pq.read_table("results/robots.parquet").num_rows == 2 * 2 * (4 + 6)


def test_a_failed_run_is_a_row_and_its_command_replays_it(
    break_games: Callable[[Fault], None], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fault(model: GameModel) -> None:
        if model.game.size == 6 and model.game.learning:
            raise ZeroDivisionError("no robot\nis left")

    words = ["run", "tiny.toml", "--seeds", "2", "--jobs", "1", "--no-figures", "--out", "my results"]
    with monkeypatch.context():
        break_games(fault)
        assert invoke(words) == 1
        printed = capsys.readouterr()
        told = "kswarms: 2 of 8 runs failed; see `kswarms status 'my results'`"
        assert printed.err.splitlines()[-1] == told
        assert printed.out.splitlines()[-1].startswith("next:   kswarms status 'my results'")
        assert pq.read_table("my results/runs.parquet").num_rows == 2 * 6

        assert invoke(["status", "my results"]) == 0
        lines = capsys.readouterr().out.splitlines()
        assert lines[1].split()[:4] == ["tiny", "6", "2", "0"]
        assert lines[2].split()[:6] == ["runs,", "each", "once", "6", "2", "0"]
        failed = lines.index("failed: tiny learner, n=6, seed=0: ZeroDivisionError: no robot is left")
        assert lines[failed + 2] == '  raise ZeroDivisionError("no robot\\nis left")'
        with Ledger(Path("my results", FILE)) as ledger:
            ((trace, replay),) = ledger.query(
                "SELECT traceback, replay FROM runs WHERE status = 'failed' AND seed = 0"
            )
        assert lines[failed + 3] == f"  again: {replay}"
        assert trace.startswith("Traceback")

        program, *again = shlex.split(replay)
        assert program == "kswarms"
        assert invoke(again) == 1
        assert capsys.readouterr().err.splitlines()[-1].endswith("ZeroDivisionError: no robot is left")

    break_games(lambda model: None)  # mended
    assert invoke(words) == 0
    assert sessions("my results")[-1]["runs"] == {"asked for": 8, "done before": 6}
    capsys.readouterr()
    assert invoke(again) == 0
    assert capsys.readouterr().out.splitlines()[-1] == "the same as in my results"
    assert pq.read_table("my results/runs.parquet").num_rows == 2 * 8


def test_a_replay_that_differs_is_told(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke([*RUN, "--seeds", "1"]) == 0
    name = pq.read_table("results/runs.parquet")["run"][0].as_py()
    run = find_run(Path("results"), name)
    assert run == next(each for each in expand([TINY]) if each.digest == name)
    real = GameModel.results
    monkeypatch.setattr(GameModel, "results", lambda model: [row | {"pucks": 99} for row in real(model)])
    assert invoke(["replay", "results", name]) == 1
    printed = capsys.readouterr()
    assert printed.err == "kswarms: results has other results of it: they were played by other code\n"
    assert "pucks=99" in printed.out
    with Study(Path("results")) as study:
        (missing,) = study.plan([TINY.replace(densities=(8,), seeds=1, conditions=TINY.conditions[:1])])
    assert invoke(["replay", "results", missing.digest]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == "results has no results of it"
    assert invoke(["replay", "results", "0" * 16]) == 2
    assert capsys.readouterr().err.startswith(f"kswarms: run='{'0' * 16}': must be a run of results: see ")


def test_a_study_without_an_outcome_has_no_tables(break_games: Callable[[Fault], None]) -> None:
    def fault(model: GameModel) -> None:
        raise MemoryError

    break_games(fault)
    assert invoke(["run", "tiny.toml", "--seeds", "1", "--jobs", "1"]) == 1
    assert not list(Path("results").glob("*.parquet"))


def test_missing_runs_are_counted(capsys: pytest.CaptureFixture[str]) -> None:
    with Study(Path("results")) as study:
        runs = study.plan([TINY])
        for k, _ in enumerate(study.play(runs)):
            if k == 9:
                break
    assert invoke(["status", "results"]) == 0
    assert capsys.readouterr().out.splitlines()[1].split()[:4] == ["tiny", "10", "0", "70"]
    assert pq.read_table("results/runs.parquet").num_rows == 20


def test_the_manifest_tells_how_the_results_came_about() -> None:
    assert invoke([*RUN, "--seeds", "1", "--first-seed", "3"]) == 0
    manifest = json.loads(Path("results/manifest.json").read_text())
    assert manifest["kswarms"] == runs_module.version("kswarms")
    assert "SeedSequence(seed" in manifest["entropy"]
    (session,) = manifest["sessions"]
    assert session["command"] == f"kswarms {shlex.join(RUN)} --seeds 1 --first-seed 3"
    assert session["scenarios"] == {"tiny": {"densities": [4, 6], "seeds": 1}}
    assert (session["first_seed"], session["records"]) == (3, ["robots"])
    assert session["libraries"].keys() >= {"mesa", "simpy", "numpy", "numba"}
    assert session["started"] <= session["ended"]
    assert str(Path.cwd()) not in Path("results/manifest.json").read_text()


@pytest.mark.slow
def test_the_memory_of_a_sweep_is_flat() -> None:
    def pages() -> int:
        return int(Path("/proc/self/statm").read_text().split()[1])

    with Study(Path("results")) as study:
        taken = []
        for k, _ in enumerate(study.play(study.plan([TINY.replace(seeds=200)]))):
            if k in (200, 799):
                taken.append(pages())
    grown = (taken[1] - taken[0]) * os.sysconf("SC_PAGE_SIZE") / 600
    assert grown < 10_000, f"{grown} bytes a run"


def test_batch_run_gives_the_numbers_of_the_command_line() -> None:
    words = ["--densities", "6,10", "--seeds", "3", "--jobs", "1", "--quiet", "--no-figures"]
    assert invoke(["run", "fig-6.1c", *words]) == 0
    stored = {
        (row["n"], row["seed"], row["swarm"]): (row["pucks"], row["sud"], row["duration"])
        for row in pq.read_table("results/runs.parquet").to_pylist()
    }
    rows = mesa.batch_run(
        ForagingModel,
        {"policies": "avoid,attack", "n": [6, 10], "seed": [0, 1, 2]},
        number_processes=1,
        data_collection_period=-1,
        display_progress=False,
    )
    assert stored == {
        (row["n"], row["seed"], k): (row[f"pucks_{k}"], row[f"sud_{k}"], row["time"])
        for row in rows
        for k in (1, 2)
    }


def test_a_failure_is_kept_in_place_of_nothing_and_an_outcome_in_place_of_it(tmp_path: Path) -> None:
    (run,) = expand([TINY.replace(densities=(4,), seeds=1, conditions=TINY.conditions[:1])])
    with Ledger(tmp_path / FILE, new=True) as ledger:
        ledger.plan({}, {}, [run])
        assert ledger.outcome(run.digest) is None
        ledger.add(run, Failure("it broke"), 1.0, {}, "kswarms replay")
        assert ledger.outcome(run.digest) is None
        assert ledger.unfinished([run], []) == [run]
        outcome = play(run)
        ledger.add(run, outcome, 1.0, {}, "kswarms replay")
        assert ledger.outcome(run.digest) == (outcome.swarms, outcome.policies)
        assert ledger.unfinished([run], []) == []
        assert ledger.unfinished([run], ["robots"]) == [run]
