"""Estimated disk space of recorded trajectories."""

import shutil
from collections import namedtuple
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.cli import invoke, space
from kswarms.scenarios.cli.space import describe_trajectories, trajectory_size
from kswarms.scenarios.runs.run import expand

SCENARIO = CATALOGUE["fig-6.1c"].replace(densities=(6,), seeds=1)
WORDS = ["run", "fig-6.1c", "--densities", "6", "--seeds", "1", "--jobs", "1", "--no-figures"]
RECORD = [*WORDS, "--record", "trajectory"]
Usage = namedtuple("Usage", "total used free")


@pytest.fixture(autouse=True)
def _directory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_the_estimate_is_near_the_size_and_told_before_playing(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke([*RECORD, "--progress", "none"]) == 0
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(
        "kswarms: trajectory: about 366 rows of 1 runs, 12.2 kB in ledger.sqlite, 11.0 kB in "
    )
    estimated = trajectory_size(expand([SCENARIO]))
    assert estimated.rows == pq.read_metadata("results/trajectory.parquet").num_rows
    assert estimated.parquet == pytest.approx(Path("results/trajectory.parquet").stat().st_size, rel=0.4)
    assert invoke([*RECORD, "--progress", "none"]) == 0  # nothing is left to record
    assert "about 0 rows of 0 runs" in capsys.readouterr().err


def test_rows_grow_with_robots_duration_and_runs_and_shrink_with_the_sample_period() -> None:
    (condition,) = SCENARIO.conditions
    rows = trajectory_size(expand([SCENARIO])).rows
    assert trajectory_size(expand([SCENARIO.replace(seeds=5)])).rows == 5 * rows
    assert trajectory_size(expand([SCENARIO.replace(densities=(12,))])).rows == 2 * rows
    finer = SCENARIO.replace(conditions=(condition.replace(sample_period=1.0),))
    assert trajectory_size(expand([finer])).rows == 6 * 601
    learning = SCENARIO.replace(conditions=(condition.replace(learning=600.0),))
    assert trajectory_size(expand([learning])).rows == 6 * 121
    short = SCENARIO.replace(conditions=(condition.replace(puck_limit=1),))
    assert trajectory_size(expand([short])).rows < rows


@pytest.mark.parametrize(("free", "fits"), [(10_000, False), (50_000, True)])
def test_a_trajectory_that_cannot_fit_is_refused_before_anything_is_written(
    free: int, fits: bool, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(shutil, "disk_usage", lambda _: Usage(10**9, 10**9 - free, free))
    assert invoke([*RECORD, "--quiet"]) == (0 if fits else 2)
    error = capsys.readouterr().err
    assert Path("results").exists() == fits
    reason = "record='trajectory': needs about 23.2 kB, and the disk of results has 10.0 kB free"
    assert (reason in error) != fits


def test_the_present_table_needs_space_until_it_is_replaced(monkeypatch: pytest.MonkeyPatch) -> None:
    Path("results").mkdir()
    Path("results/trajectory.parquet").write_bytes(bytes(40_000))
    monkeypatch.setattr(shutil, "disk_usage", lambda _: Usage(10**9, 10**9, 50_000))
    with pytest.raises(space.InputError, match=r"needs about 63\.2 kB"):
        describe_trajectories(Path("results"), expand([SCENARIO]), ["trajectory"])
