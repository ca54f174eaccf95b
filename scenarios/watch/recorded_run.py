"""Runs of a results directory, by their digest."""

from pathlib import Path
from typing import Any

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.contribution.table import find_row
from kswarms.scenarios.runs.run import Run, digest
from kswarms.scenarios.study.database import LEDGER_FILE
from kswarms.scenarios.study.ledger import Ledger


def recorded_run(directory: Path, name: str) -> Run:
    """Return a run of an output directory of ``kswarms run`` or ``kswarms contribution``.

    Parameters
    ----------
    name : str
        Digest of the run: column ``run`` of a table, or ``run_without`` of ``contribution.parquet``.

    Raises
    ------
    InputError
        If the directory does not have the run, or this version would play another game.
    """
    row = find_row(directory, name)
    if row is not None:
        return _compared_run(row, name)
    with Ledger(directory / LEDGER_FILE) as ledger:
        return ledger.run(name)


def _compared_run(row: dict[str, Any], name: str) -> Run:
    """Return a run that a row of contributions compares."""
    refusal = InputError("run", name, "is of another version of kswarms, or its scenario is not in the list")
    try:
        game = CATALOGUE[row["scenario"]].game(row["condition"], row["n"])
    except (KeyError, InputError):
        raise refusal from None
    if name != row["run"]:
        game = game.replace(absent=(row["robot"],), absent_from=row["absent_from"])
    if digest(game, row["seed"]) != name:
        raise refusal
    return Run(name, game, row["seed"], ((row["scenario"], row["condition"]),))
