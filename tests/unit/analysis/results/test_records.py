"""Reading recorded conflicts and robots."""

from pathlib import Path

import pandas as pd
import pytest

from kswarms.agents.common.errors import InputError
from kswarms.analysis.measures.emergence import preferences
from kswarms.analysis.results.records import read_conflicts, read_robots, recorded_runs
from tests.helpers.result_rows import MET, robots


def test_records_of_selected_runs_are_read(tmp_path: Path) -> None:
    pd.concat([MET, MET.assign(run="b")]).to_parquet(tmp_path / "conflicts.parquet")
    robots(("a", "b")).to_parquet(tmp_path / "robots.parquet")
    assert recorded_runs(tmp_path, "conflicts") == {"a", "b"}
    assert set(read_conflicts(tmp_path, ["b"])["run"]) == {"b"}
    read = read_robots(tmp_path, ["a"])
    assert len(preferences(read)) == 3
    assert recorded_runs(tmp_path / "nowhere", "conflicts") == set()


def test_runs_that_are_no_digests_are_refused_at_the_first(tmp_path: Path) -> None:
    MET.assign(run="a").to_parquet(tmp_path / "conflicts.parquet")
    with pytest.raises(InputError, match="runs=0: must be the digest of a run"):
        read_conflicts(tmp_path, range(10**9))


def test_damaged_and_incomplete_records_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "conflicts.parquet"
    path.write_bytes(b"PAR1 and no more")
    with pytest.raises(InputError, match="must be a readable Parquet file"):
        recorded_runs(tmp_path, "conflicts")
    MET.drop(columns=["x", "q"]).to_parquet(path)
    with pytest.raises(InputError, match="must have the missing columns x, q"):
        read_conflicts(tmp_path, ["a"])
