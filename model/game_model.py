"""The game as a Mesa model whose clock is SimPy's (specification, section 2.6).

The clock counts control periods, in whole numbers. At one instant the robots' own timeouts come first, in
the order in which they were set; then, with a lower priority, the motion process: pick-ups and deposits,
percepts of all robots at the same instant, decisions, motion. A sample and the end of the game come before
everything else at their instant: they see the world as the last period left it.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any, NoReturn, cast

import mesa
import numpy as np
import simpy
from simpy.core import StopSimulation
from simpy.events import Event

from kswarms.agents.common.errors import InputError
from kswarms.agents.robot.conflict import Conflict
from kswarms.agents.robot.controller import Habits
from kswarms.agents.robot.krembot import Krembot
from kswarms.model import recorder as recording
from kswarms.model.clock import AFTER_TIMEOUTS, BEFORE_TIMEOUTS, Instant
from kswarms.model.description.game import Game
from kswarms.model.kernel.kernel import Kernel
from kswarms.model.kernel.percepts import CONFLICT, DEPOSIT, HOMING, LEG_DUE, PICK_UP, TURN_DUE
from kswarms.model.population import make_robots, place, take_away


class GameModel(mesa.Model):
    """A game that is being played.

    Parameters
    ----------
    game : Game
        What is played.
    seed : int
        Seed of the run, ≥ 0: names all random streams, together with robot and purpose.
    record : str
        What to keep, a comma-separated list of `kswarms.model.recorder.RECORDS`; nothing if empty.

    Attributes
    ----------
    env : simpy.Environment
        The clock; counts control periods.
    space : mesa.experimental.continuous_space.ContinuousSpace
        Where the robots are; the kernel works on its array of positions.
    robots : list of Krembot
        All robots that are there, by number; S1's first.
    members : list of list of Krembot
        The robots of each swarm.
    pucks : list of int
        Pucks deposited by each swarm.
    picked_up : int
        Pucks picked up by all in the measured game.
    carried_at_start : int
        Pucks that were carried when it began.
    phase : {'learning', 'game'}
        Whether the learners still learn before the measured game, which counts anew.
    ended : {'', 'time', 'pucks', 'cap'}
        Why the game is over; empty while it is not.
    sample_times : list of float
        When the DataCollector sampled (s).
    conflict_log : list of Conflict, optional
        Closed conflicts that are not in the DataCollector's table yet, if conflicts are recorded.

    Raises
    ------
    InputError
        If a parameter is not allowed or the robots find no place.
    """

    def __init__(self, game: Game, seed: int = 0, record: str = "") -> None:
        if not isinstance(seed, int | np.integer) or isinstance(seed, bool) or seed < 0:
            raise InputError("seed", seed, "must be a whole number ≥ 0")
        recorded = recording.parse_record(record)
        super().__init__(seed=int(seed))
        self.game = game
        self.seed = int(seed)
        self.env = simpy.Environment()
        self.arena = game.arena(self.seed)
        self.habits = _habits(game)
        self.action_periods: Mapping[str, int] = {
            a.name: self.habits.periods(a.duration) for a in game.action_set
        }
        self.conflict_log: list[Conflict] | None = [] if "conflicts" in recorded else None
        self.pucks = [0] * len(game.swarms)
        self.picked_up = 0
        self.carried_at_start = 0
        self.ended = ""
        self._stopped: int | None = None
        self._sampled_end = False
        self._start = math.ceil(game.learning / game.parameters.period - 1e-9)
        """When the measured game begins (periods)."""
        self.space, self.fleet = place(game, self.arena, self.seed, self.random)
        self._let_play(make_robots(self, game, self.seed))
        if game.absent and (game.absent_from == "learning" or self._start == 0):
            self._take_away(game.absent)
        self._kernel = Kernel(game, self.arena, self.fleet)
        self._due = 0
        """Events of the kernel that the robots have not decided on yet."""
        self._end = self._start + self.habits.periods(game.duration)
        self.phase = "game"
        if self._start > 0:
            self.phase = "learning"
            Instant(self.env, BEFORE_TIMEOUTS, self._begin_game).happen_in(self._start)
        Instant(self.env, BEFORE_TIMEOUTS, self._time_is_up).happen_in(self._end)
        self._motion = Instant(self.env, AFTER_TIMEOUTS, self._move)
        self._motion.happen_in(0)
        self._sample_every = self.habits.periods(game.sample_period)
        self._recorded = recorded
        self.sample_times: list[float] = []
        self.datacollector = recording.make_collector(len(game.swarms), recorded)
        self._collect()

    @property
    def time(self) -> float:
        """Seconds since the beginning, that of learning included."""
        return self.habits.seconds(cast(int, self.env.now))

    @property
    def duration(self) -> float:
        """Seconds of the measured game so far."""
        now = cast(int, self.env.now) if self._stopped is None else self._stopped
        return self.habits.seconds(max(0, now - self._start))

    @property
    def supply(self) -> list[int]:
        """Pucks left at each station, −1 where there is no limit."""
        return [int(pucks) for pucks in self._kernel.supply]

    def step(self) -> None:
        """Play one sampling period and sample; after the end, only say that the model stopped."""
        if self.ended:
            self._stop()
            return
        now = int(self.env.now)
        until = now - now % self._sample_every + self._sample_every
        self.env.run(until=until)
        self._require(bool(self.ended) or self.env.now == until)
        self._collect()

    def play(self) -> None:
        """Play to the end of the game, sampling on the way only if samples are recorded."""
        if self._recorded & {"model", "agents", "trajectory"}:
            while self.running:
                self.step()
            return
        if not self.ended:
            self.env.run()
            self._require(bool(self.ended))
        self._stop()

    def _require(self, in_order: bool) -> None:
        if not in_order:  # a policy that raises SimPy's StopSimulation ends the run of the clock
            raise RuntimeError(f"the clock was stopped at {self.time} s, before the end of the game")

    def _stop(self) -> None:
        """Say that the model stopped, and sample its end if the clock was run there by hand."""
        if not self._sampled_end:
            self._collect()
        self.running = False
        self.forget()

    def forget(self) -> None:
        """Drop what Mesa counts of every model in a table of the class, so that this one can be freed."""
        mesa.Agent._ids.pop(self, None)

    def times(self, swarm: int) -> tuple[list[int], int]:
        """Return a swarm's T(a), by the opponent's swarm, and T(p), up to now (robot-periods)."""
        t_a = [0] * len(self.members)
        t_p = 0
        for robot in self.members[swarm]:
            own_t_a, own_t_p = robot.times()
            t_a = [a + b for a, b in zip(t_a, own_t_a, strict=True)]
            t_p += own_t_p
        return t_a, t_p

    def results(self) -> list[dict[str, Any]]:
        """Return one row for each swarm: the columns of ``runs.parquet`` from ``swarm`` on."""
        return recording.result_rows(self)

    def tables(self) -> dict[str, recording.Table]:
        """Return the recorded tables (conflicts, robots, trajectory) by name, columns of equal length."""
        tables: dict[str, recording.Table] = {}
        if "conflicts" in self._recorded:
            tables["conflicts"] = self.datacollector.tables["conflicts"]
        if "robots" in self._recorded:
            tables["robots"] = recording.robots_table(self)
        if "trajectory" in self._recorded:
            tables["trajectory"] = recording.trajectory_table(self)
        return tables

    def _take_away(self, absent: Sequence[int]) -> None:
        """Take robots out of the game: their bodies, what they wait for, and the pucks that they carry."""
        self._let_play(take_away(self, self.robots, absent))

    def _let_play(self, robots: list[Krembot]) -> None:
        self.robots = robots
        swarms = range(len(self.game.swarms))
        self.members = [[robot for robot in robots if robot.swarm == k] for k in swarms]
        self._swarm_of = [robot.swarm for robot in robots]

    def _begin_game(self, _: Event) -> None:
        """End the learning: policies are fixed, and all counts begin anew in the world as it is."""
        for robot in self.robots:
            robot.restart(cast(int, self.env.now))
        self._flush_conflicts()
        if self.game.absent and self.game.absent_from == "game":
            supply = self.supply
            self._take_away(self.game.absent)
            # A kernel has memory for its robots. It is between two periods here, as a new one is.
            self._kernel = Kernel(self.game, self.arena, self.fleet)
            self._kernel.supply[:] = supply
        self.phase = "game"
        self.pucks = [0] * len(self.pucks)
        self.picked_up = 0
        self.carried_at_start = sum(robot.carrying for robot in self.robots)

    def _time_is_up(self, _: Event) -> None:
        if not self.ended:
            self._finish("time" if self.game.puck_limit is None else "cap")

    def _finish(self, why: str) -> NoReturn:
        """End the game, and with it the run of the clock."""
        self.ended = why
        for robot in self.robots:
            robot.finish(cast(int, self.env.now))
        self._stopped = cast(int, self.env.now)
        raise StopSimulation(None)

    def _flush_conflicts(self) -> None:
        if self.conflict_log:
            recording.add_conflicts(self, self.conflict_log)
            self.conflict_log.clear()

    def _collect(self) -> None:
        self._flush_conflicts()
        self._sampled_end = bool(self.ended)
        self.sample_times.append(self.time)
        self.datacollector.collect(self)

    def _move(self, _: Event) -> None:
        """Have the robots decide, move the bodies to the next decision or event, and wait for its instant."""
        if self.ended:
            return
        env, kernel = self.env, self._kernel
        now: int = env.now  # type: ignore[assignment]  # whole periods; `cast` would cost a call
        while True:
            if self._due > 0:
                self._decide(now, self._due)
            tick, self._due = kernel.advance(now, env.peek())  # type: ignore[arg-type]
            if tick > now or self._due == 0:
                break
        self._motion.happen_in(tick - now)

    def _decide(self, now: int, size: int) -> None:
        """Hand the first `size` events of the kernel to their robots, in the order of their numbers."""
        robots, swarm_of = self.robots, self._swarm_of
        pick_ups = []
        numbers, kinds, others, actives, vacants, angles = self._kernel.fields
        for k in range(size):
            robot, kind = robots[numbers[k]], kinds[k]
            if kind == CONFLICT:
                other = others[k]
                robot.meet(now, other, swarm_of[other], angles[k], actives[k], vacants[k])
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
        """Give pucks to those who stand on a station, the nearest to its middle first where they are few."""
        supply = self._kernel.supply

        def distance(request: tuple[Krembot, int]) -> float:
            robot, station = request
            return math.dist(self.fleet.positions[robot.index], self.arena.stations[station])

        for robot, station in sorted(pick_ups, key=distance):
            if supply[station] == 0:
                continue
            if supply[station] > 0:
                supply[station] -= 1
            self.picked_up += 1
            robot.pick_up()


def _habits(game: Game) -> Habits:
    parameters, body = game.parameters, game.body
    return Habits(
        period=parameters.period,
        turn_step=parameters.turning_rate * parameters.period,
        leg_mean=parameters.leg_mean,
        wander_turn=parameters.wander_turn,
        half=game.side / 2,
        wall_reach=body.radius + body.sensing_scale * parameters.wall_distance,
        wall_half_angle=parameters.wall_half_angle,
        radius=body.radius,
        active_range=body.sensing_scale * parameters.active_range,
        escape_away=parameters.wall_escape == "away",
    )
