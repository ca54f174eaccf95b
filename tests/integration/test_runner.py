"""Runs played here and in worker processes: same outcomes, failures with names, nothing left behind."""

import gc
import os
import random
import signal
import subprocess
import sys
import time
import weakref
from collections.abc import Iterable
from concurrent.futures import BrokenExecutor, Future, ThreadPoolExecutor
from contextlib import closing
from multiprocessing import active_children
from pathlib import Path

import mesa
import pytest

from kswarms.agents.common.columns import RECORDED_TABLES
from kswarms.model.game_model import GameModel
from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.runs import processes as workers
from kswarms.scenarios.runs.outcome import Failure, Outcome, RunError
from kswarms.scenarios.runs.play import attempt, play
from kswarms.scenarios.runs.run import Run, expand
from kswarms.scenarios.runs.sweep import play_all, sweep

IMPORTS = """
from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.runs.sweep import play_all
from kswarms.scenarios.runs.run import expand
"""
"""With which the scripts of these tests begin."""


def short(name: str, densities: tuple[int, ...] = (6, 10), seeds: int = 2) -> list[Run]:
    """Return runs of a scenario with games of 20 s, after as much learning if there is any."""
    scenario = CATALOGUE[name].replace(densities=densities, seeds=seeds)
    conditions = tuple(
        condition.replace(duration=20.0, learning=min(20.0, condition.learning))
        for condition in scenario.conditions
    )
    return expand([scenario.replace(conditions=conditions)])


def by_name(played: Iterable[tuple[Run, Outcome]]) -> dict[str, Outcome]:
    return {run.digest: outcome for run, outcome in played}


class Deadly(Run):
    """A run that kills the process that receives it."""

    effort = 1e9
    n = 0

    def __init__(self) -> None:
        super().__init__("dead", None, 0, (("fig-0", ""),))

    def __reduce__(self) -> tuple[object, ...]:
        return os._exit, (1,)


