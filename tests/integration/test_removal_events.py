"""Removals of robots by policies, reporters and events of the clock (docs/howto.md)."""

import math
from collections.abc import Callable, Iterator
from typing import Any

import pytest
import simpy

from kswarms import ForagingModel, GameModel
from kswarms.agents.actions import Action
from kswarms.agents.policies.interface import Setting
from kswarms.agents.robot.krembot import Krembot
from kswarms.model.clock import BEFORE_TIMEOUTS, Instant
from kswarms.model.description.presets import PRESETS
from tests.conftest import Scene
from tests.games import ALL_TABLES, check_times_and_pucks, game_under_way, make_game

Remove = Callable[[GameModel, Krembot], object]


class Remover:
    """Fights; in its tenth conflict, calls `act` with its model and its robot."""

    act: Callable[[GameModel, Krembot], object]
    during: str

    def __init__(self, setting: Setting) -> None:
        self._fight = next(action for action in setting.actions if action.name == "fight")
        self.place = setting.place
        self.model: GameModel | None = None  # the trial has none
        self.calls = {"choose": 0, "learn": 0}

    def _count(self, name: str) -> None:
        self.calls[name] += 1
        if self.model is not None and self.calls[name] == 10 and name == self.during:
            (robot,) = [robot for robot in self.model.robots if robot.policy is self]
            Remover.act(self.model, robot)

    def choose(self, _opponent: int) -> Action:
        self._count("choose")
        return self._fight

    def learn(self, _t_a: float, _t_p: float, _n_active: int) -> tuple[float, float]:
        self._count("learn")
        return 0.0, 0.0

    def freeze(self) -> None:
        pass


def remove_neighbours(model: GameModel, robot: Krembot) -> None:
    for other in robot.get_neighbors_in_radius(0.4)[0]:
        other.remove()


ACTS: dict[str, Remove] = {
    "itself": lambda _, robot: robot.remove(),
    "its neighbours": remove_neighbours,
    "the first robot": lambda model, _: model.robots[0].remove(),
    "the last robot": lambda model, _: model.robots[-1].remove(),
    "all": lambda model, _: model.remove_all_agents(),
}


