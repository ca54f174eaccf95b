"""Reading what games recorded, robot by robot and conflict by conflict."""

from collections.abc import Collection, Sequence
from pathlib import Path

import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

from kswarms.agents.common.columns import names
from kswarms.agents.common.errors import InputError

CONFLICTS_FILE = "conflicts.parquet"
CONFLICTS_COLUMNS = tuple(name for name in names("conflicts") if name != "seen")

ROBOTS_FILE = "robots.parquet"
ROBOTS_COLUMNS = names("robots")


def recorded_runs(directory: Path, name: str) -> set[str]:
    """Return the runs that a recorded table has rows of; none if there is no such table.

    Parameters
    ----------
    directory : Path
        The results directory that `kswarms run --out` wrote.
    name : str
        `CONFLICTS_FILE` or `ROBOTS_FILE`.

    Raises
    ------
    InputError
        The file cannot be read.
    """
    if not (directory / name).is_file():
        return set()
    return set(_read(directory / name, ["run"])["run"])


def read_conflicts(directory: Path, runs: Collection[str] | None = None, seen: bool = False) -> pd.DataFrame:
    """Read rows of `conflicts.parquet`, one for each conflict that a robot began.

    Parameters
    ----------
    directory : Path
        The results directory that `kswarms run --record conflicts --out` wrote.
    runs : collection of str, optional
        Runs wanted; all if not given.
    seen : bool
        Whether the robots are read too that each robot saw, the bulk of the file.

    Returns
    -------
    pandas.DataFrame
        The columns `CONFLICTS_COLUMNS`, and `seen` if it is wanted; `start`, `t_a`, `t_p` in s, `x`, `y`
        in m.

    Raises
    ------
    InputError
        The file is missing, cannot be read or lacks a column.
    """
    columns = (*CONFLICTS_COLUMNS, "seen") if seen else CONFLICTS_COLUMNS
    return _read(directory / CONFLICTS_FILE, columns, runs)


def read_robots(directory: Path, runs: Collection[str]) -> pd.DataFrame:
    """Read rows of `robots.parquet`, one for each robot at the end of its game.

    Parameters
    ----------
    directory : Path
        The results directory that `kswarms run --record robots --out` wrote.
    runs : collection of str
        Runs wanted.

    Returns
    -------
    pandas.DataFrame
        The columns `ROBOTS_COLUMNS`; `t_a`, `t_p` in s; `arms` an array of dicts with opponent, action,
        reward, time, count and q.

    Raises
    ------
    InputError
        The file is missing, cannot be read or lacks a column.
    """
    return _read(directory / ROBOTS_FILE, ROBOTS_COLUMNS, runs)


def _read(path: Path, columns: Sequence[str], runs: Collection[str] | None = None) -> pd.DataFrame:
    try:
        missing = [name for name in columns if name not in pq.read_schema(path).names]
        if missing:
            raise InputError("results", str(path), f"must have the missing columns {', '.join(missing)}")
        filters = None if runs is None else [("run", "in", set(runs))]
        rows: pd.DataFrame = pq.read_table(path, columns=list(columns), filters=filters).to_pandas()
    except (OSError, pa.ArrowException) as error:
        raise InputError("results", str(path), "must be a readable Parquet file") from error
    return rows
