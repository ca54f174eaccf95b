"""Runs of a results directory, by their digest."""

from pathlib import Path
from typing import Any, Final

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.contribution.table import find_row
from kswarms.scenarios.runs.run import Run, digest, hash_file, user_code_files
from kswarms.scenarios.study.database import LEDGER_FILE
from kswarms.scenarios.study.ledger import Ledger

_MAX_LISTED: Final = 10
"""Maximum number of files in a message."""


def recorded_run(directory: Path, run_digest: str, trust: bool = False) -> Run:
    """Return a run of an output directory of ``kswarms run`` or ``kswarms contribution``, to play it again.

    No user-defined code is executed here. A run that would execute some is refused unless `trust` is true.

    Parameters
    ----------
    run_digest : str
        Digest of the run: column ``run`` of a table, or ``run_without`` of ``contribution.parquet``.

    Raises
    ------
    InputError
        If the directory does not have the run, or this version of the package would play a different game,
        or the run executes code and `trust` is false.
    """
    row = find_row(directory, run_digest)
    if row is not None:
        return _compared_run(row, run_digest)
    with Ledger(directory / LEDGER_FILE) as ledger:
        run = ledger.run(run_digest)
    if not trust:
        require_no_user_code(run)
    return run


def require_no_user_code(run: Run) -> None:
    """Raise an `InputError` with the files and their digests if a run executes user-defined code."""
    if run.game.runs_user_code:
        files = user_code_files(run.game)
        listed = [f"{str(file)!r} (SHA-256 {hash_file(file)[:16]})" for file in files[:_MAX_LISTED]]
        if len(files) > _MAX_LISTED:
            listed.append(f"{len(files) - _MAX_LISTED} more")
        rule = f"executes user-defined code; add --trust if you trust it: {', '.join(listed)}"
        raise InputError("run", run.digest, rule)


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
