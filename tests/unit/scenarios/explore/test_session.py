"""The session of a page: its controls and buttons, without widgets."""

import math
from collections.abc import Callable
from pathlib import Path

import pytest

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.explore import playback
from kswarms.scenarios.explore import session as session_module
from kswarms.scenarios.explore.session import Session
from kswarms.scenarios.runs.errors import RunError
from kswarms.scenarios.runs.run import Run, digest

COWARD = """
class Coward:
    def __init__(self, setting):
        self.flight = setting.actions[0]
    def choose(self, opponent):
        return self.flight
"""


@pytest.fixture
def session() -> Session:
    return Session("fig-6.1c")


def test_a_session_starts_with_a_scenario(session: Session) -> None:
    assert (session.source, session.title) == ("fig-6.1c", CATALOGUE["fig-6.1c"].title)
    assert session.player.game == CATALOGUE["fig-6.1c"].game("", 20)
    assert (session.player.time, session.playing, session.error, session.active) == (0.0, False, "", False)
    with pytest.raises(InputError, match=r"id='fig-9'"):
        Session("fig-9")


def test_a_session_can_start_with_a_run() -> None:
    game = CATALOGUE["fig-7.10"].game("delta=0.1", 8)
    run = Run(digest(game, 7), game, 7, (("fig-7.10", "delta=0.1"), ("other", "")))
    session = Session(run)
    assert (session.player.game, session.player.seed) == (game, 7)
    assert session.source == f"run {run.digest}"
    assert session.title == "fig-7.10 delta=0.1, other"
    session.change(seed=8)
    assert (session.error, session.player.seed) == ("", 8)


def test_a_table_or_a_file_offers_all_its_conditions(tmp_path: Path) -> None:
    assert list(Session("table-6.1").conditions) == ["fig-6.4a", "fig-6.4b"]
    file = tmp_path / "mine.toml"
    file.write_text(CATALOGUE["fig-6.12"].replace(id="mine").to_toml())
    session = Session(str(file))
    assert list(session.conditions) == [condition.name for condition in CATALOGUE["fig-6.12"].conditions]
    session.select_condition("random")
    assert session.player.game.swarms[1].policy == "random"


def test_an_invalid_control_is_reported_in_one_line_and_the_game_is_kept(session: Session) -> None:
    session.player.advance(3.0)
    kept = session.player
    session.change(parameters="fitted, friction=-1")
    assert session.error == "friction=-1.0: must be greater than or equal to 0"
    assert session.player is kept
    assert session.form.fields["parameters"] == "fitted, friction=-1"
    session.change_swarm(0, policy="atack")
    assert session.error.startswith("friction=")  # both are invalid
    session.change(parameters="fitted")
    assert session.error.startswith("policy='atack': must be one of avoid")
    session.load("fig-nine")
    assert session.error.startswith("id='fig-nine'")
    session.change_swarm(0, policy="aggressive")
    assert (session.error, session.player.game.swarms[0].policy) == ("", "aggressive")


def test_a_control_changes_the_game_and_restarts_it(session: Session) -> None:
    session.player.advance(5.0)
    session.select(19)
    session.change(n=6)
    assert (session.player.game.size, session.player.time, session.selected) == (6, 0.0, 5)
    session.load("fig-6.4b")
    assert (session.selected, session.player.time) == (3, -3000.0)  # the first learner


def test_shares_and_swarms_change_n_to_a_suitable_number(session: Session) -> None:
    assert session.step_of_n() == 2
    session.change_swarm(0, share=2)
    assert (session.step_of_n(), session.form.n, session.error) == (3, 21, "")
    for more, sizes in ((1, [10, 5, 5]), (-2, [20])):
        session.add_swarms(more)
        assert [swarm.size for swarm in session.player.game.swarms] == sizes
    session.change_swarm(0, share=0)
    assert session.error == "share=0: must be greater than or equal to 1"


def test_the_speed_is_the_time_of_the_game_per_second(session: Session) -> None:
    assert not session.tick(1.0)
    session.toggle()
    assert session.active
    assert session.tick(0.1)
    assert session.player.time == pytest.approx(1.0)
    session.speed = 1
    assert not session.tick(0.06)  # less than a period
    assert session.tick(0.06)
    assert session.player.time == pytest.approx(1.1)
    assert not session.tick(0.06)
    assert session.tick(0.02)  # the remainder is kept
    session.toggle()
    assert not session.tick(1.0)
    session.step()
    assert session.player.time == pytest.approx(1.3)


def test_the_game_goes_to_an_instant_while_paused(session: Session, monkeypatch: pytest.MonkeyPatch) -> None:
    for instant in (50.0, 20.0):
        session.go_to(instant)
        while session.active:
            assert session.tick(0.01)
        assert session.player.time == instant
    monkeypatch.setattr(playback, "_BURST", 0.0)
    session.go_to(30.0)
    session.tick(0.01)  # without time nothing is played, and the page is updated
    assert (session.player.time, session.active) == (20.0, True)
    monkeypatch.undo()
    session.go_to(1e9)
    while session.active:
        session.tick(0.01)
    assert session.player.ended == "time"
    session.reset()
    assert (session.player.time, session.player.ended) == (0.0, "")


@pytest.mark.parametrize("time", [math.nan, math.inf, -math.inf])
def test_an_invalid_instant_is_reported_until_a_valid_one_is_given(time: float, session: Session) -> None:
    session.player.advance(3.0)
    for instant in (1.0, 5.0):
        session.go_to(time)
        assert session.error == f"t={time}: must be a finite number of seconds"
        assert not session.active
        session.go_to(instant)
        assert session.error == ""
        while session.active:
            session.tick(0.01)
        assert session.player.time == instant


