"""Studies on a Dask cluster of two processes: the same tables as with local workers, and no lost runs."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest
from distributed import Client, LocalCluster

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.cli import invoke
from kswarms.scenarios.description.condition import Condition, SwarmRule
from kswarms.scenarios.description.scenario import Scenario
from kswarms.scenarios.runs.dask import dask_executor
from kswarms.scenarios.runs.run import expand
from kswarms.scenarios.runs.sweep import play_all, sweep

SMALL = Scenario(
    id="small",
    title="Games of ten seconds",
    densities=(6, 10),
    seeds=15,
    conditions=(
        Condition(
            swarms=(SwarmRule(policy="avoid"), SwarmRule(policy="inter-learner")),
            learning=10.0,
            duration=10.0,
        ),
    ),
)
TABLES = ("runs.parquet", "policies.parquet", "conflicts.parquet")

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def cluster() -> Iterator[LocalCluster]:
    """Two workers of one thread each, restarted when they die."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONPATH", os.pathsep.join(path or str(Path.cwd()) for path in sys.path))
        with LocalCluster(2, threads_per_worker=1, dashboard_address=":0") as started:
            yield started


@pytest.mark.usefixtures("empty_directory")
def test_one_worker_two_and_a_cluster_write_the_same_tables(cluster: LocalCluster) -> None:
    Path("small.toml").write_text(SMALL.to_toml())
    words = ["run", "small.toml", "--quiet", "--no-figures", "--record", "conflicts"]
    places = {
        "1": ["--jobs", "1"],
        "2": ["--jobs", "2"],
        "dask": ["--scheduler", cluster.scheduler_address],
    }
    for name, place in places.items():
        assert invoke([*words, *place, "--out", name]) == 0
    written = {name: [Path(name, table).read_bytes() for table in TABLES] for name in places}
    assert all(tables == written["1"] for tables in written.values())


def test_no_run_is_lost_when_a_worker_of_the_cluster_is_killed(cluster: LocalCluster) -> None:
    condition = SMALL.conditions[0].replace(duration=200.0)
    runs = expand([SMALL.replace(densities=(30,), seeds=30, conditions=(condition,))])
    results = {}
    with (
        Client(cluster) as client,
        dask_executor(cluster.scheduler_address) as executor,
        closing(sweep(runs, executor=executor)) as played,
    ):
        cluster.wait_for_workers(2)
        victim = next(iter(client.run(os.getpid).values()))
        for run, result, _ in played:
            results[run.digest] = result
            if len(results) == 3:
                os.kill(victim, signal.SIGKILL)
        cluster.wait_for_workers(2)
        assert victim not in client.run(os.getpid).values()
    assert results == {run.digest: outcome for run, outcome in play_all(runs)}


def wait_until(condition: Callable[[], bool], complaint: str) -> None:
    deadline = time.monotonic() + 10
    while not condition():
        assert time.monotonic() < deadline, complaint
        time.sleep(0.05)


def test_closing_a_sweep_removes_its_tasks_from_the_cluster(cluster: LocalCluster) -> None:
    def tasks(dask_scheduler: Any) -> int:
        return len(dask_scheduler.tasks)

    with Client(cluster) as client:
        with dask_executor(cluster.scheduler_address) as executor:
            played = sweep(expand([SMALL.replace(densities=(40, 50), seeds=100)]), executor=executor)
            next(played)
            wait_until(lambda: client.run_on_scheduler(tasks) > 30, "few tasks are on their way")
            played.close()
        wait_until(lambda: client.run_on_scheduler(tasks) == 0, "tasks are left")


@pytest.mark.usefixtures("empty_directory")
def test_sigterm_ends_a_sweep_on_a_cluster_and_keeps_finished_runs(cluster: LocalCluster) -> None:
    def tasks(dask_scheduler: Any) -> int:
        return len(dask_scheduler.tasks)

    words = ["run", "fig-6.2", "--densities", "50", "--seeds", "500", "--no-figures", "--progress", "json"]
    command = [sys.executable, "-m", "kswarms.scenarios.cli", *words]
    command += ["--scheduler", cluster.scheduler_address]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        assert json.loads(process.stderr.readline())["done"] == 1
        process.send_signal(signal.SIGTERM)
        err = process.communicate(timeout=30)[1]
    assert process.returncode == 143
    assert err.splitlines()[-1] == "kswarms: interrupted by SIGTERM"
    assert "Traceback" not in err
    assert 1 <= len(pq.read_table("results/runs.parquet")) / 2 < 500
    with Client(cluster) as client:
        wait_until(lambda: client.run_on_scheduler(tasks) == 0, "tasks are left")


def test_a_cluster_needs_dask_and_a_scheduler_that_answers(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("kswarms.scenarios.runs.dask._TIMEOUT", 1)
    with (
        pytest.raises(InputError, match="must be the address of a Dask scheduler"),
        dask_executor("tcp://127.0.0.1:1"),
    ):
        pass
    monkeypatch.setitem(sys.modules, "distributed", None)
    with (
        pytest.raises(InputError, match=r"needs Dask: pip install 'kswarms\[cluster\]'"),
        dask_executor("tcp://x:1"),
    ):
        pass
