"""The robot: a Mesa agent in continuous space that lives by SimPy events (section 2.3).

Every leg, turn, flight and fight is one SimPy timeout, whose end only marks that a decision is due; the
decision is taken in the next percepts, by the same instant's view of the world for all robots. A
timeout that a conflict has overtaken finds another one in its place, `_timer`, and does nothing.
"""

import math
from collections.abc import Callable, Sequence
from typing import Any, Final

from simpy.events import Timeout

from kswarms.agents.actions import TOWARDS, Action
from kswarms.agents.common.errors import InputError
from kswarms.agents.policies.interface import Policy
from kswarms.agents.robot.host import World
from kswarms.agents.robot.sensing import ANGLES_OF, heads_for, read_robots, walls_met, wrap
from kswarms.agents.robot.state import ACTION, HOME, HOME_TURN, HOMING_ERROR, IDLE, LEG, LEG_OVER, TURN
from kswarms.agents.robot.time_account import TimedAgent
from kswarms.agents.streams import Purpose, Streams

_STRAIGHT: Final = 1e-9
"""A turn by less than this angle is none (rad)."""


class Krembot(TimedAgent):
    """A robot: what it does. How long it took, and whom it met, its `TimedAgent` part tells.

    Parameters
    ----------
    model : World
        The Mesa model that it lives in.
    number : int
        Its number in the game, from 0, which also names its streams.
    swarm : int
        Its swarm-ID, from 0.
    policy : Policy
        Decides at a conflict; if it has a method ``learn``, it is told how each conflict ended.
    policy_name : str
        Under which the policy was asked for.
    streams : Streams
        Its random streams.
    stride_program, stride_action : float
        What it drives in a period in state P and in state A (m).
    swarms : int
        Number of swarms in the game.
    actions : sequence of Action, optional
        What the policy may choose, if it is not trusted.

    Attributes
    ----------
    index : int
        Its row in the fleet: its number, less by one for each robot before it that is absent.
    pucks : int
        Pucks deposited.
    """

    __slots__ = (
        *("number", "swarm", "policy_name", "pucks", "_draws", "_allowed", "_fleet", "_opponent", "_stride"),
        *("_turn_rate", "_habits", "_turn_step", "_action_periods", "_stride_program", "_stride_action"),
        *("_timer", "_action"),
    )

    def __init__(
        self,
        model: World,
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
        self.pucks = 0
        self._draws = streams.draws
        self._allowed = actions
        self._fleet = model.fleet
        self._opponent = model.fleet.opponent
        self._stride = model.fleet.stride
        self._turn_rate = model.fleet.turn_rate
        self._habits = model.habits
        self._turn_step = model.habits.turn_step
        self._action_periods = model.action_periods
        self._stride_program = stride_program
        self._stride_action = stride_action
        self._timer: Timeout | None = None
        self._action: Action | None = None
        """Action of the last conflict."""

    # What others may ask.

    @property
    def carrying(self) -> bool:
        """Whether it carries a puck."""
        return bool(self._fleet.carrying[self.index])

    @property
    def heading(self) -> float:
        """Direction (rad)."""
        return float(self._fleet.heading[self.index])

    # The program.

    def pick_up(self) -> None:
        """Take a puck."""
        self._fleet.carrying[self.index] = 1

    def deposit(self) -> None:
        """Put the puck down at the own base; one who drove home is free again."""
        index = self.index
        self._fleet.carrying[index] = 0
        self.pucks += 1
        if self._phase[index] in (HOME, HOME_TURN):
            self._timer = None
            self._phase[index] = IDLE

    def begin_leg(self) -> None:
        """Wander straight ahead for an exponential time."""
        habits = self._habits
        self._drive(LEG, self._stride_program)
        duration = self._draws(Purpose.LEG).exponential(habits.leg_mean)
        timer = self._timer = Timeout(self._env, habits.periods(duration), "leg")
        timer.callbacks.append(self._leg_over)

    def begin_wander_turn(self) -> None:
        """Turn in place by a uniform angle."""
        limit = self._habits.wander_turn
        self._turn(TURN, self._draws(Purpose.WANDER).uniform(-limit, limit), self._turn_over)

    def begin_wall_turn(self) -> None:
        """Turn in place to a heading drawn uniformly from those without a wall ahead."""
        habits = self._habits
        x, y = self._fleet.positions[self.index].tolist()
        heading = self.heading
        draws = self._draws(Purpose.WALL)
        met = walls_met(x, y, heading, habits.half, habits.wall_reach, habits.wall_half_angle)
        while True:
            target = draws.uniform(-math.pi, math.pi)
            if habits.escape_away:
                if not heads_for(target, met):
                    break
            elif not walls_met(x, y, target, habits.half, habits.wall_reach, habits.wall_half_angle):
                break
        self._turn(TURN, wrap(target - heading), self._turn_over)

    def go_home(self, error: float) -> None:
        """Turn towards the own base, which is in sight `error` (rad) off the heading, or drive to it."""
        if abs(error) > HOMING_ERROR:
            self._turn(HOME_TURN, error, self._turn_over)
        else:
            self._timer = None
            self._drive(HOME, self._stride_program)

    # The conflict.

    def meet(self, now: int, other: int, swarm: int, angle: float, active: int, vacant: int) -> None:
        """Begin a conflict; the one before it ends here, its T(p) with it.

        Parameters
        ----------
        now : int
            The time (periods).
        other, swarm : int
            The robot ahead, and its swarm-ID, which is all that the policy is told.
        angle : float
            Where it is, from the heading (rad).
        active : int
            Sensors with something near, n'_i of Eq. 5.4.
        vacant : int
            The most vacant directions, one bit for each sensor.
        """
        self.close(now)
        index = self.index
        action = self._action = self.policy.choose(swarm)
        if self._allowed is not None and action not in self._allowed:
            raise InputError(
                "policy",
                self.policy_name,
                f"choose({swarm}) must return an action of the game, not {action!r}",
            )
        self._opponent[index] = other
        about: tuple[Any, ...] = ()
        if self._log is not None:
            x, y = self._fleet.positions[index].tolist()
            about = (index, other, now, x, y, action, active, self._read_robots(other))
        self._begin(swarm, active, about)
        if action.direction != TOWARDS:
            angle = self._vacant_direction(vacant)
        if abs(angle) > _STRAIGHT:
            self._turn(ACTION, angle, self._drive_action)
        else:
            self._timer = None
            self._drive_action(None)

    def restart(self, now: int) -> None:
        """Begin the measured game: scores, times and conflicts from 0, and nothing more is learned."""
        super().restart(now)
        self.pucks = 0

    def finish(self, now: int) -> None:
        """End the game: what was set to happen later does not."""
        super().finish(now)
        self._timer = None

    def _read_robots(self, met: int) -> tuple[int, ...]:
        """Return the robot that each sensor reads as it meets one of them, −1 for none."""
        row, habits = self._fleet.robots[self.index], self._habits
        where = row["forward_x"], row["forward_y"], self._fleet.positions
        return read_robots(self.index, met, *where, habits.radius, habits.half, habits.active_range)

    def _vacant_direction(self, vacant: int) -> float:
        """Return the angle of the most vacant sensor from the heading (rad), ties broken at random."""
        angles = ANGLES_OF[vacant]
        if len(angles) == 1:
            return angles[0]
        return angles[int(self._draws(Purpose.VACANT).random() * len(angles))]

    def _drive_action(self, event: Timeout | None) -> None:
        if event is self._timer and self._action is not None:
            # `_drive` written out: every conflict comes through here.
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

    # Legs and turns: at their end they ask for a decision, which the percepts of the same instant bring.

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

    def _turn(self, phase: int, angle: float, then: Callable[[Any], None]) -> None:
        """Turn in place, in whole periods, and call `then`."""
        index = self.index
        periods = math.ceil(abs(angle) / self._turn_step - _STRAIGHT) or 1
        self._phase[index] = phase
        self._stride[index] = 0.0
        self._turn_rate[index] = angle / periods
        timer = self._timer = Timeout(self._env, periods, "turn")
        timer.callbacks.append(then)
