"""A game that can be stopped, stepped, wound back and looked into: what the page and the film play.

A step is one control period. Winding back plays the game again from its beginning, which takes less time
than it would to keep what was.
"""

from collections import deque
from collections.abc import Sequence
from itertools import groupby
from threading import RLock
from typing import Any, Final, NamedTuple

import numpy as np

from kswarms.agents.common.arrays import Floats, Integers
from kswarms.agents.robot.state import ACTION
from kswarms.agents.theory.swarms import swarm_utility_difference
from kswarms.model.description.game import Game
from kswarms.model.game_model import GameModel
from kswarms.model.recorder import policy_rows
from kswarms.scenarios.watch.conflicts import Accounts, ConflictAccount
from kswarms.scenarios.watch.robot_view import RobotView, look_into, row_of

MOST_SAMPLES: Final = 400
"""A history of more samples is thinned to half of them."""
MOST_CONFLICTS: Final = 5000
"""Conflicts that are kept; all of a run are in `kswarms.scenarios.watch.conflicts.conflicts_of`."""
FIRST_INTERVAL: Final = 2.0
"""Between two samples of the history, until it is thinned (s)."""


class Picture(NamedTuple):
    """What is seen of a game at an instant.

    Attributes
    ----------
    time : float
        Since the measured game began; negative while the learners learn (s).
    robots : tuple of int, length n
        Numbers of those who are there, ascending.
    positions : ndarray of float64, shape (n, 2)
        (m)
    heading : ndarray of float64, shape (n,)
        (rad)
    swarm : ndarray of int64, shape (n,)
        Counted from 0.
    in_action, carrying : ndarray of bool, shape (n,)
        Whether in state A; whether with a puck.
    pucks : tuple of int
        Score of each swarm.
    """

    time: float
    robots: tuple[int, ...]
    positions: Floats
    heading: Floats
    swarm: Integers
    in_action: np.ndarray[Any, np.dtype[np.bool_]]
    carrying: np.ndarray[Any, np.dtype[np.bool_]]
    pucks: tuple[int, ...]


class Sample(NamedTuple):
    """The curves of a game at an instant, of each swarm.

    Attributes
    ----------
    time : float
        Since the measured game began; negative while the learners learn (s).
    pucks, sud : tuple of int
        Score; Swarm Utility Difference on pucks (Eq. 3.7).
    intra, inter : tuple of float
        Shares of the time spent so far in conflicts within the swarm, and with others; the rest is T(p).
    fights : dict of (int, int) to float
        For each swarm that learns and swarm learned about, both from 1, the share of its robots whose Q is
        greatest for fight.
    """

    time: float
    pucks: tuple[int, ...]
    sud: tuple[int, ...]
    intra: tuple[float, ...]
    inter: tuple[float, ...]
    fights: dict[tuple[int, int], float]


