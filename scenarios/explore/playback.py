"""Playback of a game in real time or as fast as possible, independent of the page."""

import math
import time as clock
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.watch.player import Player

SPEEDS: Final = (1, 2, 5, 10, 20, 50, 100)
"""Playback speeds: seconds of the game per second."""
_BURST: Final = 0.2
"""Maximum time of playing at full speed before the page is updated (s)."""
_STRIDE: Final = 5.0
"""Time of the game that is played at full speed before the clock is checked (s)."""


class Playback:
    """A game that is played, paused and rewound."""

    def __init__(self, player: Player) -> None:
        self.player = player
        self.playing = False
        self.speed = 10  # one of `SPEEDS`
        self.goal: float | None = None  # play at full speed up to this instant (s, as `Player.time`)
        self.error = ""  # the latest error in one line, empty if there is none
        self._failed = False
        self._transient = False  # whether `reset` and `go_to` clear the error
        self._owed = 0.0  # game time not yet played, less than a period (s)

    def restart(self, player: Player) -> None:
        """Replace the game by another one, which starts at its beginning."""
        self.player = player
        self.error = ""
        self._failed = False
        self.goal = None
        self._owed = 0.0

    def close(self) -> None:
        """Stop the game."""
        self.playing = False

    @contextmanager
    def report_errors(self, transient: bool = False) -> Iterator[None]:
        """Store errors in `error`; `reset` and `go_to` clear a transient error."""
        try:
            yield
        except InputError as error:
            self.error = str(error)
            self._transient = transient
        except (Exception, SystemExit) as error:  # noqa: BLE001  # user-defined policies may raise anything
            self._failed = self._transient = True
            self.error = f"the game failed: {type(error).__name__}: {error}"

    @property
    def active(self) -> bool:
        """Whether `tick` moves the game."""
        if self._failed:
            return False
        return self.goal is not None or (self.playing and not self.player.ended)

    def toggle(self) -> None:
        """Start or pause the game."""
        self.playing = not self.playing
        self._owed = 0.0

    def step(self) -> None:
        """Pause, and play one control period."""
        self.playing = False
        with self.report_errors():
            self.player.advance(0.0)

    def reset(self) -> None:
        """Rewind to the beginning of the learning phase."""
        self.goal = None
        with self.report_errors(transient=True):
            self.player.seek(-self.player.begin)
            self._failed = False
            if self._transient:
                self.error = ""

    def go_to(self, time: float) -> None:
        """Go to an instant at full speed, during the next calls of `tick`."""
        with self.report_errors(transient=True):
            if not math.isfinite(time):
                raise InputError("t", time, "must be a finite number of seconds")
            if time < self.player.time:
                self.reset()
            elif self._transient and not self._failed:
                self.error = ""
            self.goal = time

    def next_conflict(self, robot: int) -> None:
        """Pause, and play until a robot begins a conflict."""
        self.playing = False
        with self.report_errors():
            self.player.to_next_conflict(robot)

    def tick(self, elapsed: float) -> bool:
        """Move the game after a time (s) since the last call; return whether it has moved."""
        player = self.player
        if not self.active:
            return False
        if self.goal is not None:
            self._play_at_full_speed(player, self.goal)
            return True
        self._owed += elapsed * self.speed
        period = player.game.parameters.period
        due = int(self._owed / period + 1e-9) * period
        if due == 0.0:
            return False
        self._owed -= due
        with self.report_errors():
            player.advance(due)
        return True

    def _play_at_full_speed(self, player: Player, goal: float) -> None:
        deadline = clock.monotonic() + _BURST
        with self.report_errors():
            while player.time < goal and not player.ended and clock.monotonic() < deadline:
                player.seek(min(goal, player.time + _STRIDE))
        if self.goal == goal and (player.time >= goal or player.ended):
            self.goal = None
