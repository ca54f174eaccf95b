"""Driving of a robot: legs, turns and drives that end with an event of SimPy."""

import math
from collections.abc import Callable
from functools import lru_cache
from typing import Any, Final

from simpy.events import NORMAL, Event

from kswarms.agents.policies.interface import Policy
from kswarms.agents.robot.host import Host
from kswarms.agents.robot.sensing import ANGLES_OF
from kswarms.agents.robot.state import IDLE, LEG_OVER
from kswarms.agents.robot.time_account import TimedAgent

STRAIGHT: Final = 1e-9  # smaller turns are skipped (rad)
_ROUNDING: Final = 1e-9  # rounding error of a number of periods

Callbacks = list[Callable[[Any], None]]
Turn = tuple[int, float]
"""Duration of a turn in place (periods) and turn rate (rad)."""


class Driver(TimedAgent):
    """An agent that drives and turns in place in whole periods.

    In a period it drives `stride_program` in state P and `stride_action` in state A (m).
    """

    __slots__ = (
        "_action_end", "_flights", "_later", "_opponent", "_order", "_push", "_stride", "_stride_action",
        "_stride_program", "_timer", "_turn_rate", "_turn_step",
    )

    def __init__(
        self,
        model: Host,
        index: int,
        policy: Policy,
        swarms: int,
        stride_program: float,
        stride_action: float,
    ) -> None:
        super().__init__(model, index, policy, swarms)
        self._push = model.env.push
        self._later = model.env.later
        self._order = model.env.order
        self._opponent = model.states.opponent
        self._stride = model.states.stride
        self._turn_rate = model.states.turn_rate
        self._turn_step = model.controller.turn_step
        self._flights = _flights(self._turn_step)
        self._stride_program = stride_program
        self._stride_action = stride_action
        self._timer = Timer(self)
        self._action_end = 0  # end of the latest action, unless it is interrupted (periods)

    def finish(self, now: int) -> None:
        """End the game: close the open conflict and cancel the event."""
        super().finish(now)
        self._free_timer()

    def leave(self, now: int) -> None:
        """Stop at `now` (periods); only a copy of the state is written afterwards."""
        super().leave(now)
        self._opponent, self._stride = self._states.opponent, self._states.stride
        self._turn_rate = self._states.turn_rate

    def _drive(self, phase: int, stride: float) -> None:
        index = self.index
        self._phase[index] = phase
        self._stride[index] = stride
        self._turn_rate[index] = 0.0

    def _turn(self, phase: int, angle: float) -> None:
        """Turn in place in whole periods. A decision is due afterwards."""
        index = self.index
        periods, rate = turn_of(angle, self._turn_step)
        self._phase[index] = phase
        self._stride[index] = 0.0
        self._turn_rate[index] = rate
        self._set_timer(periods, END_TURN)

    def _set_timer(self, periods: int, callbacks: Callbacks) -> None:
        """Call `callbacks` after some periods."""
        timer = self._free_timer()
        timer.callbacks = callbacks
        end = int(self._env.now) + periods
        self._push(self._env.queue_of(end), (end, NORMAL, next(self._order), timer))

    def _free_timer(self) -> "Timer":
        """Cancel the current leg, turn or drive, if there is one, and return a timer that can be set."""
        timer = self._timer
        if timer.callbacks is not None:
            # SimPy cannot remove an event from its queue, so this one stays there, without an effect.
            timer.callbacks = []
            timer = self._timer = Timer(self)
        return timer


class Timer(Event):
    """Reusable event of a robot at the end of a leg, turn or drive; `callbacks` is None unless it is set.

    The lists of callbacks are shared by all robots, which is faster than a new list for each event.
    """

    __slots__ = ("callbacks", "env", "robot")

    _ok = True
    _value = None

    def __init__(self, robot: Driver) -> None:
        self.env = robot._env
        self.robot = robot
        self.callbacks = None  # type: ignore[assignment]  # as SimPy does with processed events


def _end_leg(timer: Timer) -> None:
    robot = timer.robot
    robot._phase[robot.index] = LEG_OVER


def _end_turn(timer: Timer) -> None:
    robot = timer.robot
    robot._phase[robot.index] = IDLE


def _drive_after_turn(timer: Timer) -> None:
    robot = timer.robot
    index = robot.index
    robot._stride[index] = robot._stride_action
    robot._turn_rate[index] = 0.0
    timer.callbacks = END_ACTION
    end = robot._action_end
    robot._push(robot._later[end], (end, NORMAL, next(robot._order), timer))


def _end_action(timer: Timer) -> None:
    robot = timer.robot
    now = robot._action_end
    elapsed = robot._open_t_a = now - robot._since
    robot.t_a[robot._opponent_swarm] += elapsed
    robot._since = now
    robot._phase[robot.index] = IDLE


END_LEG: Final[Callbacks] = [_end_leg]
END_TURN: Final[Callbacks] = [_end_turn]
START_DRIVE: Final[Callbacks] = [_drive_after_turn]
END_ACTION: Final[Callbacks] = [_end_action]


def turn_of(angle: float, turn_step: float) -> Turn:
    """Return the turn by an angle, at most `turn_step` in a period (rad); it takes at least one period."""
    periods = math.ceil(abs(angle) / turn_step - _ROUNDING) or 1
    return periods, angle / periods


@lru_cache(maxsize=8)
def _flights(turn_step: float) -> list[list[Turn]]:
    """Return the turns to each of the most vacant sensors, by the bits of these sensors."""

    def flight(angle: float) -> Turn:
        return turn_of(angle, turn_step) if abs(angle) > STRAIGHT else (0, 0.0)

    return [[flight(angle) for angle in angles] for angles in ANGLES_OF]