class Player:
    """A game being played; every method may be called from any thread.

    Parameters
    ----------
    game : Game
        What is played.
    seed : int
        Seed of the run, ≥ 0.

    Attributes
    ----------
    game : Game
    seed : int
    model : GameModel
        The game as it stands; another object after `seek` has wound back.
    conflicts : deque of ConflictAccount
        The last that have closed, `MOST_CONFLICTS` at most, in the order in which they did.

    Raises
    ------
    InputError
        If the game cannot be played.
    """

    def __init__(self, game: Game, seed: int) -> None:
        self._lock = RLock()
        self.game = game
        self.seed = seed
        self._start()

    def _start(self) -> None:
        game = self.game.replace(sample_period=self.game.parameters.period)
        self.model = GameModel(game, seed=self.seed, record="conflicts")
        self._accounts = Accounts(self.model)
        self.conflicts: deque[ConflictAccount] = deque(maxlen=MOST_CONFLICTS)
        self._interval = self.model.habits.periods(FIRST_INTERVAL)
        self._steps = 0
        self._history = [self._sample()]

    def close(self) -> None:
        """Let the game go."""
        with self._lock:
            self.model.forget()

    # Where it stands.

    @property
    def time(self) -> float:
        """Since the measured game began; negative while the learners learn (s)."""
        return self.model.time - self.begin if not self.ended else self.model.duration

    @property
    def begin(self) -> float:
        """When the measured game begins (s since the very beginning)."""
        habits = self.model.habits
        return habits.seconds(habits.periods(self.game.learning)) if self.game.learning > 0 else 0.0

    @property
    def ended(self) -> str:
        """Why the game is over, empty while it is not."""
        return self.model.ended

    def picture(self) -> Picture:
        """Return what is seen now."""
        with self._lock:
            fleet = self.model.fleet
            robots = fleet.robots
            return Picture(
                self.time,
                tuple(robot.number for robot in self.model.robots),
                fleet.positions.copy(),
                robots["heading"].copy(),
                robots["swarm"].copy(),
                robots["phase"] == ACTION,
                robots["carrying"] > 0,
                tuple(self.model.pucks),
            )

    @property
    def history(self) -> list[Sample]:
        """The curves so far; playing on does not change what is given."""
        with self._lock:
            return self._history.copy()

    def look_into(self, robot: int) -> RobotView | None:
        """Return what can be seen of a robot now, by its number; None if it is absent."""
        with self._lock:
            return look_into(self.model, robot)

    # Moving on and back.

    def advance(self, seconds: float) -> None:
        """Play on for a time, rounded to whole periods and at least one, or to the end."""
        with self._lock:
            self._play_to(self._steps + max(1, round(seconds / self.game.parameters.period)))

    def seek(self, time: float) -> None:
        """Go to an instant, back or on, or to the end if that comes before.

        Parameters
        ----------
        time : float
            Since the measured game began; negative for an instant of the learning (s).

        Raises
        ------
        InputError
            If it winds back and the game cannot be played any more, as files that it needs have changed; then
            it stands where it was.
        """
        with self._lock:
            target = round((time + self.begin) / self.game.parameters.period)
            if target < self._steps:
                before = self.model
                self._start()
                before.forget()
            self._play_to(target)

    def to_next_conflict(self, robot: int) -> None:
        """Play on until a robot begins a conflict, or leaves, or to the end."""
        with self._lock:
            begun = self._begun(robot)
            while begun is not None and not self.ended:
                self._play_to(self._steps + 1)
                # Fewer than before where the measured game began meanwhile, which counts anew.
                before, begun = begun, self._begun(robot)
                if begun is not None and begun > before:
                    break

    def conflicts_of(self, robot: int | None, most: int) -> list[ConflictAccount]:
        """Return the last conflicts, at most so many, of a robot or (None) of all; the newest first."""
        found: list[ConflictAccount] = []
        with self._lock:
            for account in reversed(self.conflicts):
                if len(found) == most:
                    break
                if robot is None or account.row["robot"] == robot:
                    found.append(account)
        return found

    def _begun(self, robot: int) -> int | None:
        row = row_of(self.model, robot)
        return None if row is None else sum(self.model.robots[row].conflicts)

    def _play_to(self, step: int) -> None:
        while self._steps < step and not self.ended:
            self.model.step()
            self._steps += 1
            if self._steps % self._interval == 0 or self.ended:
                self._keep()
        self.conflicts.extend(self._accounts.take())

    def _keep(self) -> None:
        """Take a sample, and the conflicts since the last."""
        self.conflicts.extend(self._accounts.take())
        self._history.append(self._sample())
        if len(self._history) > MOST_SAMPLES:
            self._interval *= 2
            self._history = self._history[::2]

    def _sample(self) -> Sample:
        model = self.model
        shares = [_shares(*model.times(k), k) for k in range(len(model.members))]
        return Sample(
            self.time,
            tuple(model.pucks),
            tuple(swarm_utility_difference(model.pucks, k) for k in range(len(model.pucks))),
            tuple(intra for intra, _ in shares),
            tuple(inter for _, inter in shares),
            _fights(policy_rows(model)),
        )


def _shares(t_a: Sequence[int], t_p: int, swarm: int) -> tuple[float, float]:
    """Return the shares of time in conflict within the swarm and with others, 0 at the very start."""
    lived = sum(t_a) + t_p
    return (t_a[swarm] / lived, (sum(t_a) - t_a[swarm]) / lived) if lived else (0.0, 0.0)


def _fights(rows: Sequence[dict[str, Any]]) -> dict[tuple[int, int], float]:
    pairs = groupby(rows, key=lambda row: (row["swarm"], row["opponent"]))
    return {pair: next(of_pair)["attack_share"] for pair, of_pair in pairs}
