"""Studies: runs that are played, replayed and stored; their status and manifest."""

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
from kswarms.scenarios.description.scenario import Scenario
from kswarms.scenarios.runs.outcome import Failure
from kswarms.scenarios.runs.play import play
from kswarms.scenarios.runs.run import expand
from kswarms.scenarios.study.database import LEDGER_FILE
from kswarms.scenarios.study.ledger import Ledger
from kswarms.scenarios.study.study import Study
from kswarms.scenarios.watch.recorded_run import recorded_run
from tests.helpers.tiny_study import PLAIN_RUN, RUN, TINY, Fault, read_sessions

pytestmark = pytest.mark.usefixtures("tiny_file")


def test_runs_that_two_figures_share_are_played_once_even_in_two_sessions(
    before_games: Callable[[Fault], None],
) -> None:
    games = []
    before_games(lambda model: games.append(model.game.size))
    other = TINY.replace(id="other", densities=(6, 8), seeds=3)
    with Study(Path("results")) as study:
        list(study.play(study.plan([TINY.replace(seeds=2), other])))
    assert len(games) == 2 * (2 + 3 + 3)  # two curves: N = 4 of TINY, 6 of both, 8 of the other
    with Study(Path("results")) as study:
        assert study.plan([TINY.replace(seeds=2), other, other.replace(id="third")]) == []
    rows = pq.read_table("results/runs.parquet").to_pylist()
    runs = [{row["run"] for row in rows if row["scenario"] == name} for name in ("other", "third")]
    assert runs[0] == runs[1]


def test_a_run_without_a_requested_record_is_played_again(before_games: Callable[[Fault], None]) -> None:
    assert invoke([*PLAIN_RUN, "--seeds", "1"]) == 0
    games = []
    before_games(lambda model: games.append(model.game.size))
    assert invoke([*RUN, "--seeds", "2"]) == 0
    assert len(games) == 8
    assert invoke([*PLAIN_RUN, "--seeds", "2"]) == 0
    assert len(games) == 8
    assert pq.read_table("results/robots.parquet").num_rows == 2 * 2 * (4 + 6)


def test_a_finished_run_keeps_its_results_when_playing_it_again_fails(
    before_games: Callable[[Fault], None], capsys: pytest.CaptureFixture[str]
) -> None:
    def fault(model: GameModel) -> None:
        if model.game.size == 6:
            raise MemoryError("too much to record")

    assert invoke([*PLAIN_RUN, "--seeds", "1"]) == 0
    before = Path("results/runs.parquet").read_bytes()
    before_games(fault)
    capsys.readouterr()
    assert invoke([*RUN, "--seeds", "1"]) == 1
    assert "2 of 4 runs failed" in capsys.readouterr().err
    assert Path("results/runs.parquet").read_bytes() == before
    assert invoke(["status", "results"]) == 0
    assert "MemoryError: too much to record" in capsys.readouterr().out


