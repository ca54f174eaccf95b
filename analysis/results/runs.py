"""Reading the outcomes in a results directory (section 3.5 of the experiments)."""

from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from kswarms.agents.common.errors import InputError
from kswarms.analysis.results.tables import read_table


@dataclass(frozen=True)
class Results:
    """Outcomes of runs.

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
    """Read the outcomes in a results directory.

    Parameters
    ----------
    directory : Path
        Directory that `kswarms run --out` wrote.

    Raises
    ------
    InputError
        As for `read_runs`, and for `read_policies` if the directory holds policies.
    """
    learned = (directory / "policies.parquet").exists()
    return Results(read_runs(directory), read_policies(directory) if learned else None)


def read_runs(directory: Path) -> pd.DataFrame:
    """Read `runs.parquet`: one row for each run and swarm.

    Parameters
    ----------
    directory : Path
        Directory that `kswarms run --out` wrote.

    Returns
    -------
    pandas.DataFrame
        At least one row; the columns of the schema (docs/running.md), and further columns of the file.

    Raises
    ------
    InputError
        As for `kswarms.analysis.results.tables.read_table`, or there is no row.
    """
    return _read_outcomes(directory, "runs")


def read_policies(directory: Path) -> pd.DataFrame:
    """Read `policies.parquet`: one row for each run, learning swarm, swarm learned about and action.

    Parameters, returned value and errors are those of `read_runs`.
    """
    return _read_outcomes(directory, "policies")


def _read_outcomes(directory: Path, table: str) -> pd.DataFrame:
    rows = read_table(directory, table)
    if rows.empty:
        raise InputError("results", str(directory / f"{table}.parquet"), "must hold at least one run")
    return rows
