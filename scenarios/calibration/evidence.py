"""Games of candidate worlds, and a file that keeps their results."""

import json
from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any, Final, NamedTuple

from kswarms.agents.common.atomic_files import atomic_path
from kswarms.agents.common.errors import InputError
from kswarms.model.description.parameters import Parameters
from kswarms.model.description.presets import PRESETS
from kswarms.scenarios.calibration.worlds import in_world
from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.runs.outcome import Outcome
from kswarms.scenarios.runs.run import Run, expand

Curves = Mapping[tuple[str, str], Sequence[int]]
"""Densities by scenario and condition."""
Play = Callable[[Sequence[Run]], Generator[tuple[Run, Outcome], None, None]]
"""Plays runs and yields each with its outcome, in any order."""

_ABOUT: Final = "calibration"
"""Key of the first line of a file of games."""


class Rows(NamedTuple):
    """Rows of ``runs.parquet`` and of ``policies.parquet``."""

    swarms: list[dict[str, Any]]
    policies: list[dict[str, Any]]


def runs_of(world: Parameters, curves: Curves, first_seed: int, seeds: int) -> list[Run]:
    """Return the runs of some curves of the catalogue in a world."""
    scenarios = []
    for (name, condition), densities in curves.items():
        if name not in CATALOGUE:
            raise InputError("scenario", name, "must be one of `kswarms list`")
        scenario = CATALOGUE[name]
        chosen = tuple(each for each in scenario.conditions if each.name == condition)
        if not chosen:
            names = ", ".join(repr(each.name) for each in scenario.conditions)
            raise InputError("condition", condition, f"must be one of {names} of {name}")
        games = {"densities": tuple(densities), "seeds": seeds, "grid": {}}
        scenarios.append(in_world(scenario.replace(conditions=chosen, **games), world))
    return expand(scenarios, first_seed)


def require_games(curves: Curves) -> None:
    """Raise an `InputError` if the catalogue does not have some curves at their densities."""
    runs_of(PRESETS["fitted"], curves, 0, 1)


class Evidence:
    """The outcomes of the games so far, in a file with one line of JSON for each.

    The first line has `about`, the settings that all games have in common. A last line that an interruption
    cut off is ignored. `play` plays the missing runs.

    Raises
    ------
    InputError
        The file has other content, or games of other settings.
    """

    def __init__(self, path: Path, about: Mapping[str, Any], play: Play) -> None:
        self._path, self._play = path, play
        self._known: dict[str, Rows] = {}
        if not path.exists():
            with atomic_path(path) as file:
                file.write_text(json.dumps({_ABOUT: about}) + "\n", encoding="utf-8")
            return
        found, lines = _read(path)
        if found != json.loads(json.dumps(about)):
            raise InputError(
                "out", str(path.parent), "has games of other settings; use another directory, or --fresh"
            )
        self._known.update((digest, Rows(swarms, policies)) for digest, swarms, policies in lines)

    def rows(self, plans: Sequence[Sequence[Run]]) -> list[Rows]:
        """Return the rows of the runs of each plan, and play those that are missing."""
        runs = {run.digest: run for plan in plans for run in plan}
        if missing := [run for digest, run in runs.items() if digest not in self._known]:
            self._add(missing)
        return [_labelled(plan, self._known) for plan in plans]

    def _add(self, runs: Sequence[Run]) -> None:
        with closing(self._play(runs)) as played, self._path.open("a", encoding="utf-8") as file:
            for run, outcome in played:
                rows = self._known[run.digest] = Rows(outcome.swarms, outcome.policies)
                file.write(json.dumps([run.digest, *rows], separators=(",", ":")) + "\n")
                file.flush()


def _labelled(plan: Iterable[Run], known: Mapping[str, Rows]) -> Rows:
    rows = Rows([], [])
    for run in plan:
        for scenario, condition in run.labels:
            label = {"scenario": scenario, "condition": condition, "n": run.n, "seed": run.seed}
            for of_plan, of_run in zip(rows, known[run.digest], strict=True):
                of_plan.extend({**label, **row} for row in of_run)
    return rows


def require_evidence(path: Path) -> None:
    """Raise an `InputError` if a file has other content than games and their settings."""
    _read(path)


def _read(path: Path) -> tuple[object, list[Any]]:
    """Return the settings in the first line, and the other lines. A last line that is cut off is deleted."""
    try:
        *complete, tail = path.read_text(encoding="utf-8").split("\n")
        first, *lines = [json.loads(line) for line in complete]
        about = first[_ABOUT]
        if any(len(line) != len(Rows._fields) + 1 for line in lines):
            raise ValueError
    except (ValueError, TypeError, KeyError, RecursionError):
        raise InputError("out", str(path.parent), f"has a {path.name} that is no file of games") from None
    if tail:
        with atomic_path(path) as file:
            file.write_text("".join(f"{line}\n" for line in complete), encoding="utf-8")
    return about, lines
