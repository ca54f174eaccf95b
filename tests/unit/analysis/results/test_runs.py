"""Reading valid and invalid tables of a results directory."""

from pathlib import Path

import pandas as pd
import pytest

from kswarms.agents.common.columns import column_names
from kswarms.agents.common.errors import InputError
from kswarms.analysis.results.runs import read_policies, read_results, read_runs

RUNS_TEXT, RUNS_NUMBERS = column_names("runs", "text"), column_names("runs", "integer", "real")
READERS = {"runs": read_runs, "policies": read_policies}
POLICIES_TEXT = column_names("policies", "text")
POLICIES_NUMBERS = column_names("policies", "integer", "real")


@pytest.fixture
def runs() -> pd.DataFrame:
    frame = pd.DataFrame({name: [1, 2] for name in RUNS_NUMBERS})
    return frame.assign(**{name: ["a", ""] for name in RUNS_TEXT})


def test_columns_beyond_the_schema_are_kept(tmp_path: Path, runs: pd.DataFrame) -> None:
    runs.assign(note=[0.5, 0.25]).to_parquet(tmp_path / "runs.parquet")
    read = read_runs(tmp_path)
    assert list(read["note"]) == [0.5, 0.25]
    assert list(read["condition"]) == ["a", ""]
    assert list(read["pucks"]) == [1, 2]


def test_categorical_text_is_read_as_text(tmp_path: Path, runs: pd.DataFrame) -> None:
    runs.astype({"scenario": "category"}).to_parquet(tmp_path / "runs.parquet")
    scenario = read_runs(tmp_path)["scenario"]
    assert not isinstance(scenario.dtype, pd.CategoricalDtype)
    assert list(scenario) == ["a", ""]


def test_a_missing_directory_or_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"absent.*must be a directory that `kswarms run` wrote"):
        read_runs(tmp_path / "absent")
    for name, read in READERS.items():
        with pytest.raises(InputError, match=rf"must be a directory that holds {name}\.parquet"):
            read(tmp_path)


def test_a_damaged_file_is_refused(tmp_path: Path, runs: pd.DataFrame) -> None:
    runs.to_parquet(tmp_path / "runs.parquet")
    truncated = (tmp_path / "runs.parquet").read_bytes()[:-20]
    damaged = (b"", b"not Parquet at all", b"PAR1" + bytes(100) + b"PAR1", truncated)
    for content in damaged:
        for name, read in READERS.items():
            (tmp_path / f"{name}.parquet").write_bytes(content)
            with pytest.raises(InputError, match=rf"{name}\.parquet': must be a readable Parquet file"):
                read(tmp_path)
    runs.to_parquet(tmp_path / "runs.parquet")
    with pytest.raises(InputError, match=r"policies\.parquet': must be a readable Parquet file"):
        read_results(tmp_path)


@pytest.mark.parametrize("name", [*RUNS_TEXT, *RUNS_NUMBERS])
def test_a_missing_column_is_named(tmp_path: Path, runs: pd.DataFrame, name: str) -> None:
    runs.drop(columns=name).to_parquet(tmp_path / "runs.parquet")
    with pytest.raises(InputError, match=f"must have the missing columns {name}$"):
        read_runs(tmp_path)


def test_a_table_without_rows_is_refused(tmp_path: Path, runs: pd.DataFrame) -> None:
    runs.iloc[:0].to_parquet(tmp_path / "runs.parquet")
    with pytest.raises(InputError, match="must hold at least one run"):
        read_runs(tmp_path)


@pytest.mark.parametrize("name", ["scenario", "pucks"])
def test_a_missing_value_is_refused(tmp_path: Path, runs: pd.DataFrame, name: str) -> None:
    gap = runs.astype({name: object})
    gap.loc[1, name] = None
    gap.to_parquet(tmp_path / "runs.parquet")
    with pytest.raises(InputError, match=f"column {name}=None: must be given in every row"):
        read_runs(tmp_path)


def test_numbers_written_as_text_are_refused(tmp_path: Path, runs: pd.DataFrame) -> None:
    runs.astype({"pucks": str}).to_parquet(tmp_path / "runs.parquet")
    with pytest.raises(InputError, match=r"column pucks=.*must be a column of integers"):
        read_runs(tmp_path)


def test_policies_are_checked_against_their_own_columns(tmp_path: Path) -> None:
    policies = pd.DataFrame({name: [1.0, 2.0] for name in POLICIES_NUMBERS})
    policies = policies.assign(share=0.5, attack_share=[0.5, 1.0])
    policies = policies.assign(**{name: ["a", ""] for name in POLICIES_TEXT})
    policies.to_parquet(tmp_path / "policies.parquet")
    assert list(read_policies(tmp_path)["attack_share"]) == [0.5, 1.0]
    for name in (*POLICIES_TEXT, *POLICIES_NUMBERS):
        policies.drop(columns=name).to_parquet(tmp_path / "policies.parquet")
        with pytest.raises(InputError, match=f"policies.*must have the missing columns {name}$"):
            read_policies(tmp_path)


def test_results_have_runs_and_policies(tmp_path: Path, runs: pd.DataFrame) -> None:
    runs.to_parquet(tmp_path / "runs.parquet")
    assert read_results(tmp_path).policies is None
    columns = {name: ["a"] for name in POLICIES_TEXT} | {name: [1] for name in POLICIES_NUMBERS}
    pd.DataFrame(columns).to_parquet(tmp_path / "policies.parquet")
    results = read_results(tmp_path)
    assert results.policies is not None
    assert (len(results.runs), len(results.policies)) == (2, 1)
