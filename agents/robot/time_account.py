"""Account of a robot's time: T(a), T(p), and what each conflict was worth (section 1.5, Algorithm 1)."""

import math
from collections.abc import Callable
from typing import Any, cast

from mesa.experimental.continuous_space import ContinuousSpaceAgent

from kswarms.agents.policies.interface import LearningPolicy, Policy
from kswarms.agents.robot.conflict import Conflict
from kswarms.agents.robot.host import World
from kswarms.agents.robot.state import ACTION


class TimedAgent(ContinuousSpaceAgent):
    """An agent in continuous space that is in action or in program, and learns from how long it was.

    Parameters
    ----------
    model : World
        The Mesa model that it lives in.
    index : int
        Its row in the fleet.
    policy : Policy
        If it has a method ``learn``, it is told how each conflict ended.
    swarms : int
        Number of swarms in the game.

    Attributes
    ----------
    t_a : list of int, length `swarms`
        Periods of action, by the opponent's swarm; of actions that have ended.
    t_p : int
        Periods of program; of those that have ended.
    conflicts : list of int, length `swarms`
        Conflicts begun, by the opponent's swarm.
    """

    # Slots, here and in `Krembot`: every conflict reads and writes many of them, and beyond thirty attributes
    # a dict no longer finds them at once.
    __slots__ = (
        *("index", "policy", "t_a", "t_p", "conflicts", "_env", "_phase", "_period", "_learn", "_log"),
        *("_since", "_is_open", "_is_over", "_active", "_opponent_swarm", "_open", "_open_t_a"),
    )

    def __init__(self, model: World, index: int, policy: Policy, swarms: int) -> None:
        super().__init__(model.space, cast(Any, model))
        self.index = index
        self.policy = policy
        self.t_a = [0] * swarms
        self.t_p = 0
        self.conflicts = [0] * swarms
        self._env = model.env
        self._phase = model.fleet.phase
        self._period = model.habits.period
        self._learn: Callable[[float, float, int], tuple[float, float]] | None
        self._learn = getattr(policy, "learn", None)
        self._log = model.conflict_log
        self._since = int(model.env.now)
        """When the current action or program began."""
        self._is_open = False
        """Whether a conflict waits to be closed."""
        self._is_over = False
        """Whether its game has ended."""
        self._active = 0
        """Sensors that were active when it began."""
        self._opponent_swarm = -1
        """Swarm of the robot met last."""
        self._open: tuple[Any, ...] = ()
        """First fields of the open `Conflict`, if conflicts are logged."""
        self._open_t_a = 0

    @property
    def state(self) -> str:
        """``A`` while it resolves a conflict, else ``P``."""
        return "A" if self._phase[self.index] == ACTION else "P"

    def times(self) -> tuple[list[int], int]:
        """Return T(a) by the opponent's swarm and T(p) up to now (periods)."""
        t_a, t_p = self.t_a.copy(), self.t_p
        running = 0 if self._is_over else int(self._env.now) - self._since
        if self._phase[self.index] == ACTION:
            t_a[self._opponent_swarm] += running
        else:
            t_p += running
        return t_a, t_p

    def close(self, now: int, learn: bool = True) -> None:
        """Count the time up to `now` (periods) and end the open conflict.

        Parameters
        ----------
        now : int
            The time (periods).
        learn : bool
            Whether the policy is told; not where the end is not the next conflict, but that of the phase.
        """
        elapsed = now - self._since
        self._since = now
        if self._phase[self.index] == ACTION:  # overtaken: no program time
            self.t_a[self._opponent_swarm] += elapsed
            self._open_t_a = elapsed
            elapsed = 0
        self.t_p += elapsed
        if self._is_open:
            self._is_open = False
            if self._learn is not None or self._log is not None:
                self._settle(elapsed, learn)

    def _settle(self, t_p: int, learn: bool) -> None:
        """Reward the conflict that ends with T(p) = `t_p` (periods), and log it."""
        reward = value = math.nan
        if learn and self._learn is not None:
            period = self._period
            reward, value = self._learn(self._open_t_a * period, t_p * period, self._active)
        if self._log is not None:
            self._log.append(Conflict._make((*self._open, self._open_t_a, t_p, reward, value)))

    def restart(self, now: int) -> None:
        """Count times and conflicts from 0; nothing more is learned."""
        self.close(now, learn=False)
        self.t_a = [0] * len(self.t_a)
        self.t_p = 0
        self.conflicts = [0] * len(self.conflicts)
        if self._learn is not None:
            self._learn = None
            cast(LearningPolicy, self.policy).freeze()

    def finish(self, now: int) -> None:
        """Count no more."""
        self.close(now, learn=False)
        self._is_over = True

    def _begin(self, swarm: int, active: int, about: tuple[Any, ...]) -> None:
        """Open a conflict with a robot of `swarm`; `about` it is what the log is told."""
        self._opponent_swarm = swarm
        self._is_open = True
        self._active = active
        self._open = about
        self.conflicts[swarm] += 1

    def _end_action(self) -> None:
        """Count the action that ends now; what follows is program."""
        now: int = self._env.now  # type: ignore[assignment]  # whole periods; `cast` would cost a call
        elapsed = self._open_t_a = now - self._since
        self.t_a[self._opponent_swarm] += elapsed
        self._since = now
