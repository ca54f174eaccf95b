"""Events on SimPy's clock: their kinds, durations and order (section 2.6)."""

import math
from collections import Counter, defaultdict
from contextlib import suppress
from heapq import heappush
from typing import Any, NamedTuple, cast

import pytest
from simpy.core import StopSimulation
from simpy.events import Event

from kswarms.agents.robot import clock
from kswarms.agents.robot.driver import END_ACTION, END_LEG, Timer
from kswarms.agents.robot.krembot import Krembot
from kswarms.agents.streams import Purpose, stream
from kswarms.model.description.game import Game, Swarm
from kswarms.model.description.presets import PRESETS
from kswarms.model.game_model import GameModel, Instant
from tests import games

MOTION = 2
"""SimPy priority of the motion process."""

SEED = 3


class ClockEvent(NamedTuple):
    """An event of the clock; a timer's also has its robot, kind and start."""

    time: int
    priority: int
    is_motion: bool
    robot: int = -1
    what: str = ""
    begin: int = -1


class Trace:
    """Trace of the events of a game, and independent counts of the decisions of its robots."""

    def __init__(self, game: Game, monkeypatch: pytest.MonkeyPatch, record: str = "conflicts") -> None:
        self.events: list[ClockEvent] = []
        self.decided: Counter[str] = Counter()
        for name in ("begin_leg", "begin_wander_turn", "begin_wall_turn", "go_home", "meet"):
            self._count(monkeypatch, name)
        self._set: list[ClockEvent] = []
        monkeypatch.setattr(clock, "heappush", self.push)
        self.model = GameModel(game, seed=SEED, record=record)
        self._step = self.model.env.step
        monkeypatch.setattr(self.model.env, "step", self.step)

    def _count(self, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
        """Count the decision of a robot: a leg, or a turn if it then turns."""
        decide = getattr(Krembot, name)

        def counted(robot: Krembot, *arguments: Any) -> None:
            decide(robot, *arguments)
            kind = "leg" if name == "begin_leg" else "turn"
            self.decided[kind] += kind == "leg" or self.model.states.turn_rate[robot.index] != 0

        monkeypatch.setattr(Krembot, name, counted)

    def step(self) -> None:
        """Record the next event and process it."""
        time, priority, _, event = self.model.env._queue[0]
        is_motion = isinstance(event, Instant) and int(priority) == MOTION
        self.events.append(ClockEvent(int(time), int(priority), is_motion, what=type(event).__name__))
        self._step()

    def push(self, queue: list[Any], entry: tuple[int, int, int, Event]) -> None:
        """Record the event of a robot when it is scheduled, because an interruption makes it anonymous."""
        time, priority, _, event = entry
        if isinstance(event, Timer):
            robot, now = event.robot.index, self.model.now
            self._set.append(ClockEvent(time, int(priority), False, robot, kind_of(event, time - now), now))
        heappush(queue, entry)

    def timeouts(self) -> list[ClockEvent]:
        """Return all events of robots, including those pending at the end of the game."""
        return [event for event in self._set if event.what]

    def table(self) -> list[dict[str, Any]]:
        """Return the closed conflicts, times in periods."""
        table, period = self.model.tables()["conflicts"], self.model.game.parameters.period
        rows = [dict(zip(table, row, strict=True)) for row in zip(*table.values(), strict=True)]
        for row in rows:
            for name in ("start", "t_a", "t_p"):
                row[name] = round(row[name] / period)
        return rows


def kind_of(event: Event, delay: int) -> str:
    """Return the kind of an event that a robot schedules; durations tell a flight from a fight."""
    if not isinstance(event, Timer):
        return ""
    if event.callbacks is END_ACTION:
        robot = cast(Krembot, event.robot)
        return next(name for name, periods in robot._action_periods.items() if periods == delay)
    return "leg" if event.callbacks is END_LEG else "turn"


def make_game(**changes: Any) -> Game:
    parameters = PRESETS["fitted"].replace(**changes)
    return games.make_game("avoid", "attack", "mixed", size=5, parameters=parameters, duration=120.0)


def test_one_timeout_for_each_leg_turn_flight_and_fight(monkeypatch: pytest.MonkeyPatch) -> None:
    trace = Trace(make_game(flight_duration=0.73), monkeypatch)
    trace.model.play()
    begun = defaultdict(list)
    for event in trace.timeouts():
        begun[event.robot, event.begin].append(event)
    actions = 0
    for row in trace.table():
        (event,) = begun[row["robot"], row["start"]]
        if event.what == "turn" and event.time < trace.model.env.now:
            (event,) = begun[row["robot"], event.time]
        if event.what != "turn" and event.time <= trace.model.env.now:
            assert (event.what, event.time) == (row["action"], row["start"] + row["t_a"])
            assert event.time - event.begin == {"flight": 8, "fight": 10}[row["action"]]
        actions += event.what == row["action"]
    counts = Counter(event.what for event in trace.timeouts())
    assert counts.keys() == {"leg", "turn", "flight", "fight"}
    assert counts["leg"] == trace.decided["leg"] > 50
    assert counts["turn"] == trace.decided["turn"] > 200
    assert counts["flight"] + counts["fight"] == actions > 300


@pytest.mark.parametrize("preempt", [False, True])
@pytest.mark.parametrize("record", ["", "model"])
def test_there_are_few_other_events(preempt: bool, record: str, monkeypatch: pytest.MonkeyPatch) -> None:
    trace = Trace(make_game(preempt=preempt), monkeypatch, record)
    trace.model.play()
    counts = Counter(event.what for event in trace.timeouts())
    assert [counts[kind] for kind in ("leg", "turn")] == [trace.decided[kind] for kind in ("leg", "turn")]
    conflicts = sum(sum(robot.conflicts) for robot in trace.model.robots)
    assert 0 < counts["flight"] + counts["fight"] <= conflicts
    samples = len(trace.model.sample_times) - 1
    assert sum(1 for event in trace.events if not event.is_motion) <= 1.2 * (counts.total() + samples)


def test_a_lone_robot_has_fewer_events_than_periods(monkeypatch: pytest.MonkeyPatch) -> None:
    trace = Trace(Game(swarms=(Swarm(policy="avoid", size=1),)), monkeypatch)
    trace.model.play()
    assert trace.model.env.now == 6000
    assert len(trace.events) < 1000


def test_events_of_one_instant_are_ordered_by_priority(monkeypatch: pytest.MonkeyPatch) -> None:
    trace = Trace(make_game(), monkeypatch, "model")
    trace.model.play()
    # SimPy removes the events at which it paused with priority −1.
    events = [event for event in trace.events if event.priority >= 0]
    order = [event[:2] for event in events]
    assert order == sorted(order)
    kinds = defaultdict(set)
    for event in events:
        kind = "motion" if event.is_motion else "timer" if event.what == "Timer" else "end or sample"
        kinds[event.priority].add(kind)
    assert kinds == {0: {"end or sample"}, 1: {"timer"}, MOTION: {"motion"}}


def test_a_leg_takes_its_draw_in_whole_periods_rounded_up(monkeypatch: pytest.MonkeyPatch) -> None:
    game = make_game(leg_mean=1.0).replace(swarms=(Swarm(policy="avoid", size=4),))
    trace = Trace(game, monkeypatch)
    trace.model.play()
    for robot in range(game.size):
        legs = sorted((e.begin, e.time) for e in trace.timeouts() if (e.robot, e.what) == (robot, "leg"))
        draws = stream(SEED, robot, Purpose.LEG)
        assert [end - begin for begin, end in legs] == [math.ceil(draws.exponential(1.0) / 0.1) for _ in legs]
        assert len(legs) > 10


def test_a_sample_sees_the_world_after_the_previous_period() -> None:
    model = GameModel(make_game().replace(sample_period=0.1), seed=SEED, record="trajectory,conflicts")
    model.play()
    conflicts, trajectory = model.tables()["conflicts"], model.tables()["trajectory"]
    in_action = set()
    for robot, start, t_a in zip(conflicts["robot"], conflicts["start"], conflicts["t_a"], strict=True):
        begin = round(start / 0.1)
        # A sample at the start of an action does not show it; one at its end does.
        in_action |= {(robot, time) for time in range(begin + 1, begin + round(t_a / 0.1) + 1)}
    samples = zip(trajectory["robot"], trajectory["time"], trajectory["state"], strict=True)
    seen = {(robot, round(time / 0.1)): state for robot, time, state in samples}
    assert len(seen) == 15 * 1201
    assert {key for key, state in seen.items() if state == "A"} == in_action
    assert set(seen.values()) == {"A", "P"}


def test_the_clock_run_by_hand_plays_the_same_game() -> None:
    played, by_hand, by_steps = (GameModel(make_game(), seed=SEED) for _ in range(3))
    played.play()
    by_hand.env.run(until=37)
    assert by_hand.time == pytest.approx(3.7)
    assert by_hand.ended == ""
    by_hand.env.run()
    assert (by_hand.ended, by_hand.env.now) == ("time", 1200)
    with suppress(StopSimulation):
        while True:
            by_steps.env.step()
    assert played.results() == by_hand.results() == by_steps.results()
    by_hand.play()
    assert not by_hand.running
    assert by_hand.results() == played.results()


def test_the_clock_run_by_hand_keeps_all_records() -> None:
    played, by_hand = (GameModel(make_game(), seed=SEED, record="conflicts,model") for _ in range(2))
    played.play()
    by_hand.env.run()
    by_hand.play()
    assert len(by_hand.tables()["conflicts"]["robot"]) == len(played.tables()["conflicts"]["robot"]) > 0
    assert by_hand.datacollector.model_vars["time"][-1] == 120.0


@pytest.mark.parametrize("puck_limit", [None, 2])
def test_a_game_that_has_ended_stays_ended(puck_limit: int | None) -> None:
    model = GameModel(make_game().replace(puck_limit=puck_limit), seed=SEED)
    model.play()
    results = model.results()
    model.env.run(until=model.env.now + 1500)
    assert model.results() == results


@pytest.mark.parametrize(
    ("duration", "sample_period", "times"),
    [
        (30.0, 10.0, [0, 10, 20, 30]),
        (25.0, 10.0, [0, 10, 20, 25]),
        (5.0, 10.0, [0, 5]),
        (0.85, 0.25, [0, 0.3, 0.6, 0.9]),  # both in whole periods, rounded up
        (0.3, 0.01, [0, 0.1, 0.2, 0.3]),
    ],
)
def test_a_step_is_one_sampling_period(duration: float, sample_period: float, times: list[float]) -> None:
    game = make_game().replace(duration=duration, sample_period=sample_period)
    model = GameModel(game, seed=SEED, record="model")
    for time in times[1:]:
        assert model.ended == ""
        model.step()
        assert model.time == pytest.approx(time)
        assert model.running == (time < times[-1])
    assert model.ended == "time"
    results = model.results()
    for _ in range(2):
        model.step()
        assert not model.running
    assert model.results() == results
    assert model.sample_times == pytest.approx(times)
    assert model.datacollector.model_vars["time"] == model.sample_times


def test_steps_keep_to_multiples_of_the_sampling_period() -> None:
    model = GameModel(make_game(), seed=SEED)
    model.env.run(until=137)
    model.step()
    assert model.time == 20.0
