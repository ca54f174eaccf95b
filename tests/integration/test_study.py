"""What a study plays, what it plays again, and what it tells of both."""

import json
import os
import shlex
from collections.abc import Callable
from pathlib import Path

import mesa
import pyarrow.parquet as pq
import pytest

from kswarms import __version__
from kswarms.model.foraging import ForagingModel
from kswarms.model.game_model import GameModel
from kswarms.scenarios.cli import invoke
from kswarms.scenarios.runs.outcome import Failure
from kswarms.scenarios.runs.play import play
from kswarms.scenarios.runs.run import expand
from kswarms.scenarios.study.database import LEDGER_FILE
from kswarms.scenarios.study.ledger import Ledger
from kswarms.scenarios.study.study import Study
from kswarms.scenarios.watch.recorded_run import recorded_run
from tests.helpers.tiny_study import RUN, TINY, Fault, sessions

pytestmark = pytest.mark.usefixtures("with_a_file_of_scenarios")


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


def test_a_run_that_fails_when_it_is_played_again_for_a_record_keeps_what_it_came_to(
    break_games: Callable[[Fault], None], capsys: pytest.CaptureFixture[str]
) -> None:
    def fault(model: GameModel) -> None:
        if model.game.size == 6:
            raise MemoryError("too much to record")

    plain = RUN[: RUN.index("--record")]
    assert invoke([*plain, "--seeds", "1"]) == 0
    before = Path("results/runs.parquet").read_bytes()
    break_games(fault)
    capsys.readouterr()
    assert invoke([*RUN, "--seeds", "1"]) == 1
    assert "2 of 4 runs failed" in capsys.readouterr().err
    assert Path("results/runs.parquet").read_bytes() == before
    assert invoke(["status", "results"]) == 0
    assert "MemoryError: too much to record" in capsys.readouterr().out


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
        with Ledger(Path("my results", LEDGER_FILE)) as ledger:
            ((trace,),) = ledger.query("SELECT traceback FROM runs WHERE status = 'failed' AND seed = 0")
        replay = lines[failed + 3].removeprefix("  again: ")
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
    run = recorded_run(Path("results"), name)
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
    assert manifest["kswarms"] == __version__
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
    with Ledger(tmp_path / LEDGER_FILE, new=True) as ledger:
        ledger.plan({}, {}, [run])
        assert ledger.outcome(run.digest) is None
        ledger.add(run, Failure("it broke"), 1.0)
        assert ledger.outcome(run.digest) is None
        assert ledger.unfinished([run], []) == [run]
        outcome = play(run)
        ledger.add(run, outcome, 1.0)
        assert ledger.outcome(run.digest) == (outcome.swarms, outcome.policies)
        assert ledger.unfinished([run], []) == []
        assert ledger.unfinished([run], ["robots"]) == [run]