def test_a_finished_game_does_not_move(session: Session) -> None:
    session.change(duration=2.0)
    session.toggle()
    session.tick(1.0)
    assert session.player.ended
    assert (session.active, session.tick(1.0)) == (False, False)


def test_the_next_conflict_is_one_of_the_selected_robot_and_a_closed_session_does_not_play(
    session: Session,
) -> None:
    session.toggle()
    session.select(4)
    session.next_conflict(session.selected)
    assert not session.playing
    assert session.player.snapshot().in_action[4]
    session.toggle()
    session.close()
    assert not session.tick(1.0)


@pytest.mark.parametrize("failure", [ZeroDivisionError("by zero"), SystemExit("enough")])
def test_a_game_that_fails_stops_and_reports_the_error(
    failure: BaseException, session: Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    def choose(_opponent: int) -> None:
        raise failure

    for robot in session.player.model.robots:
        monkeypatch.setattr(robot.policy, "choose", choose)
    session.toggle()
    while session.active:
        session.tick(1.0)
    assert session.error == f"the game failed: {type(failure).__name__}: {failure}"
    session.go_to(500.0)
    assert not session.tick(1.0)  # a failed game does not move
    session.reset()  # new robots
    assert (session.error, session.player.time) == ("", 0.0)
    session.step()
    assert session.player.time == 0.1


def test_an_invalid_text_does_not_break_the_other_controls(session: Session) -> None:
    session.change_swarm(0, policy="learner(rule=")
    session.change_learning("reward", delta=0.2)
    assert session.error.startswith("policy='learner(rule=': must be name or name(")
    session.change(parameters="fited")
    session.change_parameter("friction", 0.2)
    assert session.error.startswith("parameters='fited': must begin with one of")


def test_a_user_defined_policy_plays(tmp_path: Path) -> None:
    session = Session("fig-6.1c", allow_code=True)
    file = tmp_path / "mine.py"
    file.write_text(COWARD)
    session.change_swarm(1, policy=f"{file}:Coward")
    assert session.error == ""
    session.player.seek(60.0)
    assert {conflict.row["action"] for conflict in session.player.conflicts} == {"flight"}
    file.write_text("class Coward:\n    pass\n")
    session.change_swarm(1, policy=f"{file}:Cowerd")
    assert "has no class Cowerd" in session.error


@pytest.mark.parametrize("back", [Session.reset, lambda session: session.go_to(1.0)])
def test_a_game_that_cannot_be_rewound_keeps_its_state_until_it_can(
    back: Callable[[Session], None], tmp_path: Path
) -> None:
    session = Session("fig-6.1c", allow_code=True)
    file = tmp_path / "mine.py"
    file.write_text(COWARD)
    session.change_swarm(1, policy=f"{file}:Coward")
    session.player.advance(3.0)
    file.write_text("half a th")
    back(session)
    assert session.error.startswith(f"policy='{file}:Coward': importing mine.py raises SyntaxError")
    session.tick(0.0)
    assert (session.player.time, session.active) == (3.0, False)
    session.step()
    assert session.player.time == pytest.approx(3.1)
    file.write_text(COWARD)
    back(session)
    assert session.error == ""
    while session.active:
        session.tick(0.0)
    assert session.player.time <= 1.0


ODD_TEXTS = ["", "x" * 5000, "\0", "a\nb", "\ud800", "+" * 500, "(" * 2000, f"attack({'[' * 3000}", "x:"]
ODD_NUMBERS = [-1, 2**70, 10**4000, math.nan, math.inf, 1e308, 5e-324]


@pytest.mark.parametrize(
    "change",
    [
        *(lambda own, text=text: own.change_swarm(0, policy=text) for text in ODD_TEXTS),
        *(lambda own, text=text: own.load(text) for text in ODD_TEXTS),
        *(lambda own, text=text: own.change(parameters=text) for text in ODD_TEXTS),
        *(lambda own, text=text: own.change_absent(text) for text in ODD_TEXTS[1:]),
        *(lambda own, value=value: own.change(side=value) for value in ODD_NUMBERS),
        *(lambda own, value=value: own.change(duration=value) for value in ODD_NUMBERS),
        *(lambda own, value=value: own.change(supply=value) for value in ODD_NUMBERS),
        *(lambda own, value=value: own.change(seed=value) for value in ODD_NUMBERS),
        *(lambda own, value=value: own.change_swarm(0, share=value) for value in ODD_NUMBERS[:3]),
        *(lambda own, value=value: own.go_to(value) for value in (math.nan, math.inf, -math.inf)),
    ],
)
def test_an_odd_input_is_reported_in_one_short_line(
    session: Session, change: Callable[[Session], None]
) -> None:
    kept = session.player
    change(session)
    assert session.error.partition("=")[0].isidentifier()  # not: the game failed
    assert "\n" not in session.error
    assert len(session.error) < 500
    assert session.player is kept
    session.step()
    assert session.player.time == pytest.approx(0.1)


def test_rewinding_keeps_the_error_of_an_invalid_control(session: Session) -> None:
    session.player.advance(3.0)
    session.change_swarm(0, policy="atack")
    session.reset()
    assert session.player.time == 0.0
    assert session.error.startswith("policy='atack'")


def test_an_error_before_the_game_is_a_run_error(session: Session, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(session_module, "Player", lambda *_: 1 // 0)
    with pytest.raises(RunError, match=r"the game of fig-6\.1c failed: ZeroDivisionError: integer"):
        Session("fig-6.1c")
