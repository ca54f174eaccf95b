"""A game that can be paused, stepped, rewound and inspected, for the page and for films.

A step is one control period. Rewinding plays the game again from its beginning, which takes less time than
storing its states.
"""

from collections import deque
from itertools import islice
from threading import RLock
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kswarms.agents.common.arrays import Floats, Integers
from kswarms.agents.robot.state import ACTION
from kswarms.model.description.game import Game
from kswarms.model.game_model import GameModel
from kswarms.model.recorder import policy_rows
from kswarms.scenarios.watch.conflicts import ConflictReader, WatchedConflict
from kswarms.scenarios.watch.robot_view import RobotView, row_of, view_robot

Booleans = NDArray[np.bool_]
MAX_SAMPLES: Final = 400
"""Maximum length of the history; a longer one is thinned to every second sample."""
MAX_CONFLICTS: Final = 5000
"""Number of latest conflicts kept; `kswarms.scenarios.watch.conflicts.conflicts_of` returns all of a run."""
FIRST_INTERVAL: Final = 2.0
"""Initial interval of the samples of the history (s)."""


class Snapshot(NamedTuple):
    """State of a game with n robots present at an instant; the arrays have a row for each robot."""

    time: float  # as `Player.time`
    robots: tuple[int, ...]  # numbers of the robots, ascending
    positions: Floats  # shape (n, 2) (m)
    heading: Floats  # shape (n,) (rad)
    swarm: Integers  # shape (n,), from 0
    in_action: Booleans  # shape (n,): in state A
    carrying: Booleans  # shape (n,): with a puck
    pucks: tuple[int, ...]  # score of each swarm


class Sample(NamedTuple):
    """Intermediate results: a point of each curve of the charts."""

    time: float  # as `Player.time`
    swarms: list[dict[str, Any]]  # as `GameModel.results` returns them
    fights: dict[tuple[int, int], float]
    """Share of robots whose best action is to fight, by their swarm and the swarm learned about, from 1."""


class Player:
    """Plays a game step by step. Its methods are thread-safe.

    `model` is the running game; `seek` replaces it when it rewinds. `conflicts` are the latest conflicts, at
    most `MAX_CONFLICTS`, in the order in which they ended. Without `record_conflicts` there are none,
    which is faster in large games.
    """

    def __init__(self, game: Game, seed: int, record_conflicts: bool = True) -> None:
        self._lock = RLock()
        self._record = "conflicts" if record_conflicts else ""
        self.game = game
        self.seed = seed
        self._start()

    def _start(self) -> None:
        game = self.game.replace(sample_period=self.game.parameters.period)
        self.model = GameModel(game, seed=self.seed, record=self._record)
        self._reader = ConflictReader(self.model)
        self.conflicts: deque[WatchedConflict] = deque(maxlen=MAX_CONFLICTS)
        self._interval = self.model.controller.periods(FIRST_INTERVAL)
        self._steps = 0
        self._history = [self._sample()]

    @property
    def time(self) -> float:
        """Time of the measured game, negative during learning (s)."""
        return self.model.time - self.begin if not self.ended else self.model.duration

    @property
    def begin(self) -> float:
        """Length of the learning phase, after which the measured game begins (s)."""
        controller = self.model.controller
        return controller.seconds(controller.periods(self.game.learning)) if self.game.learning > 0 else 0.0

    @property
    def ended(self) -> str:
        """Reason for the end of the game, empty while it runs."""
        return self.model.ended

    def snapshot(self) -> Snapshot:
        """Return the current state."""
        with self._lock:
            states = self.model.states
            bodies = states.bodies
            return Snapshot(
                self.time,
                tuple(robot.number for robot in self.model.robots),
                states.positions.copy(),
                bodies.heading.copy(),
                bodies.swarm.copy(),
                bodies.phase == ACTION,
                bodies.carrying > 0,
                tuple(self.model.pucks),
            )

    @property
    def history(self) -> list[Sample]:
        """Copy of the samples so far."""
        with self._lock:
            return self._history.copy()

    def view_robot(self, robot: int) -> RobotView | None:
        """Return the current state of a robot, by its number; None if it is absent."""
        with self._lock:
            return view_robot(self.model, robot)

    def advance(self, seconds: float) -> None:
        """Play for a time, rounded to at least one control period, or to the end of the game."""
        with self._lock:
            self._play_to(self._steps + max(1, round(seconds / self.game.parameters.period)))

    def seek(self, time: float) -> None:
        """Go to an instant (s, as `time`), forwards or backwards; stop at the end of the game.

        If files that the game loads have changed, raise `InputError` instead of rewinding; keep the state.
        """
        with self._lock:
            target = round((time + self.begin) / self.game.parameters.period)
            if target < self._steps:
                self._start()
            self._play_to(target)

    def to_next_conflict(self, robot: int) -> None:
        """Play until a robot begins a conflict, leaves, or the game ends."""
        with self._lock:
            begun = self._count_conflicts(robot)
            while begun is not None and not self.ended:
                self._play_to(self._steps + 1)
                # The count restarts at the start of the measured game, so it may decrease.
                before, begun = begun, self._count_conflicts(robot)
                if begun is not None and begun > before:
                    break

    def latest_conflicts(self, robot: int | None, most: int) -> list[WatchedConflict]:
        """Return the latest conflicts of a robot, or of all robots (None), newest first, at most `most`."""
        with self._lock:
            found = (each for each in reversed(self.conflicts) if robot in (None, each.row["robot"]))
            return list(islice(found, most))

    def _count_conflicts(self, robot: int) -> int | None:
        """Return the number of conflicts that a robot has begun; None if it is absent."""
        row = row_of(self.model, robot)
        return None if row is None else sum(self.model.robots[row].conflicts)

    def _play_to(self, step: int) -> None:
        while self._steps < step and not self.ended:
            self.model.step()
            self._steps += 1
            if self._steps % self._interval == 0 or self.ended:
                self._add_sample()
        self.conflicts.extend(self._reader.read())

    def _add_sample(self) -> None:
        self.conflicts.extend(self._reader.read())
        self._history.append(self._sample())
        if len(self._history) > MAX_SAMPLES:
            self._interval *= 2
            self._history = self._history[::2]

    def _sample(self) -> Sample:
        learned = policy_rows(self.model)
        fights = {(row["swarm"], row["opponent"]): row["attack_share"] for row in learned}
        return Sample(self.time, self.model.results(), fights)
