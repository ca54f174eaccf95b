"""The robot: a Mesa agent in continuous space, driven by SimPy events (section 2.3).

Every leg, turn, flight and fight is one SimPy timeout. At its end, the phase of the robot tells the kernel
that a decision is due; the robot decides after the next percepts. `_timer` is the current timeout. The
callback of an interrupted timeout does nothing.
"""

import math
from collections.abc import Callable, Sequence
from typing import Any, Final

import numpy as np
from simpy.events import Timeout

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
        "_action", "_action_periods", "_allowed", "_controller", "_generator", "_opponent", "_stride",
        "_stride_action", "_stride_program", "_timer", "_turn_rate", "_turn_step", "number", "policy_name",
        "pucks", "swarm",
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
        self._action_periods = model.action_periods
        self._stride_program = stride_program
        self._stride_action = stride_action
        self._timer: Timeout | None = None
        self._action: Action | None = None  # of the latest conflict

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
            self._timer = None
            self._phase[index] = IDLE

    def begin_leg(self) -> None:
        """Wander straight ahead for an exponential duration."""
        controller = self._controller
        self._drive(LEG, self._stride_program)
        duration = self._generator(Purpose.LEG).exponential(controller.leg_mean)
        timer = self._timer = Timeout(self._env, controller.periods(duration), "leg")
        timer.callbacks.append(self._leg_over)

    def begin_wander_turn(self) -> None:
        """Turn in place by a uniform angle."""
        limit = self._controller.wander_turn
        self._turn(TURN, self._generator(Purpose.WANDER).uniform(-limit, limit), self._turn_over)

    def begin_wall_turn(self) -> None:
        """Turn in place to a heading drawn uniformly from those without a wall ahead."""
        controller = self._controller
        x, y = self._states.positions[self.index].tolist()
        heading = self.heading
        rng = self._generator(Purpose.WALL)
        arena = controller.half, controller.wall_reach, controller.wall_half_angle
        met = walls_met(x, y, heading, *arena)
        while True:
            target = rng.uniform(-math.pi, math.pi)
            if not (heads_for(target, met) if controller.escape_away else walls_met(x, y, target, *arena)):
                break
        self._turn(TURN, wrap(target - heading), self._turn_over)

    def go_home(self, error: float) -> None:
        """Turn towards the own base if the heading is off by `error` (rad), else drive to it."""
        if abs(error) > HOMING_ERROR:
            self._turn(HOME_TURN, error, self._turn_over)
        else:
            self._timer = None
            self._drive(HOME, self._stride_program)

    # The conflict.

    def meet(self, now: int, opponent: "Krembot", angle: float, active: int, vacant: int) -> None:
        """Begin a conflict at `now` (periods) and close the previous one.

        `opponent` is the robot ahead and `angle` its bearing (rad); the policy gets only its swarm. `active`
        is the number of active sensors, n'_i of Eq. 5.4. `vacant` has the bits of the most vacant sensors.
        If the policy removes one of the two robots, no conflict begins.
        """
        swarm = opponent.swarm
        self.close(now)
        if self.index < 0:
            return
        action = self._action = self.policy.choose(swarm)
        if self._allowed is not None and action not in self._allowed:
            rule = f"choose({swarm}) must return an action of the game, not {action!r}"
            raise InputError("policy", self.policy_name, rule)
        index, other = self.index, opponent.index
        if index < 0 or other < 0:
            return
        self._opponent[index] = other
        fields: tuple[Any, ...] = ()
        if self._log is not None:
            x, y = self._states.positions[index].tolist()
            fields = (self.number, opponent.number, now, x, y, action, active, self._sensed_robots(other))
        self._begin(swarm, active, fields)
        if action.direction != TOWARDS:
            angle = self._vacant_direction(vacant)
        if abs(angle) > _STRAIGHT:
            self._turn(ACTION, angle, self._drive_action)
        else:
            self._timer = None
            self._drive_action(None)

    def restart(self, now: int) -> None:
        """Begin the measured game: reset pucks, times and conflicts to 0 and stop learning."""
        super().restart(now)
        self.pucks = 0

    def finish(self, now: int) -> None:
        """End the game: close the open conflict and cancel the timeout."""
        super().finish(now)
        self._timer = None

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

    def _vacant_direction(self, vacant: int) -> float:
        """Return the angle of the most vacant sensor from the heading (rad), ties broken at random."""
        angles = ANGLES_OF[vacant]
        if len(angles) == 1:
            return angles[0]
        return angles[int(self._generator(Purpose.VACANT).random() * len(angles))]

    def _drive_action(self, event: Timeout | None) -> None:
        if event is self._timer and self._action is not None:
            # `_drive` inlined, for speed: part of every conflict.
            index = self.index
            self._phase[index] = ACTION
            self._stride[index] = self._stride_action
            self._turn_rate[index] = 0.0
            name = self._action.name
            timer = self._timer = Timeout(self._env, self._action_periods[name], name)
            timer.callbacks.append(self._action_over)

    def _action_over(self, event: Timeout) -> None:
        if event is self._timer:
            self._end_action()
            self._phase[self.index] = IDLE

    # Legs and turns. A decision is due at their end.

    def _leg_over(self, event: Timeout) -> None:
        if event is self._timer:
            self._phase[self.index] = LEG_OVER

    def _turn_over(self, event: Timeout) -> None:
        if event is self._timer:
            self._phase[self.index] = IDLE

    def _drive(self, phase: int, stride: float) -> None:
        index = self.index
        self._phase[index] = phase
        self._stride[index] = stride
        self._turn_rate[index] = 0.0

    def _turn(self, phase: int, angle: float, callback: Callable[[Any], None]) -> None:
        """Turn in place in whole periods, then call `callback`."""
        index = self.index
        periods = math.ceil(abs(angle) / self._turn_step - _ROUNDING) or 1
        self._phase[index] = phase
        self._stride[index] = 0.0
        self._turn_rate[index] = angle / periods
        timer = self._timer = Timeout(self._env, periods, "turn")
        timer.callbacks.append(callback)
