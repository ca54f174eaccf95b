"""What a calibration plays: the games of Table 6.1 at a point of the parameters, and what was learned."""

import json
import math
import time
from collections.abc import Callable, Generator, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any, Final

import numpy as np

from kswarms.agents.common.arrays import Floats
from kswarms.agents.common.errors import InputError
from kswarms.agents.learning.selection_rules import UCB
from kswarms.model.description.game import Game, Swarm
from kswarms.model.description.parameters import PRESETS, parse_parameters
from kswarms.scenarios.description.scenario import LEARNING
from kswarms.scenarios.runs.run import Run, digest
from kswarms.scenarios.study.directory import write_json

Point = dict[str, float]
"""A value for each free parameter, by name."""
Cell = tuple[str, int]
"""A cell of Table 6.1: the opponent's policy and N."""
Play = Callable[[Sequence[Run]], Generator[tuple[Run, float], None, None]]
"""Plays runs and yields each with the share of learners that learned to attack, in any order."""

START: Final[Point] = {
    name: getattr(PRESETS["fitted"], name)
    for name in (
        *("conflict_distance", "front_half_angle", "flight_duration", "fight_duration", "turning_rate"),
        *("flight_range", "active_range", "leg_mean", "wander_turn", "wall_distance"),
        *("station_radius", "base_radius", "base_range", "friction", "push_share"),
    )
} | {"gamma": UCB().gamma}
"""The parameters that can be fitted, those of section 2.7, and where the search starts: the defaults."""

FIGURES: Final = {"avoid": "fig-6.4a", "attack": "fig-6.4b"}
"""The figure whose learners a column of Table 6.1 counts, by the opponent's policy."""

SPAN: Final = 2.0
"""A parameter is searched from its start value / 2 to its start value × 2, on a logarithmic scale …"""
LIMITS: Final = {"base_radius": 0.2, "push_share": 0.5}
"""… or up to a limit: where the base meets the wall (m), and for what starts at 0, on a linear scale."""
_SAVE_EVERY: Final = 5.0
"""Games are worth this much time of play at most before they are saved (s)."""


def texts(point: Point) -> tuple[str, str]:
    """Return a point as users write it: the text of the parameters, and that of the selection rule."""
    changes = [f"{name}={value}" for name, value in point.items() if name != "gamma"]
    return ", ".join(["fitted", *changes]), f"ucb(gamma={point.get('gamma', START['gamma'])})"


def learning_game(cell: Cell, point: Point) -> Game:
    """Return the game in which a cell of Table 6.1 is learned; of what is measured after it, one period."""
    opponent, n = cell
    parameters, rule = texts(point)
    world = parse_parameters(parameters)
    learner = Swarm(policy=f'inter-learner(rule="{rule}")', size=n - n // 2)
    return Game(
        swarms=(Swarm(policy=opponent, size=n // 2), learner),
        parameters=world,
        learning=LEARNING,
        duration=world.period,
    )


def to_point(free: Sequence[str], place: Floats) -> Point:
    """Return the point at a place of the unit cube that is searched, to four significant digits."""
    point = {}
    for name, part in zip(free, place, strict=True):
        low, high = _bounds(name)
        value = low * (high / low) ** part if low > 0 else high * part
        point[name] = float(f"{value:.4g}")
    return point


def to_place(point: Point) -> Floats:
    """Return the place of a point in the unit cube."""
    place = []
    for name, value in point.items():
        low, high = _bounds(name)
        place.append(math.log(value / low, high / low) if low > 0 else value / high)
    return np.array(place)


def _bounds(name: str) -> tuple[float, float]:
    start = START[name]
    limit = LIMITS.get(name, math.inf)
    return start / SPAN, (min(start * SPAN, limit) if start > 0 else limit)


class Shares:
    """The shares measured so far, in a file that is written whole or not at all.

    Parameters
    ----------
    path : Path
        The file; what it holds is kept if it is of the same setup.
    setup : dict
        What makes the shares comparable.
    play : Play
        Plays what was not played yet.
    """

    def __init__(self, path: Path, setup: dict[str, Any], play: Play) -> None:
        self._path, self._setup, self._play = path, setup, play
        self._known: dict[str, float] = _read(path, setup) if path.exists() else {}

    def measure(self, points: Sequence[Point], cells: Sequence[Cell], seeds: range) -> list[Floats]:
        """Return the shares of each point, float64 arrays of shape (cells, seeds)."""
        plans = [[_runs(cell, point, seeds) for cell in cells] for point in points]
        new = {
            run.digest: run
            for plan in plans
            for runs in plan
            for run in runs
            if run.digest not in self._known
        }
        if new:
            self._play_and_save(list(new.values()))
        return [np.array([[self._known[run.digest] for run in runs] for runs in plan]) for plan in plans]

    def _play_and_save(self, runs: Sequence[Run]) -> None:
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


def _runs(cell: Cell, point: Point, seeds: range) -> list[Run]:
    game = learning_game(cell, point)
    return [Run(digest(game, seed), game, seed, ((FIGURES[cell[0]], ""),)) for seed in seeds]


def _read(path: Path, setup: dict[str, Any]) -> dict[str, float]:
    try:
        content = json.loads(path.read_text())
        found, shares = dict(content["setup"]), dict(content["shares"])
    except (ValueError, TypeError, KeyError) as error:
        raise InputError("out", str(path.parent), f"holds a {path.name} of something else") from error
    if found != setup:
        raise InputError("out", str(path.parent), "holds a fit of another setup: name another, or --fresh")
    return shares
