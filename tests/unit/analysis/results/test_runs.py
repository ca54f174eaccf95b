"""Reading a results directory: valid tables, and each kind of invalid one."""

from pathlib import Path

import pandas as pd
import pytest

from kswarms.agents.common.columns import names
from kswarms.agents.common.errors import InputError
from kswarms.analysis.results.runs import read_policies, read_results, read_runs

RUNS_TEXT, RUNS_NUMBERS = names("runs", "text"), names("runs", "integer", "real")
POLICIES_TEXT, POLICIES_NUMBERS = names("policies", "text"), names("policies", "integer", "real")


@pytest.fixture
def runs() -> pd.DataFrame:
    frame = pd.DataFrame({name: [1, 2] for name in RUNS_NUMBERS})
    return frame.assign(**{name: ["a", ""] for name in RUNS_TEXT})


def test_a_table_is_read_with_its_further_columns(tmp_path: Path, runs: pd.DataFrame) -> None:
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


def test_a_missing_directory_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"absent.*must be a directory that `kswarms run` wrote"):
        read_runs(tmp_path / "absent")


def test_a_directory_without_runs_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"must be a directory that holds runs\.parquet"):
        read_runs(tmp_path)


@pytest.mark.parametrize("content", [b"", b"not Parquet at all", b"PAR1" + bytes(100) + b"PAR1"])
def test_a_file_in_another_format_is_refused(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "runs.parquet").write_bytes(content)
    with pytest.raises(InputError, match="must be a readable Parquet file"):
        read_runs(tmp_path)


def test_a_truncated_file_is_refused(tmp_path: Path, runs: pd.DataFrame) -> None:
    path = tmp_path / "runs.parquet"
    runs.to_parquet(path)
    path.write_bytes(path.read_bytes()[:-20])
    with pytest.raises(InputError, match="must be a readable Parquet file"):
        read_runs(tmp_path)


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
def test_a_gap_in_a_column_is_refused(tmp_path: Path, runs: pd.DataFrame, name: str) -> None:
    gap = runs.astype({name: object})
    gap.loc[1, name] = None
    gap.to_parquet(tmp_path / "runs.parquet")
    with pytest.raises(InputError, match=f"column {name}=None: must be given in every row"):
        read_runs(tmp_path)


def test_numbers_written_as_text_are_refused(tmp_path: Path, runs: pd.DataFrame) -> None:
    runs.astype({"pucks": str}).to_parquet(tmp_path / "runs.parquet")
    with pytest.raises(InputError, match=r"column pucks=.*must be a column of numbers"):
        read_runs(tmp_path)


def test_policies_are_checked_against_their_own_columns(tmp_path: Path) -> None:
    policies = pd.DataFrame({name: [0.5, 1.0] for name in POLICIES_NUMBERS})
    policies = policies.assign(**{name: ["a", ""] for name in POLICIES_TEXT})
    policies.to_parquet(tmp_path / "policies.parquet")
    assert list(read_policies(tmp_path)["attack_share"]) == [0.5, 1.0]
    with pytest.raises(InputError, match=r"must be a directory that holds runs\.parquet"):
        read_runs(tmp_path)
    for name in (*POLICIES_TEXT, *POLICIES_NUMBERS):
        policies.drop(columns=name).to_parquet(tmp_path / "policies.parquet")
        with pytest.raises(InputError, match=f"policies.*must have the missing columns {name}$"):
            read_policies(tmp_path)


def test_a_directory_without_policies_has_none_to_read(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"must be a directory that holds policies\.parquet"):
        read_policies(tmp_path)


def test_results_are_both_tables(tmp_path: Path, runs: pd.DataFrame) -> None:
    runs.to_parquet(tmp_path / "runs.parquet")
    assert read_results(tmp_path).policies is None
    policies = pd.DataFrame(
        {name: ["a"] for name in POLICIES_TEXT} | {name: [1] for name in POLICIES_NUMBERS}
    )
    policies.to_parquet(tmp_path / "policies.parquet")
    results = read_results(tmp_path)
    assert results.policies is not None
    assert (len(results.runs), len(results.policies)) == (2, 1)


def test_damaged_policies_are_refused(tmp_path: Path, runs: pd.DataFrame) -> None:
    runs.to_parquet(tmp_path / "runs.parquet")
    (tmp_path / "policies.parquet").write_bytes(b"not Parquet at all")
    with pytest.raises(InputError, match="must be a readable Parquet file"):
        read_results(tmp_path)
