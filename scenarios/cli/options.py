"""What several commands ask for."""

import os
from pathlib import Path
from typing import Annotated, Final

import typer

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.catalogue import CATALOGUE, TABLES
from kswarms.scenarios.catalogue.selecting import FIRST_SCENARIO, USUAL_N, chosen
from kswarms.scenarios.runs.run import LAST_SEED, Run, digest

MOST_JOBS: Final = 1024
"""Processes at most: of more, no machine has the memory."""

Jobs = Annotated[
    int | None, typer.Option(help="Processes that play, at least 1. [default: one for each CPU]")
]


def processes(jobs: int | None) -> int:
    """Return how many processes play: as many as asked for, or one for each CPU.

    Raises
    ------
    InputError
        If fewer than one is asked for.
    """
    if jobs is None:
        return os.cpu_count() or 1
    if not 1 <= jobs <= MOST_JOBS:
        raise InputError("jobs", jobs, f"must be at least 1, at most {MOST_JOBS}")
    return jobs


def ids(incomplete: str) -> list[tuple[str, str]]:
    """Return the scenarios and tables whose ids begin so, each with its title: what the shell completes."""
    return [
        (name, entry.title) for name, entry in (CATALOGUE | TABLES).items() if name.startswith(incomplete)
    ]


def scenario_ids(incomplete: str) -> list[tuple[str, str]]:
    """Return `ids` without those of tables."""
    return [(name, title) for name, title in ids(incomplete) if name in CATALOGUE]


def directory(text: str) -> Path:
    """Read the path of a directory.

    Raises
    ------
    InputError
        If it is empty, as of a variable that a shell does not know; it would mean the current directory.
    """
    if not text:
        raise InputError("out", text, "must be the path of a directory")
    return Path(text)


Watched = Annotated[
    str | None,
    typer.Argument(
        metavar="ID|DIR",
        help="A scenario or table of the list, or my.toml; with --run, a directory of results. "
        f"[default: {FIRST_SCENARIO}]",
        autocompletion=ids,
    ),
]
RunDigest = Annotated[
    str, typer.Option(metavar="DIGEST", help="A run of DIR, played again: the column `run` of its tables.")
]


def asked(what: str | None, run: str) -> str | Run:
    """Return what is to be watched: a scenario as `chosen` takes it, or a run.

    Raises
    ------
    InputError
        If a run is asked for that no directory has.
    """
    if not run:
        return what or FIRST_SCENARIO
    if what is None:
        raise InputError("run", run, "needs the directory of results that has it")
    from kswarms.scenarios.watch.recorded_run import recorded_run

    return recorded_run(Path(what), run)


ConditionName = Annotated[
    str | None,
    typer.Option(
        "--condition",
        metavar="NAME",
        help="Curve of the scenario, as `kswarms show` names it. [default: its first]",
    ),
]
Robots = Annotated[
    int | None,
    typer.Option("--n", help="Robots in all, as the shares of its swarms allow. [default: near 20]"),
]
Seed = Annotated[int | None, typer.Option("--seed", help="Seed of the game, at least 0. [default: 0]")]


def check_seed(field: str, seed: int) -> None:
    """Refuse a seed that is none.

    Raises
    ------
    InputError
        If it is out of range.
    """
    if not 0 <= seed <= LAST_SEED:
        raise InputError(field, seed, f"must be at least 0, at most {LAST_SEED}")


def one_run(what: str | None, run: str, condition: str | None, n: int | None, seed: int | None) -> Run:
    """Return the run that is asked for: one of a directory by its digest, or one of a scenario.

    Raises
    ------
    InputError
        If there is no such run, or a run of a directory is asked to be another.
    """
    start = asked(what, run)
    if isinstance(start, Run):
        for field, value in (("condition", condition), ("n", n), ("seed", seed)):
            if value is not None:
                raise InputError(field, value, "must not be given with a run, which has its own")
        return start
    found = chosen([start])[0]
    name = found.conditions[0].name if condition is None else condition
    if n is None:
        n = min(found.densities, key=lambda density: abs(density - USUAL_N))
    check_seed("seed", seed or 0)
    game = found.game(name, n)
    return Run(digest(game, seed or 0), game, seed or 0, ((found.id, name),))
