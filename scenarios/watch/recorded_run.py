"""Runs by their names in the tables of a directory of results, whichever command wrote it."""

from pathlib import Path
from typing import Any

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.runs.run import Run, digest
from kswarms.scenarios.study.ledger import find_run


def recorded_run(directory: Path, name: str) -> Run:
    """Return a run of a directory of results, by its digest in a table.

    Parameters
    ----------
    directory : Path
        What ``kswarms run --out`` or ``kswarms contribution --out`` wrote.
    name : str
        The digest: the column ``run`` of its tables, or ``run_without`` of ``contribution.parquet``.

    Raises
    ------
    InputError
        If there is no such run, or playing it now would be playing something else.
    """
    row = _contribution(directory, name)
    return find_run(directory, name) if row is None else _played_for(row, name)


def _contribution(directory: Path, name: str) -> dict[str, Any] | None:
    """Return a row of contributions that a run was played for, None if there is none."""
    import pyarrow.parquet as pq

    from kswarms.scenarios.contribution.games import FILE, SCHEMA

    path = directory / FILE
    if not path.is_file():
        return None
    columns = ["scenario", "condition", "n", "seed", "robot", "absent_from", "run", "run_without"]
    try:
        table = pq.read_table(path, columns=columns, schema=SCHEMA)
    except (OSError, ValueError) as error:  # pyarrow's own are both
        raise InputError("results", str(directory), f"has a {FILE} that cannot be read") from error
    rows: list[dict[str, Any]] = table.to_pylist()
    return next((row for row in rows if name in (row["run"], row["run_without"])), None)


def _played_for(row: dict[str, Any], name: str) -> Run:
    refusal = InputError(
        "run", name, "is of another version of kswarms, or of a scenario that is not in the list"
    )
    scenario = CATALOGUE.get(row["scenario"])
    if scenario is None:
        raise refusal
    try:
        game = scenario.game(row["condition"], row["n"])
    except InputError:
        raise refusal from None
    if name != row["run"]:
        game = game.replace(absent=(row["robot"],), absent_from=row["absent_from"])
    if digest(game, row["seed"]) != name:
        raise refusal
    return Run(name, game, row["seed"], ((row["scenario"], row["condition"]),))
