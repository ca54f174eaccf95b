"""Reading recorded conflicts and robots, and the table of contributions."""

from collections.abc import Collection
from pathlib import Path

import pandas as pd

from kswarms.agents.common.columns import names
from kswarms.analysis.results.tables import read_table


def recorded_runs(directory: Path, table: str) -> set[str]:
    """Return the runs in a recorded table, ``conflicts`` or ``robots``; empty if there is no such table.

    Raises
    ------
    InputError
        The file cannot be read.
    """
    if not (directory / f"{table}.parquet").is_file():
        return set()
    return set(read_table(directory, table, ["run"])["run"])


def read_conflicts(directory: Path, runs: Collection[str] | None = None, seen: bool = False) -> pd.DataFrame:
    """Read `conflicts.parquet`: one row for each conflict that a robot began.

    Parameters
    ----------
    directory : Path
        Directory that `kswarms run --record conflicts --out` wrote.
    runs : collection of str, optional
        Runs to read; by default all.
    seen : bool
        Whether to read the column `seen` (robots that the sensors read), the bulk of the file.

    Raises
    ------
    InputError
        As for `kswarms.analysis.results.tables.read_table`.
    """
    columns = [name for name in names("conflicts") if seen or name != "seen"]
    return read_table(directory, "conflicts", columns, runs)


def read_robots(directory: Path, runs: Collection[str]) -> pd.DataFrame:
    """Read `robots.parquet`: one row for each robot at the end of its game.

    Parameters
    ----------
    directory : Path
        Directory that `kswarms run --record robots --out` wrote.
    runs : collection of str
        Runs to read.

    Returns
    -------
    pandas.DataFrame
        The columns of the schema; `arms` is an array of dicts.

    Raises
    ------
    InputError
        As for `kswarms.analysis.results.tables.read_table`.
    """
    return read_table(directory, "robots", names("robots"), runs)


def read_contributions(directory: Path) -> pd.DataFrame:
    """Read `contribution.parquet`, which `kswarms contribution --out` wrote: one row for each game and robot.

    Raises
    ------
    InputError
        As for `kswarms.analysis.results.tables.read_table`.
    """
    return read_table(directory, "contribution")