@pytest.mark.slow
def test_workers_and_order_do_not_matter(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(workers, "GAMES_PER_WORKER", 3)  # so that workers are replaced on the way
    runs = short("fig-6.1c") + short("fig-6.4a", (6,)) + short("fig-6.15", (7,), seeds=1)
    record = ",".join(RECORDED_TABLES)
    here = by_name(play_all(runs, 1, record))
    shuffled = random.Random(3).sample(runs, len(runs))
    there = by_name(play_all(shuffled, 2, record))
    assert here.keys() == there.keys() == {run.digest for run in runs}
    # As text: a reward that is not known is NaN, which equals nothing.
    assert repr(sorted(here.items())) == repr(sorted(there.items()))
    assert active_children() == []


def test_other_seeds_give_other_outcomes() -> None:
    first, second = short("fig-6.1c", densities=(10,))
    assert play(first).swarms != play(second).swarms


def test_the_longest_runs_come_first() -> None:
    runs = short("fig-6.1a", densities=(6, 20, 10), seeds=1)
    assert [run.n for run, _ in play_all(runs)] == [20, 10, 6]


def test_an_outcome_has_a_row_for_each_swarm_and_the_records_asked_for() -> None:
    run = short("fig-7.10", densities=(6,), seeds=1)[-1]
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


def test_an_outcome_says_what_was_learned_of_whom() -> None:
    run = short("fig-7.10", densities=(16,), seeds=1)[0]
    outcome = play(run, "robots")
    assert [(row["swarm"], row["opponent"], row["action"]) for row in outcome.policies] == [
        (2, 1, "flight"),
        (2, 1, "fight"),
        (2, 3, "flight"),
        (2, 3, "fight"),
    ]
    for opponent in (1, 3):
        flight, fight = (row for row in outcome.policies if row["opponent"] == opponent)
        assert flight["share"] + fight["share"] == 1
        assert flight["attack_share"] == fight["attack_share"] == fight["share"]
    arms = outcome.records["robots"]["arms"]
    assert [len(of_robot) for of_robot in arms] == [0] * 4 + [4] * 8 + [0] * 4


def test_a_model_is_freed_after_its_run(monkeypatch: pytest.MonkeyPatch) -> None:
    models: list[weakref.ref[GameModel]] = []
    real = GameModel.play

    def watched(self: GameModel) -> None:
        models.append(weakref.ref(self))
        real(self)

    monkeypatch.setattr(GameModel, "play", watched)
    kept_by_mesa = len(mesa.Agent._ids)
    for run in short("fig-6.1a", densities=(6,), seeds=2):
        play(run)
    assert len(mesa.Agent._ids) == kept_by_mesa
    gc.collect()
    assert [model() for model in models] == [None, None]


@pytest.mark.parametrize("jobs", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_a_failing_run_is_named(jobs: int) -> None:
    good = short("fig-6.15", densities=(6,), seeds=1)
    bad = [Run("bad", run.game, -1, run.labels) for run in good if run.labels[0][1] == "fight-1000ms"]
    with pytest.raises(RunError) as failure:
        list(play_all(bad + good, jobs))
    named = "run scenario='fig-6.15' condition='fight-1000ms' n=6 seed=-1 failed: "
    assert str(failure.value).startswith(named + "InputError: seed=-1")
    assert "in finished_game\n" in failure.value.trace
    assert active_children() == []


@pytest.mark.slow
def test_a_run_that_kills_its_worker_is_tried_again_and_then_failed_and_no_other_is_lost() -> None:
    runs = short("fig-6.1a", seeds=5)
    came = {run.digest: result for run, result, _ in sweep([Deadly(), *runs], 2)}
    failure = came.pop("dead")
    assert failure == Failure("its worker process died 3 times: killed or out of memory?")
    assert came == by_name(play_all(runs))
    assert active_children() == []


@pytest.mark.slow
def test_a_worker_that_is_killed_loses_nothing() -> None:
    runs = short("fig-6.1a", seeds=30)
    came = {}
    with closing(sweep(runs, 2)) as played:
        for run, result, _ in played:
            came[run.digest] = result
            if len(came) == 10:
                os.kill(active_children()[0].pid or 0, signal.SIGKILL)
    assert came == by_name(play_all(runs))


@pytest.mark.slow
def test_ctrl_c_is_left_to_the_parent() -> None:
    mask_before = signal.pthread_sigmask(signal.SIG_BLOCK, [])
    with closing(play_all(short("fig-6.1a", seeds=8), 2)) as played:
        next(played)
        children = active_children()
        assert len(children) == 2
        for worker in children:
            status = Path(f"/proc/{worker.pid}/status").read_text()
            blocked = int(status.partition("SigBlk:")[2].split()[0], 16)
            assert blocked >> (signal.SIGINT - 1) & 1
    assert signal.pthread_sigmask(signal.SIG_BLOCK, []) == mask_before


@pytest.mark.slow
def test_whoever_stops_listening_stops_the_workers() -> None:
    (quick,) = short("fig-6.1a", densities=(6,), seeds=1)
    endless = Run("endless", quick.game.replace(duration=1e6), 0, quick.labels)
    played = play_all([quick, endless], 2)
    assert next(played)[0] == quick
    started = time.monotonic()
    played.close()
    assert active_children() == []
    assert time.monotonic() - started < 5


@pytest.mark.slow
def test_a_script_that_each_worker_would_run_anew_is_told_so(tmp_path: Path) -> None:
    script = tmp_path / "unguarded.py"
    script.write_text(
        f"{IMPORTS}list(play_all(expand([CATALOGUE['fig-6.1a'].replace(densities=(6,), seeds=3)]), 2))\n"
    )
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 1
    *_, last = done.stderr.splitlines()
    assert last.endswith(
        'jobs=2: needs worker processes, and none started: is `if __name__ == "__main__"` missing?'
    )


@pytest.mark.slow
def test_workers_end_with_their_parent_even_if_it_is_killed(tmp_path: Path) -> None:
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
    while any(alive(worker) for worker in workers):
        assert time.monotonic() < deadline, "workers outlive their parent"
        time.sleep(0.05)


def alive(process: int) -> bool:
    """Tell whether a process runs; one that has ended and waits to be collected does not."""
    try:
        os.kill(process, 0)
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except (ProcessLookupError, FileNotFoundError):
        return False


@pytest.mark.slow
def test_any_executor_plays_and_a_failure_does_not_end_the_sweep() -> None:
    runs = short("fig-6.1a", densities=(6,), seeds=4)
    bad = Run("bad", runs[0].game, -1, runs[0].labels)
    with ThreadPoolExecutor(1) as executor:
        came = {run.digest: result for run, result, _ in sweep([bad, *runs], executor=executor)}
    failure = came.pop("bad")
    assert isinstance(failure, Failure)
    assert failure.error.startswith("InputError: seed=-1")
    assert failure.trace.startswith("Traceback")
    assert came == by_name(play_all(runs))


def test_an_executor_that_gives_up_ends_the_sweep() -> None:
    class Gone(ThreadPoolExecutor):
        def submit(self, *_arguments: object, **_options: object) -> Future[object]:
            future: Future[object] = Future()
            future.cancel()
            future.set_running_or_notify_cancel()
            return future

    class Broken(ThreadPoolExecutor):
        def submit(self, *_arguments: object, **_options: object) -> Future[object]:
            raise BrokenExecutor

    for kind in (Gone, Broken):
        with kind(1) as executor, pytest.raises(RunError, match="all workers exited"):
            list(sweep(short("fig-6.1a"), executor=executor))


def test_what_cannot_be_sent_back_is_a_failure() -> None:
    class Broken(ThreadPoolExecutor):
        def submit(self, *_arguments: object, **_options: object) -> Future[object]:
            future: Future[object] = Future()
            future.set_exception(TypeError("cannot pickle"))
            return future

    with Broken(1) as executor:
        ((_, failure, _),) = sweep(short("fig-6.1a", densities=(6,), seeds=1), executor=executor)
    assert isinstance(failure, Failure)
    assert failure.error == "TypeError: cannot pickle"


def test_a_worker_of_other_code_plays_nothing() -> None:
    (run,) = short("fig-6.1a", densities=(6,), seeds=1)
    failure, seconds = attempt(run, "", "0.0.1 0123456789ab")
    assert isinstance(failure, Failure)
    assert failure.error.endswith(", it must have 0.0.1 0123456789ab")
    assert seconds == 0
