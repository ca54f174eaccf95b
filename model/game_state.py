"""State of a game: clock, robots and scores. `GameModel` adds the events."""

import math
from collections.abc import Mapping
from typing import cast

import mesa
import numpy as np
import simpy

from kswarms.agents.common.errors import InputError
from kswarms.agents.robot.conflict import Conflict
from kswarms.agents.robot.krembot import Krembot
from kswarms.model.description.game import Game
from kswarms.model.population import controller_constants, make_robots, place_robots, remove_robots


class GameState(mesa.Model):
    """State of a game. A random stream is determined by the seed of the run, the robot and the purpose.

    Attributes
    ----------
    env : simpy.Environment
        The clock; it counts control periods.
    arena : Arena
        Walls, stations and bases.
    space : mesa.experimental.continuous_space.ContinuousSpace
        Positions of the robots; the kernel works on the same array.
    states : RobotStates
        State arrays of the robots.
    robots : list of Krembot
        Robots in the game, by number.
    members : list of list of Krembot
        Robots of each swarm.
    game_begin : int
        Control period in which the measured game begins; 0 without a learning phase.
    phase : {'learning', 'game'}
        The scores are reset when the measured game begins.
    pucks : list of int
        Pucks deposited by each swarm.
    picked_up : int
        Pucks picked up by all robots in the measured game.
    carried_at_start : int
        Pucks carried when the measured game began.
    ended : {'', 'time', 'pucks', 'cap'}
        Reason for the end of the game; empty before it.
    conflict_log : list of Conflict, optional
        Closed conflicts that the recorder has not stored yet; None if conflicts are not recorded.
    """

    def __init__(self, game: Game, seed: int, log_conflicts: bool) -> None:
        if not isinstance(seed, int | np.integer) or isinstance(seed, bool) or seed < 0:
            raise InputError("seed", seed, "must be a whole number ≥ 0")
        super().__init__(seed=int(seed))
        self.game = game
        self.seed = int(seed)
        self.env = simpy.Environment()
        self.arena = game.arena(self.seed)
        self.controller = controller_constants(game)
        periods = self.controller.periods
        self.action_periods: Mapping[str, int] = {a.name: periods(a.duration) for a in game.action_set}
        self.conflict_log: list[Conflict] | None = [] if log_conflicts else None
        self.game_begin = math.ceil(game.learning / game.parameters.period - 1e-9)
        self.phase = "learning" if self.game_begin > 0 else "game"
        self.ended = ""
        self._end_period: int | None = None
        self.space, self.states = place_robots(game, self.arena, self.seed, self.random)
        self._set_robots(make_robots(self, game, self.seed))
        if game.absent_from == "learning" or self.game_begin == 0:
            self._remove_absent()
        self._reset_scores()

    @property
    def now(self) -> int:
        """Control periods since the start, learning included."""
        return cast(int, self.env.now)

    @property
    def time(self) -> float:
        """Seconds since the start, learning included."""
        return self.controller.seconds(self.now)

    @property
    def duration(self) -> float:
        """Seconds of the measured game so far."""
        now = self.now if self._end_period is None else self._end_period
        return self.controller.seconds(max(0, now - self.game_begin))

    def times(self, swarm: int) -> tuple[list[int], int]:
        """Return T(a) of a swarm, by the swarm of the opponent, and T(p), up to now (robot-periods)."""
        t_a = [0] * len(self.members)
        t_p = 0
        for robot in self.members[swarm]:
            own_t_a, own_t_p = robot.times()
            t_a = [a + b for a, b in zip(t_a, own_t_a, strict=True)]
            t_p += own_t_p
        return t_a, t_p

    def forget(self) -> None:
        """Remove this model from Mesa's class-level registry, so that it can be freed."""
        mesa.Agent._ids.pop(self, None)

    def _begin_measured_game(self) -> None:
        """Remove robots that only learn, and reset the scores."""
        if self.game.absent_from == "game":
            self._remove_absent()
        self.phase = "game"
        self._reset_scores()

    def _end(self, reason: str) -> None:
        self.ended = reason
        self._end_period = self.now
        for robot in self.robots:
            robot.finish(self.now)

    def _reset_scores(self) -> None:
        self.pucks = [0] * len(self.members)
        self.picked_up = 0
        self.carried_at_start = sum(robot.carrying for robot in self.robots)

    def _remove_absent(self) -> None:
        if self.game.absent:
            self._set_robots(remove_robots(self, self.robots, self.game.absent))

    def _set_robots(self, robots: list[Krembot]) -> None:
        self.robots = robots
        swarms = range(len(self.game.swarms))
        self.members = [[robot for robot in robots if robot.swarm == k] for k in swarms]
        self._swarm_of = [robot.swarm for robot in robots]
