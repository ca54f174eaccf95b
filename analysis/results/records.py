"""Reading recorded conflicts and robots, and the table of contributions."""

from collections.abc import Collection
from pathlib import Path

import pandas as pd

from kswarms.agents.common.columns import column_names
from kswarms.agents.common.errors import require_type
from kswarms.agents.common.input_files import to_path
from kswarms.analysis.results.tables import read_table


def recorded_runs(directory: Path, table: str) -> set[str]:
    """Return the runs in a recorded table, ``conflicts`` or ``robots``; empty if there is no table."""
    if not (directory / f"{table}.parquet").is_file():
        return set()
    return set(read_table(directory, table, ["run"])["run"])


def read_conflicts(
    directory: str | Path, runs: Collection[str] | None = None, seen: bool = False
) -> pd.DataFrame:
    """Read `conflicts.parquet` of `kswarms run --record conflicts --out`: one row for each begun conflict.

    `runs` are the runs to read, by default all. With `seen`, the column `seen` (robots that the sensors read)
    is included; it is most of the file. Errors are those of `read_table`.
    """
    directory = to_path("results", directory)
    if runs is not None:
        require_type("runs", runs, Collection, "must be a collection of digests of runs")
    columns = [name for name in column_names("conflicts") if seen or name != "seen"]
    return read_table(directory, "conflicts", columns, runs)


def read_robots(directory: str | Path, runs: Collection[str]) -> pd.DataFrame:
    """Read `robots.parquet`: one row for each robot at the end of its game; `arms` is an array of dicts."""
    return read_table(directory, "robots", column_names("robots"), runs)


def read_contributions(directory: str | Path) -> pd.DataFrame:
    """Read `contribution.parquet` of `kswarms contribution --out`: one row for each game and robot."""
    return read_table(directory, "contribution")
