"""Runs played in this process, in worker processes and through executors: equal results, named failures."""

import gc
import os
import random
import signal
import subprocess
import sys
import time
import weakref
from contextlib import closing
from multiprocessing import active_children
from pathlib import Path

import mesa
import pytest

from kswarms.agents.common.columns import RECORDED_TABLES
from kswarms.model.game_model import GameModel
from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.runs import processes
from kswarms.scenarios.runs.errors import RunError
from kswarms.scenarios.runs.outcome import Failure
from kswarms.scenarios.runs.play import attempt, play
from kswarms.scenarios.runs.run import Run
from kswarms.scenarios.runs.sweep import play_all, sweep
from tests.helpers.short_runs import by_digest, failing_run, short_runs

IMPORTS = """
from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.runs.sweep import play_all
from kswarms.scenarios.runs.run import expand
"""
"""Start of the scripts of these tests."""


class Deadly(Run):
    """A run that kills the process that receives it."""

    effort = 1e9
    n = 0

    def __init__(self) -> None:
        super().__init__("dead", CATALOGUE["fig-6.1a"].game("", 6), 0, (("fig-0", ""),))

    def __reduce__(self) -> tuple[object, ...]:
        return os._exit, (1,)


# One run.


def test_an_outcome_has_a_row_for_each_swarm_and_the_requested_records() -> None:
    run = short_runs("fig-7.10", densities=(6,), seeds=1)[-1]
    assert run.labels == (("fig-7.10", "avoid"),)
    outcome = play(run, "robots,conflicts")
    assert [(row["swarm"], row["size"], row["policy"]) for row in outcome.swarms] == [
        (1, 2, "avoid"),
        (2, 3, "avoid"),
        (3, 1, "aggressive"),
    ]
    assert set(outcome.records) == {"robots", "conflicts"}
    assert outcome.policies == []
    assert play(run).records == {}


def test_an_outcome_has_what_each_swarm_learned_about_each_opponent() -> None:
    run = short_runs("fig-7.10", densities=(16,), seeds=1)[0]
    outcome = play(run, "robots")
    assert [(row["swarm"], row["opponent"], row["action"]) for row in outcome.policies] == [
        (2, opponent, action) for opponent in (1, 3) for action in ("flight", "fight")
    ]
    for opponent in (1, 3):
        flight, fight = (row for row in outcome.policies if row["opponent"] == opponent)
        assert flight["share"] + fight["share"] == 1
        assert flight["attack_share"] == fight["attack_share"] == fight["share"]
    assert [len(arms) for arms in outcome.records["robots"]["arms"]] == [0] * 4 + [4] * 8 + [0] * 4


def test_a_model_is_freed_after_its_run(monkeypatch: pytest.MonkeyPatch) -> None:
    models: list[weakref.ref[GameModel]] = []
    real = GameModel.play

    def observed_play(self: GameModel) -> None:
        models.append(weakref.ref(self))
        real(self)

    monkeypatch.setattr(GameModel, "play", observed_play)
    registered = len(mesa.Agent._ids)
    for run in short_runs("fig-6.1a", densities=(6,), seeds=2):
        play(run)
    assert len(mesa.Agent._ids) == registered
    gc.collect()
    assert [model() for model in models] == [None, None]


def test_a_worker_with_other_code_plays_nothing() -> None:
    (run,) = short_runs("fig-6.1a", densities=(6,), seeds=1)
    failure, seconds = attempt(run, "", "0.0.1 0123456789ab")
    assert isinstance(failure, Failure)
    assert failure.error.endswith(", it must have 0.0.1 0123456789ab")
    assert seconds == 0


# Many runs.


def test_seeds_give_different_outcomes_and_longer_runs_are_played_first() -> None:
    played = list(play_all(short_runs("fig-6.1a", densities=(6, 20, 10))))
    assert [run.n for run, _ in played] == [20, 20, 10, 10, 6, 6]
    assert played[0][1].swarms != played[1][1].swarms


def test_the_error_of_play_all_names_the_run() -> None:
    runs = short_runs("fig-6.15", densities=(6,), seeds=1)
    bad = [failing_run(run) for run in runs if run.labels[0][1] == "fight-1000ms"]
    with pytest.raises(RunError) as error:
        list(play_all(bad + runs))
    named = "run scenario='fig-6.15' condition='fight-1000ms' n=6 seed=-1 failed: "
    assert str(error.value).startswith(named + "InputError: seed=-1")
    assert "in finished_game\n" in error.value.trace


