"""The benchmarks with tiny games: their functions run, and missing work is an error; times are not judged."""

import subprocess
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

import numba
import numpy as np
import pyarrow.parquet as pq
import pytest

from benchmarks import bench, games, peer_worlds, peers, profile
from benchmarks import report as report_benchmark
from benchmarks.games import Plan, WorkError, count_work, time_game
from kswarms.agents.common.columns import column_names
from kswarms.analysis.results.runs import read_policies
from kswarms.model.game_model import GameModel
from kswarms.scenarios.catalogue import CATALOGUE

TINY = Plan("avoid,attack", 6, 30.0)


def test_work_depends_on_the_seed() -> None:
    assert count_work(TINY, 1) == count_work(TINY, 1)
    assert count_work(TINY, 1) != count_work(TINY, 2)


def test_processed_events_are_counted() -> None:
    work = count_work(TINY, 1)
    assert 0 < work.conflicts <= work.timeouts < work.events < work.scheduled


def test_bare_loops_have_the_events_of_the_reference_commit() -> None:
    plan, learning = Plan("avoid,attack", 50), Plan("attack,inter-learner", 50, learning=3000.0)
    work = count_work(TINY, 1)
    means = [
        sum(games.reference_events(game, seed, work) for seed in range(5)) / 5 for game in (plan, learning)
    ]
    assert means == [40198.4, 270757.2]
    assert games.reference_events(TINY, 1, work) == games.reference_events(plan, 5, work) == work.events


def test_the_cost_of_the_catalogue_is_estimated_from_a_sample(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bench, "CATALOGUE", {"fig-6.1a": CATALOGUE["fig-6.1a"]})
    monkeypatch.setattr(bench, "attempt", lambda run, *_: (None, 2 * run.effort))
    runs = bench.expand([CATALOGUE["fig-6.1a"]])
    hours = 2 * sum(run.effort for run in runs) / 3600
    assert bench.catalogue_hours(3) == [str(len(runs)), "3", f"{hours:.2f}", "0.00"]


def test_timing_a_game_returns_positive_times() -> None:
    assert min(time_game(TINY, 1, count_work(TINY, 1))) > 0


def test_an_incomplete_game_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    work = count_work(TINY, 1)
    monkeypatch.setattr(GameModel, "play", lambda model: model.env.run(until=150))
    with pytest.raises(WorkError, match="counted"):
        time_game(TINY, 1, work)
    with pytest.raises(WorkError, match=r"90\.0 robot-seconds played, not 180\.0"):
        count_work(TINY, 1)


def test_a_game_without_conflicts_is_an_error() -> None:
    with pytest.raises(WorkError, match="too few events"):
        count_work(Plan("avoid", 1, 30.0), 1)


