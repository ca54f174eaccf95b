"""Account of a robot's time: T(a), T(p) and the rewards of conflicts (section 1.5, Algorithm 1)."""

import math
from collections.abc import Callable
from typing import Any, cast

from mesa.experimental.continuous_space import ContinuousSpaceAgent
from numpy.typing import ArrayLike

from kswarms.agents.common.arrays import Floats
from kswarms.agents.common.errors import InputError
from kswarms.agents.policies.interface import LearningPolicy, Policy
from kswarms.agents.robot.conflict import Conflict
from kswarms.agents.robot.host import Host
from kswarms.agents.robot.state import ACTION


class TimedAgent(ContinuousSpaceAgent):
    """An agent in continuous space that measures its times of action and program, and learns from them.

    `index` is its row in the state arrays, −1 after its removal: it then keeps its scores and a copy of its
    last state. The policy's method ``learn``, if there is one, is called at the end of each conflict.
    """

    # Slots, here and in `Krembot`, are faster than a dict of more than thirty attributes.
    __slots__ = (
        "_active", "_env", "_is_open", "_is_over", "_learn", "_log", "_open", "_open_t_a",
        "_opponent_swarm", "_period", "_phase", "_settles", "_since", "_states", "conflicts", "index",
        "policy", "t_a", "t_p",
    )

    def __init__(self, model: Host, index: int, policy: Policy, swarms: int) -> None:
        self._states = model.states
        self.index = index
        super().__init__(model.space, cast(Any, model))
        self.policy = policy
        self.t_a = [0] * swarms  # periods of completed actions, by the opponent's swarm
        self.t_p = 0  # periods of completed program
        self.conflicts = [0] * swarms  # number of conflicts begun, by the opponent's swarm
        self._env = model.env
        self._phase = model.states.phase
        self._period = model.controller.period
        self._learn: Callable[[float, float, int], tuple[float, float]] | None
        self._learn = getattr(policy, "learn", None)
        self._log = model.conflict_log
        self._settles = self._learn is not None or self._log is not None  # whether conflicts stay open
        self._since = int(model.env.now)  # start of the current action or program (periods)
        self._is_over = False  # whether the game has ended
        self._is_open = False  # whether a conflict is open, to be learned from or logged
        self._active = 0  # number of active sensors at the start of the latest conflict
        self._opponent_swarm = -1  # swarm of the opponent of the latest conflict
        self._open: tuple[Any, ...] = ()  # first fields of the open `Conflict`, if conflicts are logged
        self._open_t_a = 0  # T(a) of the latest conflict (periods)

    @property
    def in_game(self) -> bool:
        """Whether the robot is in the game."""
        return self.index >= 0

    @property
    def position(self) -> Floats:
        """Centre (m), ndarray of float64, shape (2,): a read-only view that follows the robot.

        Assign an array to move the robot to a free place; `InputError` if it would overlap a robot or a wall.
        """
        place: Floats = self._states.positions[self.index]
        place.flags.writeable = False
        return place

    @position.setter
    def position(self, place: ArrayLike) -> None:
        if not self.in_game:
            raise InputError("position", place, "cannot be set: the robot was removed from the game")
        controller = cast(Host, self.model).controller
        self._states.move(self.index, place, controller.half, controller.radius)

    @property
    def pos(self) -> Floats:
        """The same as `position`: the name in Mesa's other spaces."""
        return self.position

    @pos.setter
    def pos(self, place: ArrayLike | None) -> None:
        if place is not None:  # Mesa sets None when it creates an agent
            self.position = place

    def remove(self) -> None:
        """Remove the robot from the game, as `GameModel.remove` does; nothing happens if it was removed."""
        if self.in_game:
            cast(Host, self.model).remove(self)

    def leave(self, now: int) -> None:
        """Stop at `now` (periods): close the open conflict and keep a copy of the state."""
        self.finish(now)
        self._states = self._states.copy_row(self.index)
        self._phase = self._states.phase
        self.index = -1  # the only row of the copy
        self.space = None  # type: ignore[assignment]  # as in Mesa

    @property
    def state(self) -> str:
        """``A`` while resolving a conflict, else ``P``."""
        return "A" if self._phase[self.index] == ACTION else "P"

    def times(self) -> tuple[list[int], int]:
        """Return T(a) by the opponent's swarm and T(p) up to now (periods)."""
        t_a = [0] * len(self.t_a)
        return t_a, self.add_times(t_a)

    def add_times(self, t_a: list[int]) -> int:
        """Add T(a) up to now to `t_a`, by the opponent's swarm; return T(p) up to now (periods)."""
        for swarm, periods in enumerate(self.t_a):
            t_a[swarm] += periods
        running = 0 if self._is_over else int(self._env.now) - self._since
        if self._phase[self.index] != ACTION:
            return self.t_p + running
        t_a[self._opponent_swarm] += running
        return self.t_p

    def close(self, now: int, learn: bool = True) -> None:
        """Count the time up to `now` (periods) and close the open conflict.

        `learn` is False at the end of a phase: the policy does not learn from an unfinished conflict.
        """
        elapsed = now - self._since
        self._since = now
        if self._phase[self.index] == ACTION:  # interrupted action: no program time
            self.t_a[self._opponent_swarm] += elapsed
            self._open_t_a = elapsed
            elapsed = 0
        self.t_p += elapsed
        if self._is_open:
            self._is_open = False
            reward = value = math.nan
            if learn and self._learn is not None:
                period = self._period
                reward, value = self._learn(self._open_t_a * period, elapsed * period, self._active)
            if self._log is not None:
                self._log.append(Conflict._make((*self._open, self._open_t_a, elapsed, reward, value)))

    def restart(self, now: int) -> None:
        """Reset times and conflicts to 0 and stop learning."""
        self.close(now, learn=False)
        self.t_a = [0] * len(self.t_a)
        self.t_p = 0
        self.conflicts = [0] * len(self.conflicts)
        if self._learn is not None:
            self._learn = None
            self._settles = self._log is not None
            cast(LearningPolicy, self.policy).freeze()

    def finish(self, now: int) -> None:
        """End the game: close the open conflict and stop counting."""
        if not self._is_over:
            self.close(now, learn=False)
            self._is_over = True
