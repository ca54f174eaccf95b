"""The robot: a Mesa agent in continuous space, driven by SimPy events (section 2.3).

Every leg, turn, flight and fight is one SimPy event, a `Timer`. At its end, the phase of the robot tells the
kernel that a decision is due; the robot decides after the next percepts.
"""

import math
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, Final

import numpy as np
from simpy.events import NORMAL, Event

from kswarms.agents.actions import TOWARDS, Action
from kswarms.agents.body import SENSORS
from kswarms.agents.common.errors import InputError
from kswarms.agents.policies.interface import Policy
from kswarms.agents.robot.host import Host
from kswarms.agents.robot.sensing import ANGLES_OF, heads_for, read_sensors, walls_met, wrap
from kswarms.agents.robot.state import ACTION, HOME, HOME_TURN, HOMING_ERROR, IDLE, LEG, LEG_OVER, TURN
from kswarms.agents.robot.time_account import TimedAgent
from kswarms.agents.streams import Purpose, Streams

_STRAIGHT: Final = 1e-9  # smaller turns are skipped (rad)
_ROUNDING: Final = 1e-9  # rounding error of a number of periods


class Krembot(TimedAgent):
    """Behaviour of one robot. Time accounting is in `TimedAgent`.

    `number` is its number in the game and `swarm` its swarm, both from 0; `index` is its row in the state
    arrays (removed robots are skipped). In a period it drives `stride_program` in state P and `stride_action`
    in state A (m). `actions`, if given, are the only allowed choices of a user-defined policy.
    """

    __slots__ = (
        "_action_end", "_action_periods", "_allowed", "_controller", "_drive_periods", "_flights",
        "_generator", "_headings", "_leg_times", "_opponent", "_stride", "_stride_action",
        "_stride_program", "_ties", "_timed_actions", "_timer", "_turn_rate", "_turn_step", "_turns",
        "number", "policy_name", "pucks", "swarm",
    )

    def __init__(
        self,
        model: Host,
        number: int,
        swarm: int,
        policy: Policy,
        policy_name: str,
        streams: Streams,
        stride_program: float,
        stride_action: float,
        swarms: int,
        actions: Sequence[Action] | None = None,
    ) -> None:
        super().__init__(model, number, policy, swarms)
        self.number = number
        self.swarm = swarm
        self.policy_name = policy_name
        self.pucks = 0  # number of deposited pucks
        self._generator = streams.generator
        self._allowed = actions
        self._opponent = model.states.opponent
        self._stride = model.states.stride
        self._turn_rate = model.states.turn_rate
        self._controller = model.controller
        self._turn_step = model.controller.turn_step
        limit = model.controller.wander_turn
        self._leg_times = streams.draws(Purpose.LEG, "exponential", model.controller.leg_mean)
        self._turns = streams.draws(Purpose.WANDER, "uniform", -limit, limit)
        self._headings = streams.draws(Purpose.WALL, "uniform", -math.pi, math.pi)
        self._ties = streams.draws(Purpose.VACANT, "random")
        self._flights = _flights(self._turn_step)
        self._action_periods = model.action_periods
        self._timed_actions = model.timed_actions
        self._stride_program = stride_program
        self._stride_action = stride_action
        self._timer = Timer(self)
        self._drive_periods = 0  # duration of the drive of the latest action
        self._action_end = 0  # end of the latest action, unless it is interrupted (periods)

    @property
    def carrying(self) -> bool:
        """Whether the robot carries a puck."""
        return bool(self._states.carrying[self.index])

    @property
    def heading(self) -> float:
        """Heading (rad)."""
        return float(self._states.heading[self.index])

    # The program.

    def pick_up(self) -> None:
        """Take a puck."""
        self._states.carrying[self.index] = 1

    def deposit(self) -> None:
        """Put the puck down at the own base. If the robot was driving home, a decision is due."""
        index = self.index
        self._states.carrying[index] = 0
        self.pucks += 1
        if self._phase[index] in (HOME, HOME_TURN):
            self._free_timer()
            self._phase[index] = IDLE

    def begin_leg(self) -> None:
        """Wander straight ahead for an exponential duration."""
        self._drive(LEG, self._stride_program)
        self._set_timer(self._controller.periods(next(self._leg_times)), _LEG_OVER)

    def begin_wander_turn(self) -> None:
        """Turn in place by a uniform angle."""
        self._turn(TURN, next(self._turns))

    def begin_wall_turn(self) -> None:
        """Turn in place to a heading drawn uniformly from those without a wall ahead."""
        controller = self._controller
        x, y = self._states.positions[self.index].tolist()
        heading = self.heading
        arena = controller.half, controller.wall_reach, controller.wall_half_angle
        met = walls_met(x, y, heading, *arena)
        while True:
            target = next(self._headings)
            if not (heads_for(target, met) if controller.escape_away else walls_met(x, y, target, *arena)):
                break
        self._turn(TURN, wrap(target - heading))

    def go_home(self, error: float) -> None:
        """Turn towards the own base if the heading is off by `error` (rad), else drive to it."""
        if abs(error) > HOMING_ERROR:
            self._turn(HOME_TURN, error)
        else:
            self._free_timer()
            self._drive(HOME, self._stride_program)

    # The conflict.

    def meet(self, now: int, opponent: "Krembot", angle: float, active: int, vacant: int) -> None:
        """Begin a conflict at `now` (periods) and close the previous one.

        `opponent` is the robot ahead and `angle` its bearing (rad); the policy gets only its swarm. `active`
        is the number of active sensors, n'_i of Eq. 5.4. `vacant` has the bits of the most vacant sensors.
        If the policy removes one of the two robots, no conflict begins.
        """
        # Nearly all decisions are conflicts, so `_turn`, `_drive` and `_set_timer` are inlined here.
        timer = self._timer
        if self._is_open or timer.callbacks is not None:
            self.close(now)
            if self.index < 0:
                return
        else:  # `close` inlined, without an action or an open conflict
            self.t_p += now - self._since
            self._since = now
        swarm = opponent.swarm
        action = self.policy.choose(swarm)
        if self._allowed is not None and action not in self._allowed:
            rule = f"choose({swarm}) must return an action of the game, not {action!r}"
            raise InputError("policy", self.policy_name, rule)
        index, other = self.index, opponent.index
        if index < 0 or other < 0:
            return
        self._opponent[index] = other
        if self._log is not None:
            x, y = self._states.positions[index].tolist()
            seen = self._sensed_robots(other)
            self._open = (self.number, opponent.number, now, x, y, action, active, seen)
        self._opponent_swarm = swarm
        self._active = active
        self._is_open = self._settles
        self.conflicts[swarm] += 1
        if timer.callbacks is not None:
            timer = self._free_timer()
        try:
            is_fight, drive = self._timed_actions[id(action)]
        except KeyError:  # an equal action
            is_fight, drive = action.direction == TOWARDS, self._action_periods[action.name]
        if is_fight:
            straight = -_STRAIGHT <= angle <= _STRAIGHT
            turn = 0 if straight else math.ceil(abs(angle) / self._turn_step - _ROUNDING) or 1
            rate = 0.0 if straight else angle / turn
        else:
            flights = self._flights[vacant]
            n = len(flights)
            turn, rate = flights[0] if n == 1 else flights[int(next(self._ties) * n)]
        self._phase[index] = ACTION
        self._turn_rate[index] = rate
        self._action_end = now + turn + drive
        if turn:
            self._stride[index] = 0.0
            self._drive_periods = drive
            timer.callbacks = _TURNED_TO_DRIVE
            self._env.schedule(timer, NORMAL, turn)
        else:
            self._stride[index] = self._stride_action
            timer.callbacks = _ACTION_OVER
            self._env.schedule(timer, NORMAL, drive)

    def restart(self, now: int) -> None:
        """Begin the measured game: reset pucks, times and conflicts to 0 and stop learning."""
        super().restart(now)
        self.pucks = 0

    def finish(self, now: int) -> None:
        """End the game: close the open conflict and cancel the timeout."""
        super().finish(now)
        self._free_timer()

    def leave(self, now: int) -> None:
        """Stop at `now` (periods); only a copy of the state is written afterwards."""
        super().leave(now)
        self._opponent, self._stride = self._states.opponent, self._states.stride
        self._turn_rate = self._states.turn_rate

    def _sensed_robots(self, met: int) -> tuple[int, ...]:
        """Return the numbers of the robots that the sensors read at the start of a conflict."""
        states, controller = self._states, self._controller
        bodies = states.bodies
        forward = bodies.forward_x[self.index], bodies.forward_y[self.index]
        nearest, read = np.full(SENSORS, controller.active_range), np.full(SENSORS, -1)
        arena = controller.radius, controller.half
        read_sensors(self.index, met, *forward, bodies.x, bodies.y, *arena, nearest, read)
        return tuple(states.numbers[row] for row in read.tolist() if row >= 0)

    def _drive(self, phase: int, stride: float) -> None:
        index = self.index
        self._phase[index] = phase
        self._stride[index] = stride
        self._turn_rate[index] = 0.0

    def _turn(self, phase: int, angle: float) -> None:
        """Turn in place in whole periods. A decision is due afterwards."""
        index = self.index
        periods = math.ceil(abs(angle) / self._turn_step - _ROUNDING) or 1
        self._phase[index] = phase
        self._stride[index] = 0.0
        self._turn_rate[index] = angle / periods
        self._set_timer(periods, _TURN_OVER)

    def _set_timer(self, periods: int, callbacks: "Callbacks") -> None:
        """Call `callbacks` after some periods."""
        timer = self._free_timer()
        timer.callbacks = callbacks
        self._env.schedule(timer, NORMAL, periods)

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

    def __init__(self, robot: Krembot) -> None:
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
    timer.callbacks = _ACTION_OVER
    timer.env.schedule(timer, NORMAL, robot._drive_periods)


def _end_action(timer: Timer) -> None:
    robot = timer.robot
    now = robot._action_end
    elapsed = robot._open_t_a = now - robot._since
    robot.t_a[robot._opponent_swarm] += elapsed
    robot._since = now
    robot._phase[robot.index] = IDLE


Callbacks = list[Callable[[Any], None]]
_LEG_OVER: Final[Callbacks] = [_end_leg]
_TURN_OVER: Final[Callbacks] = [_end_turn]
_TURNED_TO_DRIVE: Final[Callbacks] = [_drive_after_turn]
_ACTION_OVER: Final[Callbacks] = [_end_action]


@cache
def _flights(turn_step: float) -> list[list[tuple[int, float]]]:
    """Return the turns to each of the most vacant sensors, by their bits: periods and turn rate (rad)."""
    turns: list[list[tuple[int, float]]] = []
    for angles in ANGLES_OF:
        turns.append([])
        for angle in angles:
            if abs(angle) > _STRAIGHT:
                periods = math.ceil(abs(angle) / turn_step - _ROUNDING) or 1
                turns[-1].append((periods, angle / periods))
            else:
                turns[-1].append((0, 0.0))
    return turns
