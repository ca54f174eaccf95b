"""State of a game: clock, robots and scores. `GameModel` adds the events."""

import math
from collections.abc import Collection, Mapping, Sequence
from typing import Final, cast

import mesa
import numpy as np
from mesa.experimental.continuous_space import ContinuousSpace

from kswarms.agents.actions import TOWARDS, Action
from kswarms.agents.common.errors import InputError, require_type
from kswarms.agents.robot.clock import Clock
from kswarms.agents.robot.conflict import Conflict
from kswarms.agents.robot.krembot import Krembot
from kswarms.model.clock import rare_garbage_collection
from kswarms.model.description.game import Game
from kswarms.model.mesa_base import MesaModel, Rng
from kswarms.model.population import controller_constants, make_robots, place_robots

_OBJECTS_OF_ROBOT: Final = 100
"""Upper bound of the objects that a new robot consists of."""


class GameState(MesaModel):
    """State of a game. A random stream is determined by the seed of the run, the robot and the purpose.

    Attributes
    ----------
    env : kswarms.agents.robot.clock.Clock
        The clock, an environment of SimPy; it counts control periods.
    actions : sequence of Action
        The actions of the game, the objects that policies choose from.
    arena : Arena
        Walls, stations and bases.
    space : mesa.experimental.continuous_space.ContinuousSpace
        The space of the robots; the kernel works on its array of positions, which is read-only in public.
    states : RobotStates
        State arrays of the robots.
    robots : list of Krembot
        Robots in the game, by number.
    members : list of list of Krembot
        Robots of each swarm in the game.
    removed : list of Krembot
        Robots removed since the current phase began, in the order of their removal.
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
    lost : int
        Pucks that removed robots carried away from the measured game.
    ended : {'', 'time', 'pucks', 'cap'}
        Reason for the end of the game; empty before it.
    conflict_log : list of Conflict, optional
        Closed conflicts that the recorder has not stored yet; None if conflicts are not recorded.
    """

    def __init__(self, game: Game, seed: float | str | None, rng: Rng | None, log_conflicts: bool) -> None:
        require_type("game", game, Game, "must be a Game")
        super().__init__(seed, rng)
        self.game = game
        self.env = Clock()
        self.arena = game.arena(self.seed)
        self.controller = controller_constants(game)
        periods = self.controller.periods
        self.actions: Sequence[Action] = game.action_set
        self.action_periods: Mapping[str, int] = {a.name: periods(a.duration) for a in self.actions}
        # By identity: the hash and the fields of an `Action` are slow to get.
        self.timed_actions: Mapping[int, tuple[bool, int]] = {
            id(a): (a.direction == TOWARDS, self.action_periods[a.name]) for a in self.actions
        }
        self.conflict_log: list[Conflict] | None = [] if log_conflicts else None
        self.game_begin = math.ceil(game.learning / game.parameters.period - 1e-9)
        self.phase = "learning" if self.game_begin > 0 else "game"
        self.ended = ""
        self._end_period: int | None = None
        self._robot_space, self.states = place_robots(game, self.arena, self.seed, self.random)
        self.space: ContinuousSpace = self._robot_space
        self._is_complete = False
        with rare_garbage_collection(_OBJECTS_OF_ROBOT * game.size):
            self._set_robots(make_robots(self, game, self.seed))
        self._is_complete = True
        self._swarm_of = [robot.swarm for robot in self.robots]
        self._reset_scores()

    @property
    def now(self) -> int:
        """Control periods since the start, learning included."""
        return cast(int, self.env.now)

    @property
    def time(self) -> float:
        """Seconds since the start, learning included."""
        return self.controller.seconds(self.now)

    @time.setter
    def time(self, _: float) -> None:
        if hasattr(self, "env"):  # `mesa.Model.__init__` of Mesa 3.5 sets it before there is a clock
            raise AttributeError("the time is that of the clock, model.env, and cannot be set")

    @property
    def duration(self) -> float:
        """Seconds of the measured game so far."""
        now = self.now if self._end_period is None else self._end_period
        return self.controller.seconds(max(0, now - self.game_begin))

    def times(self, swarm: int) -> tuple[list[int], int]:
        """Return T(a) of a swarm, by the swarm of the opponent, and T(p), up to now (robot-periods)."""
        t_a = [0] * len(self.members)
        t_p = 0
        for robot in self.players(swarm):
            t_p += robot.add_times(t_a)
        return t_a, t_p

    def players(self, swarm: int) -> list[Krembot]:
        """Return the robots of a swarm in this phase, including those removed in it, by number."""
        gone = [robot for robot in self.removed if robot.swarm == swarm]
        if not gone:
            return self.members[swarm].copy()
        return sorted(self.members[swarm] + gone, key=lambda robot: robot.number)

    def swarm_of(self, number: int) -> int:
        """Return the swarm of a robot, by its number; both from 0."""
        return self._swarm_of[number]

    def remove(self, robot: mesa.Agent) -> None:
        """Remove a robot from the game; `docs/howto.md` describes what happens.

        Raises
        ------
        InputError
            If it is not a robot in this game.
        """
        if not isinstance(robot, Krembot) or robot.model is not self or not robot.in_game:
            raise InputError("robot", robot, "must be a robot in this game")
        self._take_out([robot])

    def _check_agent(self, agent: mesa.Agent) -> None:
        if isinstance(agent, Krembot) and (self._is_complete or agent.model is not self):
            raise InputError("agent", agent, "must not be a robot: the game has all robots from the start")

    def deregister_agent(self, agent: mesa.Agent) -> None:
        """Deregister an agent; a robot is removed from the game."""
        if isinstance(agent, Krembot):
            self.remove(agent)
        else:
            super().deregister_agent(agent)  # type: ignore[no-untyped-call]

    def _take_out(self, robots: Collection[Krembot]) -> None:
        """Remove robots: they stop, their bodies and pucks vanish, the rows of the others are renumbered."""
        for robot in robots:
            self.lost += robot.carrying
            robot.leave(self.now)
            super().deregister_agent(robot)  # type: ignore[no-untyped-call]
            self._robot_space._remove_agent(robot)
        self.removed += robots
        rest = [robot for robot in self.robots if robot.in_game]
        rows = np.array([robot.index for robot in rest], dtype=np.int64)
        self.states.keep(rows, self._robot_space.positions)
        for row, robot in enumerate(rest):
            robot.index = row
        self._set_robots(rest)

    def _end(self, reason: str) -> None:
        self.ended = reason
        self._end_period = self.now
        for robot in self.robots:
            robot.finish(self.now)

    def _reset_scores(self) -> None:
        self.pucks = [0] * len(self.members)
        self.picked_up = self.lost = 0
        self.removed: list[Krembot] = []
        self.carried_at_start = sum(robot.carrying for robot in self.robots)

    def _set_robots(self, robots: list[Krembot]) -> None:
        self.robots = robots
        swarms = range(len(self.game.swarms))
        self.members = [[robot for robot in robots if robot.swarm == k] for k in swarms]
