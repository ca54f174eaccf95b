"""Reading the tables of a results directory (section 3.5 of the experiments)."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import pandas as pd
from pandas.api.types import is_numeric_dtype

from kswarms.agents.common.columns import names
from kswarms.agents.common.errors import InputError

RUNS_FILE = "runs.parquet"

RUNS_TEXT = names("runs", "text")
RUNS_NUMBERS = names("runs", "integer", "real")

POLICIES_FILE = "policies.parquet"

POLICIES_TEXT = names("policies", "text")
POLICIES_NUMBERS = names("policies", "integer", "real")

# What pandas and Arrow raise on damaged bytes: mostly OSError or ValueError, the others where the
# description of the columns is damaged.
_DAMAGE = (OSError, ValueError, LookupError, TypeError, RuntimeError)


@dataclass(frozen=True)
class Results:
    """The tables of a results directory that hold outcomes.

    Attributes
    ----------
    runs : pandas.DataFrame
        As `read_runs` returns them.
    policies : pandas.DataFrame or None
        As `read_policies` returns them; None if no swarm learned.
    """

    runs: pd.DataFrame
    policies: pd.DataFrame | None = None


def read_results(directory: Path) -> Results:
    """Read what a results directory says of outcomes.

    Parameters
    ----------
    directory : Path
        The results directory that `kswarms run --out` wrote.

    Raises
    ------
    InputError
        As for `read_runs`, and as for `read_policies` if the directory holds policies.
    """
    runs = read_runs(directory)
    learned = (directory / POLICIES_FILE).exists()
    return Results(runs, read_policies(directory) if learned else None)


def read_runs(directory: Path) -> pd.DataFrame:
    """Read `runs.parquet`, one row for each (run, swarm), and check that it keeps the results contract.

    Parameters
    ----------
    directory : Path
        The results directory that `kswarms run --out` wrote.

    Returns
    -------
    pandas.DataFrame
        At least one row; the columns `RUNS_TEXT` (str) and `RUNS_NUMBERS` (numbers, none missing; times in
        robot-seconds, `duration` in seconds), and whatever other columns the file has.

    Raises
    ------
    InputError
        The directory or the file is missing or cannot be read, there is no row, or a column is missing, has
        gaps or is of the wrong kind.
    """
    return _read(directory, RUNS_FILE, RUNS_TEXT, RUNS_NUMBERS)


def read_policies(directory: Path) -> pd.DataFrame:
    """Read `policies.parquet`, one row for each (run, learning swarm, swarm learned about, action).

    Parameters
    ----------
    directory : Path
        The results directory that `kswarms run --out` wrote.

    Returns
    -------
    pandas.DataFrame
        At least one row; the columns `POLICIES_TEXT` (str) and `POLICIES_NUMBERS` (numbers, none missing;
        shares from 0 to 1), and whatever other columns the file has.

    Raises
    ------
    InputError
        As for `read_runs`.
    """
    return _read(directory, POLICIES_FILE, POLICIES_TEXT, POLICIES_NUMBERS)


def _read(directory: Path, name: str, text: Sequence[str], numbers: Sequence[str]) -> pd.DataFrame:
    if not directory.is_dir():
        raise InputError("results", str(directory), "must be a directory that `kswarms run` wrote")
    path = directory / name
    if not path.is_file():
        raise InputError("results", str(directory), f"must be a directory that holds {name}")
    try:
        rows = pd.read_parquet(path)
    except _DAMAGE as error:
        raise InputError("results", str(path), "must be a readable Parquet file") from error
    _check(rows, path, text, numbers)
    return rows.astype(dict.fromkeys(text, str))


def _check(rows: pd.DataFrame, path: Path, text: Sequence[str], numbers: Sequence[str]) -> None:
    missing = [name for name in (*text, *numbers) if name not in rows.columns]
    if missing:
        raise InputError("results", str(path), f"must have the missing columns {', '.join(missing)}")
    if rows.empty:
        raise InputError("results", str(path), "must hold at least one run")
    for name in (*text, *numbers):
        if rows[name].isna().any():
            raise InputError(f"{path.name} column {name}", None, "must be given in every row")
    for name in numbers:
        if not is_numeric_dtype(rows[name]):
            raise InputError(
                f"{path.name} column {name}", str(rows[name].dtype), "must be a column of numbers"
            )