def test_status_shows_failed_runs_and_the_commands_that_replay_them(
    before_games: Callable[[Fault], None], capsys: pytest.CaptureFixture[str]
) -> None:
    def fault(model: GameModel) -> None:
        if model.game.size == 6 and model.game.learning:
            raise ZeroDivisionError("no robot\nis left")

    words = ["run", "tiny.toml", "--seeds", "2", "--jobs", "1", "--no-figures", "--out", "my results"]
    before_games(fault)
    assert invoke(words) == 1
    printed = capsys.readouterr()
    summary = "kswarms: 2 of 8 runs failed; see `kswarms status 'my results'`"
    assert printed.err.splitlines()[-1] == summary
    assert printed.out.splitlines()[-1].startswith("next:   kswarms status 'my results'")
    assert pq.read_table("my results/runs.parquet").num_rows == 2 * 6

    assert invoke(["status", "my results"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[1].split()[:4] == ["tiny", "6", "2", "0"]
    assert lines[2].split()[:5] == ["unique", "runs", "6", "2", "0"]
    failed = lines.index("failed: tiny learner, n=6, seed=0: ZeroDivisionError: no robot is left")
    assert lines[failed + 2] == '  raise ZeroDivisionError("no robot\\nis left")'
    again, command = lines[failed + 3].split(": ")
    assert again == "  again"
    program, *replay = shlex.split(command)
    assert program == "kswarms"
    assert invoke(replay) == 1
    assert capsys.readouterr().err.splitlines()[-1].endswith("ZeroDivisionError: no robot is left")

    before_games(lambda model: None)
    assert invoke(words) == 0
    assert read_sessions("my results")[-1]["runs"] == {"requested": 8, "done before": 6}
    capsys.readouterr()
    assert invoke(replay) == 0
    assert capsys.readouterr().out.splitlines()[-1] == "equal to the results in my results"
    assert pq.read_table("my results/runs.parquet").num_rows == 2 * 8


def test_replay_reports_results_that_differ_or_are_missing(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke([*RUN, "--seeds", "1"]) == 0
    name = pq.read_table("results/runs.parquet")["run"][0].as_py()
    run = recorded_run(Path("results"), name)
    assert run == next(each for each in expand([TINY]) if each.digest == name)
    real = GameModel.results
    monkeypatch.setattr(GameModel, "results", lambda model: [row | {"pucks": 99} for row in real(model)])
    capsys.readouterr()
    assert invoke(["replay", "results", name]) == 1
    printed = capsys.readouterr()
    assert printed.err.startswith("kswarms: results has ")
    assert "pucks=99" in printed.out
    with Study(Path("results")) as study:
        (missing,) = study.plan([TINY.replace(densities=(8,), seeds=1, conditions=TINY.conditions[:1])])
    assert invoke(["replay", "results", missing.digest]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == "results has no results of this run"
    assert invoke(["replay", "results", "0" * 16]) == 2
    assert capsys.readouterr().err.startswith(f"kswarms: run='{'0' * 16}': must be a run of results: see ")


def test_a_study_in_which_every_run_failed_has_no_tables(before_games: Callable[[Fault], None]) -> None:
    def fault(model: GameModel) -> None:
        raise MemoryError

    before_games(fault)
    assert invoke(["run", "tiny.toml", "--seeds", "1", "--jobs", "1"]) == 1
    assert not list(Path("results").glob("*.parquet"))


def test_status_counts_missing_runs(capsys: pytest.CaptureFixture[str]) -> None:
    with Study(Path("results")) as study:
        for k, _ in enumerate(study.play(study.plan([TINY]))):
            if k == 9:
                break
    assert invoke(["status", "results"]) == 0
    assert capsys.readouterr().out.splitlines()[1].split()[:4] == ["tiny", "10", "0", "30"]
    assert pq.read_table("results/runs.parquet").num_rows == 20


def test_the_manifest_describes_the_origin_of_the_results() -> None:
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


def test_values_of_a_grid_are_columns_beside_n_and_seed() -> None:
    few = {"id": "gridded", "title": "A grid", "densities": (4,), "seeds": 1, "grid": {"side": (2.0, 3.0)}}
    with Study(Path("results")) as study:
        scenarios = [Scenario(**few, conditions=TINY.conditions), TINY.replace(seeds=1, densities=(4,))]
        list(study.play(study.plan(scenarios)))
    for table in ("runs", "policies"):
        rows = pq.read_table(f"results/{table}.parquet").to_pylist()
        assert {(row["scenario"], row["side"]) for row in rows} == {
            ("gridded", 2.0),
            ("gridded", 3.0),
            ("tiny", None),
        }


@pytest.mark.slow
def test_the_memory_of_a_sweep_does_not_grow() -> None:
    def pages() -> int:
        return int(Path("/proc/self/statm").read_text().split()[1])

    with Study(Path("results")) as study:
        memory = []
        for k, _ in enumerate(study.play(study.plan([TINY.replace(seeds=200)]))):
            if k in (200, 799):
                memory.append(pages())
    growth = (memory[1] - memory[0]) * os.sysconf("SC_PAGE_SIZE") / 600
    assert growth < 10_000, f"{growth} bytes per run"


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


def test_an_outcome_replaces_a_failure(tmp_path: Path) -> None:
    (run,) = expand([TINY.replace(densities=(4,), seeds=1, conditions=TINY.conditions[:1])])
    with Ledger(tmp_path / LEDGER_FILE, create=True) as ledger:
        ledger.plan({}, {}, [run])
        assert ledger.outcome(run.digest) is None
        ledger.add(run, Failure("it broke"), 1.0, {})
        assert ledger.outcome(run.digest) is None
        assert ledger.unfinished([run], []) == [run]
        outcome = play(run)
        ledger.add(run, outcome, 1.0, {})
        assert ledger.outcome(run.digest) == (outcome.swarms, outcome.policies)
        assert ledger.unfinished([run], []) == []
        assert ledger.unfinished([run], ["robots"]) == [run]


def test_a_network_file_system_is_reported_before_the_games(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for module in ("cli.playing", "study.database"):
        monkeypatch.setattr(f"kswarms.scenarios.{module}.network_file_system", lambda _: "nfs4")
    assert invoke([*RUN, "--seeds", "1"]) == 0
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("kswarms: results is on a network file system (nfs4), which can damage a ledger; ")
    assert invoke(["status", "results"]) == 0
