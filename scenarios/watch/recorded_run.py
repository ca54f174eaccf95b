"""Runs of a results directory, by their digest."""

from pathlib import Path
from typing import Any

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.contribution.table import find_row
from kswarms.scenarios.runs.run import Run, digest
from kswarms.scenarios.study.database import LEDGER_FILE
from kswarms.scenarios.study.ledger import Ledger


def recorded_run(directory: Path, run_digest: str) -> Run:
    """Return a run of an output directory of ``kswarms run`` or ``kswarms contribution``.

    Parameters
    ----------
    run_digest : str
        Digest of the run: column ``run`` of a table, or ``run_without`` of ``contribution.parquet``.

    Raises
    ------
    InputError
        If the directory does not have the run, or this version of the package would play a different game.
    """
    row = find_row(directory, run_digest)
    if row is not None:
        return _compared_run(row, run_digest)
    with Ledger(directory / LEDGER_FILE) as ledger:
        return ledger.run(run_digest)


def _compared_run(row: dict[str, Any], run_digest: str) -> Run:
    """Return a run from a row of the table of contributions."""
    rule = "must be a run of this version of kswarms and of a scenario of the catalogue"
    refusal = InputError("run", run_digest, rule)
    try:
        game = CATALOGUE[row["scenario"]].game(row["condition"], row["n"])
    except (KeyError, InputError):
        raise refusal from None
    if run_digest != row["run"]:
        game = game.replace(absent=(row["robot"],), absent_from=row["absent_from"])
    if digest(game, row["seed"]) != run_digest:
        raise refusal
    return Run(run_digest, game, row["seed"], ((row["scenario"], row["condition"]),))