@pytest.mark.slow
def test_results_do_not_depend_on_workers_and_order(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(processes, "GAMES_PER_WORKER", 3)  # replace the workers during the sweep
    runs = short_runs("fig-6.1c") + short_runs("fig-6.4a", (6,)) + short_runs("fig-6.15", (7,), seeds=1)
    runs.append(failing_run(runs[0]))
    record = ",".join(RECORDED_TABLES)
    here = by_digest(sweep(runs, 1, record))
    there = by_digest(sweep(random.Random(3).sample(runs, len(runs)), 2, record))
    assert here.keys() == there.keys() == {run.digest for run in runs}
    assert repr(sorted(here.items())) == repr(sorted(there.items()))  # as text, since NaN is unequal to NaN
    assert active_children() == []


@pytest.mark.slow
def test_a_run_that_kills_its_worker_fails_after_retries_and_no_other_is_lost(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(processes, "MAX_DEATHS", 2)
    runs = short_runs("fig-6.1a", (6, 8, 10), seeds=1)
    results = by_digest(sweep([Deadly(), *runs], 2))
    assert results.pop("dead") == Failure("its worker process died 2 times: killed or out of memory?")
    assert results == by_digest(sweep(runs))
    assert active_children() == []


@pytest.mark.slow
def test_no_run_is_lost_when_a_worker_is_killed() -> None:
    runs = short_runs("fig-6.1a", seeds=30)
    results = {}
    with closing(sweep(runs, 2)) as played:
        for run, result, _ in played:
            results[run.digest] = result
            if len(results) == 10:
                os.kill(active_children()[0].pid or 0, signal.SIGKILL)
    assert results == by_digest(sweep(runs))


@pytest.mark.slow
def test_workers_ignore_ctrl_c_and_sighup_and_stop_when_the_sweep_is_closed() -> None:
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, [])
    (quick,) = short_runs("fig-6.1a", densities=(6,), seeds=1)
    endless = Run("endless", quick.game.replace(duration=1e6), 0, quick.labels)
    played = play_all([quick, endless], 2)
    assert next(played)[0] == quick
    assert signal.pthread_sigmask(signal.SIG_BLOCK, []) == mask
    children = active_children()
    assert len(children) == 2
    for worker in children:
        status = Path(f"/proc/{worker.pid}/status").read_text()
        blocked = int(status.partition("SigBlk:")[2].split()[0], 16)
        assert all(blocked >> (number - 1) & 1 for number in (signal.SIGINT, signal.SIGHUP))
    started = time.monotonic()
    played.close()
    assert active_children() == []
    assert time.monotonic() - started < 5


# Scripts.


@pytest.mark.slow
def test_a_script_without_a_main_guard_is_refused(tmp_path: Path) -> None:
    script = tmp_path / "unguarded.py"
    script.write_text(
        f"{IMPORTS}list(play_all(expand([CATALOGUE['fig-6.1a'].replace(densities=(6,), seeds=3)]), 2))\n"
    )
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 1
    reason = 'needs worker processes, and none started: is `if __name__ == "__main__"` missing?'
    assert done.stderr.splitlines()[-1].endswith(f"InputError: jobs=2: {reason}")


@pytest.mark.slow
def test_workers_exit_when_their_parent_is_killed(tmp_path: Path) -> None:
    script = tmp_path / "parent.py"
    script.write_text(
        f"{IMPORTS}from multiprocessing import active_children\n"
        "if __name__ == '__main__':\n"
        "    runs = expand([CATALOGUE['fig-6.2'].replace(densities=(50,), seeds=50)])\n"
        "    for _ in play_all(runs, 2):\n"
        "        print(*(child.pid for child in active_children()), flush=True)\n"
    )
    with subprocess.Popen([sys.executable, script], stdout=subprocess.PIPE, text=True) as parent:
        assert parent.stdout is not None
        workers = [int(word) for word in parent.stdout.readline().split()]
        assert workers
        parent.kill()
    deadline = time.monotonic() + 10
    while any(is_alive(worker) for worker in workers):
        assert time.monotonic() < deadline, "workers outlive their parent"
        time.sleep(0.05)


def is_alive(process: int) -> bool:
    """Return whether a process runs; a zombie does not."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except (ProcessLookupError, FileNotFoundError):
        return False
