"""A game that is stepped, rewound and inspected equals a game played in one go."""

import gc
import weakref
from typing import Any

import numpy as np
import pytest

from kswarms.agents.actions import TOWARDS
from kswarms.agents.robot.state import ACTION
from kswarms.model.description.game import Game, Swarm
from kswarms.model.game_model import GameModel
from kswarms.scenarios.watch import player as player_module
from kswarms.scenarios.watch.player import Player
from kswarms.scenarios.watch.robot_view import RobotView, view_robot


def _game(policies: str = "avoid,attack", n: int = 10, **rest: Any) -> Game:
    swarms = tuple(Swarm(policy=policy, size=n // 2) for policy in policies.split(","))
    return Game(swarms=swarms, **{"duration": 40.0, **rest})


def view_of(model: GameModel, robot: int) -> RobotView:
    view = view_robot(model, robot)
    assert view is not None
    return view


LEARNING = _game("attack,inter-learner", learning=60.0)


def _state(player: Player) -> tuple[Any, ...]:
    return player.time, player.snapshot().positions.tolist(), player.model.results()


@pytest.mark.parametrize(
    "absent", [{}, {"absent": (1, 6)}, {"absent": (5, 6, 7, 8, 9), "absent_from": "game"}]
)
def test_a_game_played_in_steps_equals_a_game_played_in_one_go(absent: dict[str, Any]) -> None:
    game = LEARNING.replace(**absent)
    player = Player(game, 5)
    while not player.ended:
        player.advance(0.7)
    straight = GameModel(game, seed=5)
    straight.play()
    assert player.model.results() == straight.results()
    np.testing.assert_array_equal(player.snapshot().positions, straight.states.positions)
    assert player.time == 40.0


def test_time_is_negative_during_learning() -> None:
    player = Player(LEARNING, 0)
    assert (player.time, player.begin) == (-60.0, 60.0)
    for seconds, time, phase in ((59.9, -0.1, "learning"), (0.2, 0.1, "game")):
        player.advance(seconds)
        assert (player.time, player.model.phase) == (pytest.approx(time), phase)
    assert Player(_game(), 0).time == 0.0


def test_rewinding_restores_the_state() -> None:
    player = Player(LEARNING, 1)
    player.seek(-20.0)
    before = _state(player)
    learned = view_of(player.model, 7).bandits
    player.seek(15.0)
    assert player.time == 15.0
    assert _state(player) != before
    player.seek(-20.0)
    assert _state(player) == before
    assert view_of(player.model, 7).bandits == learned
    assert player.history[0].time == -60.0


def test_a_step_is_at_least_one_period_and_stops_at_the_end() -> None:
    player = Player(_game(), 0)
    player.advance(0.0)
    assert player.time == 0.1
    player.seek(1e9)
    assert (player.ended, player.time) == ("time", 40.0)
    player.advance(1.0)
    assert player.time == 40.0


def test_the_game_stops_at_the_start_of_the_next_conflict() -> None:
    player = Player(LEARNING, 2)
    for _ in range(3):
        before = player.time
        player.to_next_conflict(6)
        assert player.time > before
        assert player.snapshot().in_action[6] or player.ended
    # The conflict is recorded when it ends. It begins at the instant before this step.
    start = player.time - 0.1
    player.to_next_conflict(6)
    newest = player.latest_conflicts(6, 1)[0]
    assert newest.row["start"] - player.begin == pytest.approx(start)
    player.seek(-0.05)
    player.to_next_conflict(6)  # although the counts restart with the measured game
    assert player.time > 0.0


def test_latest_conflicts_are_newest_first() -> None:
    player = Player(_game(n=16), 0)
    player.seek(40.0)
    everybody = player.latest_conflicts(None, 1000)
    assert len(everybody) == len(player.conflicts) > 20
    own = player.latest_conflicts(3, 5)
    assert [conflict.row["start"] for conflict in own] == sorted((a.row["start"] for a in own), reverse=True)
    assert {conflict.row["robot"] for conflict in own} == {3}
    assert own == [conflict for conflict in everybody if conflict.row["robot"] == 3][:5]


def test_a_long_history_is_thinned_and_keeps_its_first_sample(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(player_module, "MAX_SAMPLES", 6)
    player = Player(_game(duration=100.0), 0)
    player.seek(100.0)
    times = [sample.time for sample in player.history]
    assert len(times) <= 6
    assert (times[0], times[-1]) == (0.0, 100.0)
    assert times == sorted(set(times))


def test_a_returned_history_does_not_change() -> None:
    player = Player(LEARNING, 0)
    returned = player.history
    player.advance(10.0)
    assert returned == player.history[:1]
    assert len(player.history) > 1


def test_a_sample_has_the_results_of_every_swarm() -> None:
    player = Player(LEARNING, 3)
    player.seek(40.0)
    last = player.history[-1]
    assert last.swarms == player.model.results()
    learners = [robot.policy for robot in player.model.members[1]]
    fighters = sum(learner.learned_action(0).direction == TOWARDS for learner in learners)  # type: ignore[attr-defined]
    assert last.fights == {(2, 1): fighters / len(learners)}


def test_games_that_are_no_longer_used_are_freed() -> None:
    player = Player(_game(), 0)
    player.advance(1.0)
    first = weakref.ref(player.model)
    player.seek(0.0)
    gc.collect()
    assert first() is None
    second = weakref.ref(player.model)
    del player
    gc.collect()
    assert second() is None


def test_a_view_has_the_state_of_the_robot() -> None:
    player = Player(LEARNING, 4)
    player.seek(-10.0)
    model = player.model
    for index in range(10):
        view = view_of(model, index)
        robot = model.robots[index]
        assert (view.robot, view.swarm, view.pucks) == (index, robot.swarm + 1, robot.pucks)
        assert sum(view.t_a) + view.t_p == pytest.approx(50.0)
        assert (view.doing == "in conflict") == (model.states.phase[index] == ACTION)
        assert len(view.sensors) == 8
        limit = model.game.parameters.active_range
        assert all(sensor.active == (sensor.free <= limit) for sensor in view.sensors)
        assert all(sensor.free <= model.game.body.sensor_range for sensor in view.sensors)
    learner, fighter = view_of(model, 7), view_of(model, 0)
    assert (list(learner.bandits), learner.learning, learner.rule) == ([1], True, "UCB(gamma=0.1211)")
    assert [arm.action for arm in learner.bandits[1]] == ["flight", "fight"]
    assert (fighter.bandits, fighter.learning, fighter.rule) == ({}, False, "")
    player.seek(1.0)
    assert not view_of(player.model, 7).learning


def test_the_sensor_ahead_measures_the_gap_to_a_robot_ahead(scene: Any) -> None:
    model = scene([(0.0, 0.0, 0.0)], [(0.4, 0.0, 0.0)])
    view = view_of(model, 0)
    assert (view.sensors[0].free, view.sensors[0].active) == (pytest.approx(0.4 - 2 * 0.085), True)
    assert view.sensors[4].free == pytest.approx(0.667)
    assert view.opponent == ""
