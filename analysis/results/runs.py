"""Reading outcomes from a results directory (section 3.5 of the experiments) or from games in memory."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

import pandas as pd

from kswarms.agents.common.columns import KEYS
from kswarms.agents.common.errors import InputError
from kswarms.agents.common.input_files import to_path
from kswarms.analysis.results.sweeps import Sweep, tables_of_sweep
from kswarms.analysis.results.tables import read_table


@dataclass(frozen=True)
class Results:
    """Outcomes of runs.

    Attributes
    ----------
    runs : pandas.DataFrame
        Table of `read_runs`.
    policies : pandas.DataFrame, optional
        Table of `read_policies`; None if no swarm learned.
    """

    runs: pd.DataFrame
    policies: pd.DataFrame | None = None

    @classmethod
    def of_rows(cls, runs: Sequence[Mapping[str, Any]], policies: Sequence[Mapping[str, Any]]) -> Self:
        """Return the results in rows of both tables."""
        return cls(pd.DataFrame(runs), pd.DataFrame(policies) if policies else None)


def read_results(
    source: str | Path | Sweep, scenario: str = "sweep", by: Sequence[str] | None = None
) -> Results:
    """Read outcomes from a results directory, or from games in memory.

    Parameters
    ----------
    source : Path, str, pandas.DataFrame, iterable of mappings, model, or iterable of models
        * Path or str: a directory that `kswarms run --out` wrote;
        * the rows of `mesa.batch_run` with ``record="model"``, as a list or data frame, without learned
          policies; the last row of each game is used;
        * `model.datacollector.get_model_vars_dataframe()` of one game;
        * models whose games have ended.
    scenario : str
        Id of the scenario, for games in memory.
    by : sequence of str, optional
        Parameters that define the conditions of games in memory; by default all parameters that differ
        between games, except ``n`` and ``seed``. Conditions are named ``side=2.0, layout=ring``.

    Raises
    ------
    InputError
        A table cannot be read; a game has not ended or lacks model reporters; or two games have the same
        condition, N and seed.

    Examples
    --------
    >>> from kswarms import ForagingModel, read_results
    >>> model = ForagingModel(n=6, policies="avoid,attack", duration=30, seed=1)
    >>> model.play()
    >>> read_results(model).runs[["scenario", "n", "seed", "swarm", "policy"]].values.tolist()
    [['sweep', 6, 1, 1, 'avoid'], ['sweep', 6, 1, 2, 'attack']]
    """
    if not isinstance(source, str | Path):
        return Results(*tables_of_sweep(source, scenario, by))
    directory = to_path("results", source)
    learned = (directory / "policies.parquet").exists()
    runs = read_runs(directory)
    return Results(runs, _require_rows_of(read_policies(directory), runs) if learned else None)


def read_runs(directory: Path) -> pd.DataFrame:
    """Read `runs.parquet`: one row for each run and swarm.

    Required columns are those of `kswarms.agents.common.columns`; the file may have more. `InputError` if it
    is empty.
    """
    return _read_outcomes(directory, "runs")


def read_policies(directory: Path) -> pd.DataFrame:
    """Read `policies.parquet`: one row for each run, learning swarm, opponent and action."""
    return _read_outcomes(directory, "policies")


def _read_outcomes(directory: Path, table: str) -> pd.DataFrame:
    rows = read_table(directory, table)
    if rows.empty:
        raise InputError("results", str(directory / f"{table}.parquet"), "must hold at least one run")
    return rows


def _require_rows_of(policies: pd.DataFrame, runs: pd.DataFrame) -> pd.DataFrame:
    """Return `policies` if each row belongs to a row of `runs`."""
    labels = ["run", *KEYS["runs"]]
    keys = set(runs[labels].itertuples(index=False, name=None))
    for row in policies[labels].drop_duplicates().itertuples(index=False, name=None):
        if row not in keys:
            key = ", ".join(f"{label}={value}" for label, value in zip(labels, row, strict=True))
            raise InputError("policies.parquet key", key, "must be in runs.parquet")
    return policies
