"""The game as a Mesa model on SimPy's clock (specification, section 2.6).

The clock counts whole control periods. At one instant, the timeouts of the robots come first, in the order in
which they were set. The motion process follows with a lower priority: pick-ups and deposits, percepts of all
robots, decisions, motion. Samples and the end of the game come before all other events of their instant: they
see the world after the previous period.
"""

import math
from collections.abc import Collection
from typing import Any, Final

from simpy.core import StopSimulation
from simpy.events import Event

from kswarms.agents.common.errors import InputError
from kswarms.agents.robot.krembot import Krembot
from kswarms.model.clock import AFTER_TIMEOUTS, BEFORE_TIMEOUTS, Instant, rare_garbage_collection
from kswarms.model.description.game import Game
from kswarms.model.game_state import GameState
from kswarms.model.kernel.arrays import CONFLICT, DEPOSIT, HOMING, LEG_DUE, PICK_UP, TURN_DUE
from kswarms.model.kernel.kernel import Kernel
from kswarms.model.mesa_base import Rng, hide_seed
from kswarms.model.recorder import Recorder, Table, parse_record, policy_rows, result_rows

_OBJECTS_IN_USE: Final = 5
"""Upper bound of the objects per robot that come and go during a game, such as events."""


class GameModel(GameState):
    """A game that can be played; `GameState` documents its state.

    Parameters
    ----------
    game : Game
        The game.
    seed : int, str or None
        Seed of the run, a whole number ≥ 0; drawn if None, see the attribute `seed`.
    record : str
        Comma-separated list of `kswarms.model.recorder.RECORDS`; nothing is recorded if empty.
    rng : int, sequence, SeedSequence, Generator or None
        Alternative to `seed`, as in Mesa.

    Attributes
    ----------
    recorder : Recorder
        Samples and tables.
    datacollector : mesa.DataCollector
        Collects one row at the start and one in each step; a subclass may add reporters or replace it.

    Raises
    ------
    InputError
        If a parameter is not allowed, or there is no room for the robots.
    """

    @hide_seed
    def __init__(
        self, game: Game, seed: float | str | None = None, record: str = "", rng: Rng | None = None
    ) -> None:
        recorded = parse_record(record)
        super().__init__(game, seed, rng, log_conflicts="conflicts" in recorded)
        self._kernel = Kernel(game, self.arena, self.states)
        self._due = 0
        """Number of kernel events that wait for decisions of the robots."""
        self._begin_phase(self.phase)
        if self.phase == "learning":
            Instant(self.env, BEFORE_TIMEOUTS, self._switch_phase).schedule_at(self.game_begin)
        end = self.game_begin + self.controller.periods(game.duration)
        Instant(self.env, BEFORE_TIMEOUTS, self._time_out).schedule_at(end)
        self._motion = Instant(self.env, AFTER_TIMEOUTS, self._move)
        self._motion.schedule_at(0)
        self._sample_every = self.controller.periods(game.sample_period)
        self.recorder = Recorder(self, recorded)
        self.datacollector = self.recorder.collector
        self._sample()

    @property
    def supply(self) -> list[int]:
        """Pucks left at each station; −1 for no limit."""
        return [int(pucks) for pucks in self._kernel.supply]

    @property
    def sample_times(self) -> list[float]:
        """Times of the samples (s)."""
        return self.recorder.sample_times

    def step(self) -> None:
        """Play one sampling period, or to the end of the game, which stops the model."""
        if self.ended:  # the user ran the clock
            return
        self._run_clock(self._next_sample())

    def play(self) -> None:
        """Play to the end of the game, or until the model is stopped.

        The game is played in steps only if samples are recorded, or a subclass has its own `step`.
        """
        in_steps = self.recorder.samples(self.datacollector) or type(self).step is not GameModel.step
        if self.running and not self.ended and not in_steps:
            self._run_clock()
        while self.running:
            self.step()

    def run_until(self, end_time: float) -> None:
        """Play to a time (s), or to the end of the game if it is earlier, as models of Mesa 3.5 do.

        Raises
        ------
        InputError
            If the time is not a finite number, or in the past.
        """
        if not self.time <= end_time < math.inf:
            raise InputError("end_time", end_time, f"must be a time (s) from {self.time:g} on")
        while self.running and not self.ended and self.controller.seconds(self._next_sample()) <= end_time:
            self.step()
        if self.running and not self.ended and self.time < end_time:
            self._run_clock(self.controller.periods(end_time))

    def run_for(self, duration: float) -> None:
        """Play for a duration (s), as `run_until` does."""
        self.run_until(self.time + duration)

    def _wrapped_step(self, *arguments: Any, **named: Any) -> None:
        """Sample after each step, which a subclass may define; Mesa calls this as `step`."""
        if self._sampled_end:
            self.running = False
            return
        samples = self.recorder.sample_times
        self.steps = len(samples) - 1
        if self.steps == self.now == 0:
            self._sample()  # again: a subclass may have added reporters
        self.steps += 1
        self._user_step(*arguments, **named)
        if self.ended:
            self.running = False
        self.publish_time(self.time)
        self._sample()
        if not self.running:
            self.steps = len(samples)  # `mesa.batch_run` reads the row before this number

    def results(self) -> list[dict[str, Any]]:
        """Return one row per swarm: the columns of the table ``runs`` from ``swarm`` on."""
        return result_rows(self)

    def policy_results(self) -> list[dict[str, Any]]:
        """Return one row per learning swarm, swarm learned about and action: the table ``policies``."""
        return policy_rows(self)

    def tables(self) -> dict[str, Table]:
        """Return the recorded tables (conflicts, robots, trajectory) by name; columns have equal lengths."""
        return self.recorder.tables()

    def _next_sample(self) -> int:
        """Return the control period of the next sample, if the game does not end before."""
        return self.now - self.now % self._sample_every + self._sample_every

    def _sample(self) -> None:
        self._sampled_end = bool(self.ended)
        self.recorder.sample(self.datacollector)

    def _run_clock(self, until: int | None = None) -> None:
        """Run the clock to period `until` or to the end of the game."""
        with rare_garbage_collection(_OBJECTS_IN_USE * len(self.robots)):
            self.env.run(until=until)
        if not self.ended and self.now != until:  # a user-defined policy raised SimPy's StopSimulation
            raise RuntimeError(f"the clock was stopped at {self.time} s, before the end of the game")

    def _begin_phase(self, phase: str) -> None:
        """Remove the robots that are absent from a phase, and reset the scores."""
        self.phase = phase
        absent = [robot for robot in self.robots if robot.number in self.game.absent]
        if absent and phase in ("game", self.game.absent_from):
            self._take_out(absent)
        self._reset_scores()

    def _take_out(self, robots: Collection[Krembot]) -> None:
        super()._take_out(robots)
        # The arrays of a kernel have a row per robot. The robots that have not decided yet perceive again.
        before = self._kernel
        self._kernel = Kernel(self.game, self.arena, self.states)
        self._kernel.resume(before)
        self._due = 0

    def _switch_phase(self, _: Event) -> None:
        for robot in self.robots:
            robot.restart(self.now)
        self.recorder.flush_conflicts()
        self._begin_phase("game")

    def _time_out(self, _: Event) -> None:
        if not self.ended:
            self._finish("time" if self.game.puck_limit is None else "cap")

    def _finish(self, reason: str) -> None:
        """End the game and stop the clock."""
        self._end(reason)
        self.env.release_all()
        raise StopSimulation(None)

    def _move(self, _: Event) -> None:
        """Let robots decide, move the bodies up to the next decision or event, and schedule itself there."""
        if self.ended:
            return
        motion, env = self._motion, self.env
        now, queue, later = motion.time, env.queue, env.later
        following = now + 1
        while True:
            if self._due > 0:
                self._decide(now, self._due)
            until = queue[0][0]  # the end of the game is always scheduled
            if following in later and until > following:
                until = following
            elif later:
                until = min(until, min(later))
            tick, self._due = self._kernel.advance(now, until)
            if tick > now or self._due == 0:
                break
        motion.schedule_at(tick)
        env.release(tick)

    def _decide(self, now: int, size: int) -> None:
        """Pass the first `size` events of the kernel to their robots; the events are ordered by row.

        If a policy removes a robot, the kernel finds the remaining events again.
        """
        robots = self.robots
        pick_ups = []
        rows, kinds, others, actives, vacants, angles = self._kernel.fields
        for k in range(size):
            robot, kind = robots[rows[k]], kinds[k]
            if kind == CONFLICT:
                robot.meet(now, robots[others[k]], angles[k], actives[k], vacants[k])
                if self.robots is not robots:
                    return
            elif kind == LEG_DUE:
                robot.begin_leg()
            elif kind == TURN_DUE:
                robot.begin_wander_turn()
            elif kind == HOMING:
                robot.go_home(angles[k])
            elif kind == PICK_UP:
                pick_ups.append((robot, others[k]))
            elif kind == DEPOSIT:
                robot.deposit()
                self.pucks[robot.swarm] += 1
                limit = self.game.puck_limit
                if limit is not None and sum(self.pucks) >= limit and self.phase == "game":
                    self._finish("pucks")
            else:
                robot.begin_wall_turn()
        if pick_ups:
            self._hand_out(pick_ups)

    def _hand_out(self, pick_ups: list[tuple[Krembot, int]]) -> None:
        """Give pucks to robots at stations; the nearest to the centre comes first if pucks are scarce."""
        supply = self._kernel.supply

        def distance(request: tuple[Krembot, int]) -> float:
            robot, station = request
            return math.dist(self.states.positions[robot.index], self.arena.stations[station])

        for robot, station in sorted(pick_ups, key=distance):
            if supply[station] == 0:
                continue
            if supply[station] > 0:
                supply[station] -= 1
            self.picked_up += 1
            robot.pick_up()