def test_the_bare_loop_processes_the_given_number_of_timeouts(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[Any] = []
    timeout = games.simpy.Environment.timeout
    monkeypatch.setattr(games.simpy.Environment, "timeout", lambda env, t: made.append(t) or timeout(env, t))
    assert games.time_bare_loop(6, 100) > 0
    assert len(made) == 100


def test_phases_are_those_of_the_call_stack() -> None:
    game = [("kswarms.model.game_model", "_decide"), ("kswarms.model.game_model", "_move"), ("m", "play")]
    simpy = [("simpy.core", "step"), ("simpy.core", "run"), ("m", "play")]
    krembot = "kswarms.agents.robot.krembot"
    assert [
        profile.phase_of(stack)
        for stack in (
            [("kswarms.agents.policies.spec", "parse"), ("m", "model")],
            simpy,
            [("simpy.events", "__init__"), (krembot, "meet"), *game],
            [("kswarms.agents.learning.bandit", "choose"), (krembot, "meet"), *game],
            game,
            [(krembot, "_set"), (krembot, "begin_leg"), *game],
            [(krembot, "_set"), (krembot, "_leg_over"), *simpy],
            game[1:],
        )
    ] == [
        "set-up",
        "SimPy: loop",
        "SimPy: calls by robots",
        "learning and policies",
        "decision: dispatch",
        "decision: begin_leg",
        "timeout: leg_over",
        "kernel",
    ]


def test_samples_are_taken_while_a_game_is_played() -> None:
    *rows, total = profile.phases(TINY, [0, 1], 0.1)
    assert total[0] == "sum"
    assert sum(float(share) for *_, share in rows) == pytest.approx(100.0, abs=1.0)


class Box(NamedTuple):
    """A tuple of arrays."""

    values: np.ndarray


@numba.njit(_nrt=False)
def add(box: Box, k: int) -> None:
    for i in range(len(box.values)):
        box.values[i] += k


@numba.njit(_nrt=False)
def double(x: float) -> float:
    return 2.0 * x


@numba.njit(_nrt=False)
def add_twice(box: Box) -> float:
    add(box, 1)
    add(box, 2)
    return double(box.values[0])


def test_cycles_of_functions_that_take_arrays_are_counted() -> None:
    counter = profile.CycleCounter(add_twice, {Box})
    box = Box(np.zeros(100))
    assert counter.function(box) == 6.0
    assert [name.rpartition(".")[2] for name in counter.names] == ["add"]
    assert (counter.calls[0], counter.cycles[0] > 0) == (2, True)


def test_main_prints_all_tables(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    real = bench.overhead
    # New processes would take seconds.
    monkeypatch.setattr(bench, "peak_memory", lambda code: float(len(code)))
    monkeypatch.setattr(bench, "seconds_to_game", float)
    monkeypatch.setattr(bench, "overhead", lambda runs, _jobs: real(runs, 1))
    monkeypatch.setattr(bench, "attempt", lambda run, *_: (None, run.effort))
    bench.main(seeds=1, repetitions=1, duration=60.0, sizes=(6, 24), sample=3, runs=20)
    printed = capsys.readouterr().out
    assert printed.count("  bound") == 7
    ((n, side, *_),) = [line.split() for line in printed.splitlines() if line.startswith("  24 ")]
    assert (n, side) == ("24", "4.0")  # four times as many robots on four times the area


def test_missing_rows_of_a_study_are_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bench.pq, "read_metadata", lambda _path: SimpleNamespace(num_rows=39))
    with pytest.raises(WorkError, match="39 rows stored of 20 runs"):
        bench.overhead(20, 1)


@pytest.mark.slow
def test_memory_and_start_up_of_new_processes() -> None:
    code = "from kswarms import ForagingModel\nForagingModel(n=2, record='', duration=1.0).play()"
    assert bench.peak_memory("pass") < bench.peak_memory(code) < 2000
    assert bench.seconds_to_game(6) > 0


def test_a_random_study_has_the_columns_of_a_real_one(tmp_path: Path) -> None:
    scenarios = [CATALOGUE[name] for name in ("fig-6.8", "fig-7.10", "fig-6.15")]
    rows = report_benchmark.write_study(tmp_path, scenarios, densities=1, seeds=2)
    assert rows == 2 * (2 + 5 * 3 + 5)
    for name in ("runs", "policies"):
        assert tuple(pq.read_schema(tmp_path / f"{name}.parquet").names) == column_names(name)
    learned = read_policies(tmp_path)
    assert set(zip(learned["scenario"], learned["swarm"], learned["opponent"], strict=True)) == {
        *(("fig-6.8", 2, opponent) for opponent in (1, 2)),
        *(("fig-7.10", 2, opponent) for opponent in (1, 3)),
        ("fig-6.15", 1, 1),
    }


def test_the_report_benchmark_fails_above_a_bound(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def run(words: list[str], **_: object) -> subprocess.CompletedProcess[str]:
        (Path(words[-1]) / "report.html").write_text("page")
        return subprocess.CompletedProcess(words, 0, "report: page\n320.5\n")

    monkeypatch.setattr(report_benchmark, "write_study", lambda directory: 7)
    monkeypatch.setattr(subprocess, "run", run)
    assert report_benchmark.main() == 0
    assert "rows of runs 7; 0 s (at most 120); 320 MB" in capsys.readouterr().out
    monkeypatch.setattr(report_benchmark, "MAX_MEMORY", 300)
    assert report_benchmark.main() == 1


def test_peers_are_installed_and_measured_in_turn(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    commands: list[list[str]] = []

    def run(words: list[Any], **_: object) -> subprocess.CompletedProcess[str]:
        commands.append([str(word) for word in words])
        return subprocess.CompletedProcess(words, 0, f"{1000.0 * len(commands)}\n")

    monkeypatch.setattr(subprocess, "run", run)
    monkeypatch.setattr(peers.venv, "create", lambda *_args, **_options: None)
    monkeypatch.setattr(peers, "find_spec", lambda _name: None)
    peers.main(tmp_path, rounds=3)
    assert set(peers.PACKAGES) < set(commands[0])
    assert [words[-2] for words in commands[1:]] == 3 * [name for name in peers.PEERS if name != "vmas"]
    printed = capsys.readouterr().out
    (row,) = [line for line in printed.splitlines() if line.startswith("  mesa  ")]
    assert row.split() == ["mesa", "9,000", "1.29"]  # medians of the second round: 9,000 / 7,000
    assert "vmas: not measured" in printed


def test_every_peer_has_a_world() -> None:
    assert set(peers.PEERS) == set(peer_worlds.WORLDS)
    assert peer_worlds.throughput("simpy", 0.0) > 0