@pytest.mark.parametrize("during", ["choose", "learn"])
@pytest.mark.parametrize("act", ACTS)
@pytest.mark.parametrize("preempt", [False, True])
def test_a_policy_may_remove_robots(
    act: str, during: str, preempt: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Remover, "act", staticmethod(ACTS[act]), raising=False)
    monkeypatch.setattr(Remover, "during", during, raising=False)
    model = ForagingModel(
        n=24, policies=[Remover, "mixed"], seed=2, duration=60.0, sample_period=0.1, record=ALL_TABLES,
        parameters=PRESETS["fitted"].replace(preempt=preempt),
    )  # fmt: skip
    for robot in model.members[0]:
        robot.policy.model = model  # type: ignore[attr-defined]
    begun: dict[int, list[int]] = {}
    while model.running:
        model.step()
        check_times_and_pucks(model)
        assert [robot.index for robot in model.robots] == list(range(len(model.robots)))
        for robot in model.removed:
            assert begun.setdefault(robot.number, robot.conflicts.copy()) == robot.conflicts
    assert model.removed
    assert (model.ended, model.time) == ("time", 60.0)
    table = model.tables()["conflicts"]
    swarm = dict(zip(table["robot"], table["swarm"], strict=True))
    assert all(s == number // 12 + 1 for number, s in swarm.items())
    ends = map(sum, zip(table["start"], table["t_a"], table["t_p"], strict=True))
    assert max(ends) <= 60.0 + 1e-9


class Scripted:
    """Fights; calls `act` once, in `choose` or in `learn`."""

    def __init__(self, model: GameModel, robot: Krembot, act: Callable[[], object], during: str) -> None:
        self._fight = next(action for action in model.game.action_set if action.name == "fight")
        self._act: Callable[[], object] | None = act
        self._during = during
        self.calls: list[str] = []
        robot.policy = self
        robot._learn = self.learn

    def _count(self, name: str) -> None:
        self.calls.append(name)
        if self._act is not None and name == self._during:
            act, self._act = self._act, None
            act()

    def choose(self, _opponent: int) -> Action:
        self._count("choose")
        return self._fight

    def learn(self, _t_a: float, _t_p: float, _n_active: int) -> tuple[float, float]:
        self._count("learn")
        return 0.0, 0.0


def two_pairs(scene: Scene) -> tuple[GameModel, list[Krembot]]:
    """Return a game of two pairs of robots, each with one robot that faces the other; no wall is near."""
    places = [(-0.4, -0.4, 0.0), (-0.2, -0.4, 0.0)], [(0.2, 0.4, 0.0), (0.4, 0.4, 0.0)]
    model = scene(*places, policies="attack,attack", record="conflicts")
    return model, list(model.robots)


def test_the_conflict_with_a_robot_that_is_removed_in_it_does_not_begin(scene: Scene) -> None:
    for removed in (0, 1):
        model, robots = two_pairs(scene)
        Scripted(model, robots[0], robots[removed].remove, "choose")
        model.env.run(until=1)
        # The other pair decides in the same period.
        assert [robot.conflicts for robot in robots] == [[0, 0], [0, 0], [0, 1], [0, 0]]
        assert [robot.state for robot in robots] == ["P", "P", "A", "P"]
        assert [robot.number for robot in model.robots] == [n for n in range(4) if n != removed]
        assert model.states.opponent.tolist() == [-1, 2, -1]
        model.play()
        rows = [dict(zip(model.tables()["conflicts"], row, strict=True)) for row in rows_of(model)]
        assert removed not in {row[name] for row in rows for name in ("robot", "opponent")}
        for row in rows:
            assert row["opponent"] in row["seen"][row["opponent_swarm"] - 1]
            assert removed not in row["seen"][0]


def rows_of(model: GameModel) -> list[tuple[Any, ...]]:
    return list(zip(*model.tables()["conflicts"].values(), strict=True))


def test_a_policy_does_not_meet_a_robot_that_another_policy_removed(scene: Scene) -> None:
    # Two robots face the robot between them.
    places = [(-0.25, 0.0, 0.0), (0.0, 0.0, 1.0)], [(0.25, 0.0, math.pi), (0.5, 0.5, 1.0)]
    for policies_kept in (False, True):
        model = scene(*places, policies="attack,attack")
        first, victim, second, _ = model.robots
        act = (lambda: None) if policies_kept else victim.remove
        Scripted(model, first, act, "choose")
        watched = Scripted(model, second, lambda: None, "choose")
        model.env.run(until=1)
        assert watched.calls == (["choose"] if policies_kept else [])


def test_a_robot_removed_while_it_learns_does_not_choose(scene: Scene) -> None:
    model, robots = two_pairs(scene)
    policy = Scripted(model, robots[0], robots[0].remove, "learn")
    model.play()
    assert policy.calls == ["choose", "learn"]
    assert sum(robots[0].conflicts) == 1


@pytest.mark.parametrize("supply", [None, 3])
def test_a_removal_does_not_change_pending_decisions_of_others(supply: int | None) -> None:
    compared = 0
    for seed in range(40):
        game = make_game("attack", "avoid", size=3, side=4.0, duration=60.0, supply=supply)
        model, twin = GameModel(game, seed), GameModel(game, seed)
        while model._due == 0 or model.now < 10 + seed % 3 * 100:
            model.env.step()
        twin.env.run(until=model.now)
        gone = min(model.robots, key=lambda robot: -min(robot.get_nearest_neighbors(1)[1]))
        if min(gone.get_nearest_neighbors(1)[1]) < 1.0:
            continue
        gone.remove()
        decision = next(time for time, _, _, event in model.env._queue if event is model._motion)
        end = decision + 8
        for each in (model, twin):
            each.env.run(until=end)
        bodies = [
            [
                (r.number, *r.position, r.heading, r.state, r.carrying)
                for r in each.robots
                if r.number != gone.number
            ]
            for each in (model, twin)
        ]
        assert bodies[0] == bodies[1]
        assert model.pucks[1 - gone.swarm] == twin.pucks[1 - gone.swarm]
        compared += 1
    assert compared > 10


def test_a_process_on_the_clock_may_remove_robots() -> None:
    model = game_under_way(seconds=0.1)

    def remove_one_by_one() -> Iterator[simpy.Event]:
        for _ in range(5):
            yield model.env.timeout(73)
            model.robots[model.now % len(model.robots)].remove()

    model.env.process(remove_one_by_one())
    model.play()
    check_times_and_pucks(model)
    assert len(model.robots) == 7
    periods = [sum(robot.times()[0]) + robot.times()[1] for robot in model.removed]
    assert periods == [1 + 73 * k for k in range(1, 6)]


def test_an_event_before_all_others_may_remove_robots() -> None:
    model = game_under_way(seconds=0.1)
    Instant(model.env, BEFORE_TIMEOUTS, lambda _: model.robots[5].remove()).schedule_at(model.now + 100)
    model.play()
    check_times_and_pucks(model)
    assert len(model.robots) == 11


def test_a_reporter_may_remove_robots() -> None:
    class Shrinking(ForagingModel):
        def __init__(self, **arguments: Any) -> None:
            super().__init__(**arguments)
            self.datacollector.model_reporters["left"] = lambda model: model.shrink()

        def shrink(self) -> int:
            if self.steps and self.robots:
                self.robots[-1].remove()
            return len(self.robots)

    model = Shrinking(n=4, seed=1, duration=60.0)
    model.play()
    assert model.datacollector.model_vars["left"] == [4, 3, 2, 1, 0, 0, 0]
    check_times_and_pucks(model)


@pytest.mark.parametrize("seed", range(3))
def test_robots_removed_between_two_events_of_the_clock(seed: int) -> None:
    model = game_under_way(seconds=2.0, seed=seed, duration=300.0)
    for k in range(400):
        model.env.step()
        if k % 40 == 0 and model.robots:
            model.robots[k % len(model.robots)].remove()
            assert all(math.isfinite(x) for robot in model.robots for x in robot.position)
    assert len(model.robots) == 2
    model.play()
    check_times_and_pucks(model)
