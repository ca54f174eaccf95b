"""The robot: a Mesa agent in continuous space, driven by SimPy events (section 2.3).

Every leg, turn, flight and fight is one SimPy event, a `Timer`. At its end, the phase of the robot tells the
kernel that a decision is due; the robot decides after the next percepts.
"""

import math
from collections.abc import Sequence
from itertools import chain

import numpy as np
from simpy.events import NORMAL

from kswarms.agents.actions import TOWARDS, Action
from kswarms.agents.body import SENSORS
from kswarms.agents.common.errors import InputError
from kswarms.agents.policies.interface import Policy
from kswarms.agents.robot.driver import END_ACTION, END_LEG, START_DRIVE, STRAIGHT, Driver, turn_of
from kswarms.agents.robot.host import Host
from kswarms.agents.robot.sensing import NO_HEADINGS, read_sensors, turn_from_walls
from kswarms.agents.robot.state import ACTION, HOME, HOME_TURN, HOMING_ERROR, IDLE, LEG, TURN
from kswarms.agents.streams import Purpose, Streams


class Krembot(Driver):
    """Behaviour of one robot. `Driver` moves it, `TimedAgent` accounts for its time.

    `number` is its number in the game and `swarm` its swarm, both from 0; `index` is its row in the state
    arrays (removed robots are skipped). In a period it drives `stride_program` in state P and `stride_action`
    in state A (m). `actions`, if given, are the only allowed choices of a user-defined policy.
    """

    __slots__ = (
        "_action_periods", "_allowed", "_controller", "_escapes", "_generator", "_headings", "_legs", "_ties",
        "_timed_actions", "_turns", "_used", "number", "policy_name", "pucks", "swarm",
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
        super().__init__(model, number, policy, swarms, stride_program, stride_action)
        self.number = number
        self.swarm = swarm
        self.policy_name = policy_name
        self.pucks = 0  # number of deposited pucks
        self._generator = streams.generator
        self._allowed = actions
        self._controller = model.controller
        limit = model.controller.wander_turn
        legs = streams.blocks(Purpose.LEG, "exponential", model.controller.leg_mean)
        self._legs = chain.from_iterable(map(model.controller.whole_periods, legs))
        self._turns = streams.draws(Purpose.WANDER, "uniform", -limit, limit)
        self._escapes = streams.blocks(Purpose.WALL, "uniform", -math.pi, math.pi)
        self._headings = NO_HEADINGS  # the present block of `_escapes`
        self._used = 0  # number of these headings that were used
        self._ties = streams.draws(Purpose.VACANT, "random")
        self._action_periods = model.action_periods
        self._timed_actions = model.timed_actions

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
        self._set_timer(next(self._legs), END_LEG)

    def begin_wander_turn(self) -> None:
        """Turn in place by a uniform angle."""
        self._turn(TURN, next(self._turns))

    def begin_wall_turn(self) -> None:
        """Turn in place to a heading drawn uniformly from those without a wall ahead."""
        controller, states, index = self._controller, self._states, self.index
        pose = states.x[index], states.y[index], states.heading[index]
        arena = controller.half, controller.wall_reach, controller.wall_half_angle
        away, angle = controller.escape_away, math.nan
        while angle != angle:  # NaN: no heading of the block is allowed
            if self._used == len(self._headings):
                self._headings, self._used = next(self._escapes), 0
            self._used, angle = turn_from_walls(self._headings, self._used, *pose, *arena, away)
        self._turn(TURN, angle)

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
        # Nearly all decisions are conflicts. Calls of other methods are inlined here where they take time.
        timer = self._timer
        if self._is_open or timer.callbacks is not None:
            self.close(now)
            if self.index < 0:
                return
        else:  # it closes no conflict and interrupts nothing: all time has been program time
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
        try:
            is_fight, drive = self._timed_actions[id(action)]
        except KeyError:  # a copy of an action
            is_fight, drive = action.direction == TOWARDS, self._action_periods[action.name]
        if not is_fight:
            flights = self._flights[vacant]
            n = len(flights)
            turn, rate = flights[0] if n == 1 else flights[int(next(self._ties) * n)]
        elif abs(angle) > STRAIGHT:
            turn, rate = turn_of(angle, self._turn_step)
        else:
            turn, rate = 0, 0.0
        if timer.callbacks is not None:
            timer = self._free_timer()
        self._phase[index] = ACTION
        self._turn_rate[index] = rate
        self._action_end = now + turn + drive
        if turn:
            self._stride[index] = 0.0
            timer.callbacks = START_DRIVE
            end = now + turn
        else:
            self._stride[index] = self._stride_action
            timer.callbacks = END_ACTION
            end = now + drive
        self._push(self._later[end], (end, NORMAL, next(self._order), timer))

    def restart(self, now: int) -> None:
        """Begin the measured game: reset pucks, times and conflicts to 0 and stop learning."""
        super().restart(now)
        self.pucks = 0

    def _sensed_robots(self, met: int) -> tuple[int, ...]:
        """Return the numbers of the robots that the sensors read at the start of a conflict."""
        states, controller = self._states, self._controller
        bodies = states.bodies
        forward = bodies.forward_x[self.index], bodies.forward_y[self.index]
        nearest, read = np.full(SENSORS, controller.active_range), np.full(SENSORS, -1)
        arena = controller.radius, controller.half
        read_sensors(self.index, met, *forward, bodies.x, bodies.y, *arena, nearest, read)
        return tuple(states.numbers[row] for row in read.tolist() if row >= 0)
