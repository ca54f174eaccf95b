"""The page with absent robots: a robot keeps its number, whatever its row in the state arrays."""

import math

from kswarms.model.description.game import Game, Swarm
from kswarms.model.game_model import GameModel
from kswarms.scenarios.explore.session import Session
from kswarms.scenarios.explore.views import charts_of, frame_of
from kswarms.scenarios.runs.run import Run, digest
from kswarms.scenarios.watch.conflicts import conflicts_of
from kswarms.scenarios.watch.player import Player
from kswarms.scenarios.watch.robot_view import view_robot

SWARMS = (Swarm(policy="attack", size=4), Swarm(policy="inter-learner", size=4))
NEVER = Game(swarms=SWARMS, learning=40.0, duration=30.0, absent=(1, 4))
LEAVING = NEVER.replace(absent=(4, 5, 6, 7), absent_from="game")


def _run(game: Game, seed: int = 0) -> Run:
    return Run(digest(game, seed), game, seed, (("mine", ""),))


def test_robots_are_drawn_and_viewed_by_number() -> None:
    player = Player(NEVER, 0)
    now = player.snapshot()
    assert now.robots == (0, 2, 3, 5, 6, 7)
    assert now.swarm.tolist() == [0, 0, 0, 1, 1, 1]
    assert player.view_robot(1) is player.view_robot(4) is player.view_robot(8) is None
    for number, robot in zip(now.robots, player.model.robots, strict=True):
        view = player.view_robot(number)
        assert view is not None
        assert (view.robot, view.swarm, view.policy) == (number, robot.swarm + 1, robot.policy_name)
    frame = frame_of(player, 1, 7, sectors=False, sensors=True)
    assert (frame["robots"][5], len(frame["sensors"])) == (7, 8)
    assert len(frame["x"]) == len(frame["swarm"]) == 6
    assert frame_of(player, 1, 4, sectors=False, sensors=True)["sensors"] is None


def test_the_robot_met_last_is_named_by_number() -> None:
    model = GameModel(NEVER, 0, record="conflicts")
    model.play()
    table = model.tables()["conflicts"]
    met = dict(zip(table["robot"], zip(table["opponent"], table["opponent_swarm"], strict=True), strict=True))
    assert any(opponent > 1 for opponent, _ in met.values())  # its row differs from its number
    for robot, (opponent, swarm) in met.items():
        view = view_robot(model, robot)
        assert view is not None
        assert view.opponent == f"robot {opponent} of S{swarm}"


def test_the_next_conflict_is_found_by_number_and_an_absent_robot_has_none() -> None:
    player = Player(NEVER, 0)
    player.to_next_conflict(4)
    assert player.time == -40.0
    player.to_next_conflict(7)
    assert player.snapshot().in_action[player.snapshot().robots.index(7)]


def test_a_robot_that_leaves_is_followed_until_it_leaves() -> None:
    player = Player(LEAVING, 0)
    while player.time < 0:
        player.to_next_conflict(6)
    assert player.time == 0.0
    assert player.view_robot(6) is None
    assert player.snapshot().robots == (0, 1, 2, 3)
    player.seek(-10.0)
    assert len(player.snapshot().robots) == 8


def test_the_lines_of_robots_that_left_end_when_they_leave() -> None:
    player = Player(LEAVING, 0)
    player.seek(20.0)
    charts = charts_of(player.history)
    (learned,) = charts.pop("Share of learners whose best action is to fight")["series"]
    times = [time for time, _ in learned["data"]]
    assert (times[0], times[-1] < 0) == (-40.0, True)
    assert all(chart["series"][0]["data"][-1][0] == 20.0 for chart in charts.values())


def test_conflicts_name_robots_by_number_with_their_knowledge() -> None:
    conflicts = conflicts_of(_run(NEVER))
    assert {conflict.row["robot"] for conflict in conflicts} <= {0, 2, 3, 5, 6, 7}
    learned = [each for each in conflicts if each.row["robot"] == 7 and not math.isnan(each.row["reward"])]
    assert learned
    assert all(each.known for each in learned)
    assert [sum(arm.n for arm in each.known) for each in learned] == list(range(len(learned)))


def test_a_session_plays_a_run_with_absent_robots_and_can_add_them() -> None:
    session = Session(_run(NEVER, 3))
    assert session.player.game == NEVER
    assert session.selected == 5  # the first learner present
    session.change(seed=4)
    assert (session.error, session.player.game.absent) == ("", (1, 4))
    session.change_absent("7, 0")
    assert session.player.game.absent == (0, 7)
    for text, error in (
        ("9", "absent=9: must be a robot of the game, 0 to 7"),
        ("x", "absent='x': must be int"),
    ):
        session.change_absent(text)
        assert session.error.startswith(error)
    session.change_absent("")
    assert (session.error, session.player.game.absent) == ("", ())
