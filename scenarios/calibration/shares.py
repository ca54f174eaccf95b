"""Shares of robots that learn to attack, measured by games and stored in a file."""

import time
from collections.abc import Callable, Generator, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any, Final

import numpy as np

from kswarms.agents.common.arrays import Floats
from kswarms.agents.common.errors import InputError
from kswarms.agents.common.input_files import read_json
from kswarms.scenarios.calibration.games import Candidate, Cell, learning_game
from kswarms.scenarios.runs.run import Run, digest
from kswarms.scenarios.study.directory import write_json

Play = Callable[[Sequence[Run]], Generator[tuple[Run, float], None, None]]
"""Plays runs and yields each with the share of learners that learned to attack, in any order."""

FIGURES: Final = {"avoid": "fig-6.4a", "attack": "fig-6.4b"}
"""Figure of each column of Table 6.1, by the opponent's policy."""
_SAVE_EVERY: Final = 5.0
"""Maximum time between two writes of the file (s)."""


class Shares:
    """The shares measured so far, stored in a JSON file.

    `setup` are the settings that all shares of the file have in common. A file with another setup or
    other content is refused. `play` plays the missing runs.
    """

    def __init__(self, path: Path, setup: dict[str, Any], play: Play) -> None:
        self._path, self._setup, self._play = path, setup, play
        self._known: dict[str, float] = _read(path, setup) if path.exists() else {}

    def measure(self, candidates: Sequence[Candidate], cells: Sequence[Cell], seeds: range) -> list[Floats]:
        """Return the shares of each candidate, float64 arrays of shape (cells, seeds)."""
        plans = [[_runs(cell, candidate, seeds) for cell in cells] for candidate in candidates]
        runs = {run.digest: run for plan in plans for of_cell in plan for run in of_cell}
        missing = [run for run in runs.values() if run.digest not in self._known]
        if missing:
            self._measure_missing(missing)
        return [np.array([[self._known[run.digest] for run in runs] for runs in plan]) for plan in plans]

    def _measure_missing(self, runs: Sequence[Run]) -> None:
        saved = time.monotonic()
        try:
            with closing(self._play(runs)) as played:
                for run, share in played:
                    self._known[run.digest] = share
                    if time.monotonic() - saved > _SAVE_EVERY:
                        self.save()
                        saved = time.monotonic()
        finally:
            self.save()

    def save(self) -> None:
        """Write the file."""
        write_json(self._path, {"setup": self._setup, "shares": self._known})


def _runs(cell: Cell, candidate: Candidate, seeds: range) -> list[Run]:
    game = learning_game(cell, candidate)
    return [Run(digest(game, seed), game, seed, ((FIGURES[cell[0]], ""),)) for seed in seeds]


def _read(path: Path, setup: dict[str, Any]) -> dict[str, float]:
    found, shares = read_shares(path)
    if found != setup:
        raise InputError("out", str(path.parent), "has another setup; use another directory, or --fresh")
    return shares


def read_shares(path: Path) -> tuple[dict[str, Any], dict[str, float]]:
    """Return setup and shares of a file; `InputError` if it is no file of a fit."""
    try:
        content = read_json("out", path)
        setup, shares = dict(content["setup"]), dict(content["shares"])
        valid = all(0.0 <= share <= 1.0 for share in shares.values())
    except (ValueError, TypeError, KeyError):
        valid = False
    if not valid:
        raise InputError("out", str(path.parent), f"has a {path.name} that is no file of a fit")
    return setup, shares
