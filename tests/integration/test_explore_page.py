"""The page, rendered without a browser: it plays, shows and releases its game."""

import gc
import queue
import socket
import stat
import threading
import weakref
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

pytest.importorskip("solara", reason="needs the extra `explore`")

import ipyvuetify  # comes with solara

from kswarms.agents.common.errors import InputError
from kswarms.agents.learning.selection_rules import GAMMA, UCB
from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.cli import invoke
from kswarms.scenarios.explore import page
from kswarms.scenarios.explore.session import Session
from kswarms.scenarios.runs.run import Run, digest
from tests.helpers.rendered_page import RenderedPage, unfold, wait


def test_the_page_shows_the_arena_the_controls_and_the_curves(show: Callable[[str], RenderedPage]) -> None:
    shown = show("fig-6.1c")
    assert len(shown.arena().frame["x"]) == 20
    texts = shown.texts()
    for text in ("Play", "Robots N = 20", "S1: policy", "S2: policy", "Pucks", "SUD (pucks)", "World"):
        assert text in texts
    assert not any(text in texts for text in ("Skip learning", "Δ"))  # no learners


def test_buttons_play_step_and_reset_the_game(show: Callable[[str], RenderedPage]) -> None:
    shown = show("fig-6.1c")
    session = shown.session
    shown.click("Step")
    assert shown.arena().frame["time"] == 0.1
    shown.click("Play")
    wait(lambda: session.player.time > 1.0)
    shown.click("Pause")
    assert not session.playing
    wait(lambda: shown.arena().frame["time"] == session.player.time)
    shown.click("Reset")
    wait(lambda: shown.arena().frame["time"] == 0.0)
    shown.click("Next conflict")
    wait(lambda: shown.arena().frame["action"][session.selected] == 1)
    shown.find(ipyvuetify.Select, "Speed").v_model = 100
    assert session.speed == 100
    shown.click("To the end")
    wait(lambda: shown.arena().frame["ended"] == "time")
    shown.write("Go to t", 30.0)
    wait(lambda: shown.arena().frame["time"] == 30.0)


def test_a_page_whose_browser_draws_nothing_plays_slowly(
    show: Callable[[str], RenderedPage], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(page, "_PANELS_EVERY", 0.05)
    shown = show("fig-6.1c")
    shown.click("Play")
    wait(lambda: shown.session.player.time > 2.0)
    frame = shown.arena()
    frame.vue_drawn(frame.frame["number"])  # as a browser does
    shown.click("Pause")


def test_absent_robots_are_shown_and_can_be_added(show: Callable[[str | Run], RenderedPage]) -> None:
    game = CATALOGUE["fig-6.4b"].game("", 6).replace(absent=(0, 3), absent_from="game")
    shown = show(Run(digest(game, 2), game, 2, (("fig-6.4b", ""),)))
    session = shown.session
    assert shown.find(ipyvuetify.TextField, "Absent robots (they learn)").v_model == "0, 3"
    shown.open(1)
    shown.write("Robot, 0 to 5", 3)
    assert shown.tables()[0].rows[0] == ["robot", "3 of S2, inter-learner"]
    shown.click("Skip learning")
    wait(lambda: "Robot 3 is absent." in shown.texts())
    wait(lambda: shown.arena().frame["robots"] == (1, 2, 4, 5))
    wait(lambda: "Skip learning" not in shown.texts())
    shown.write("Absent robots", "")
    assert session.player.game.absent == ()
    wait(lambda: "Absent robots" not in shown.texts())


def test_a_robot_can_be_selected_and_inspected(show: Callable[[str], RenderedPage]) -> None:
    shown = show("fig-6.4b")
    session = shown.session
    session.player.advance(60.0)
    assert session.selected == 10  # the first learner
    shown.open(1)
    facts, sensors, bandit = shown.tables()
    assert facts.rows[0] == ["robot", "10 of S2, inter-learner"]
    assert len(sensors.rows[0]) == 8
    assert [row[0] for row in bandit.rows] == ["flight", "fight"]
    assert f"{UCB(gamma=GAMMA)!r}; learns" in shown.texts()
    shown.arena().vue_select(0)
    assert (session.selected, shown.arena().frame["selected"]) == (0, 0)
    assert shown.tables()[0].rows[0] == ["robot", "0 of S1, attack"]
    assert "It does not learn." in shown.texts()
    shown.write("Robot, 0 to 19", 99)
    assert session.selected == 19


def test_conflicts_are_listed_with_the_knowledge_of_the_robot(show: Callable[[str], RenderedPage]) -> None:
    shown = show("fig-6.4b")
    shown.open(2)
    assert "No conflict has ended yet." in shown.texts()
    shown.session.player.advance(60.0)
    shown.click("Step")
    own = shown.tables()[0].rows
    assert {row[1].split(" →")[0] for row in own} == {"10 of S2"}
    assert any(row[3].startswith("flight ") for row in own)
    assert {row[4].split("\n")[0] for row in own} == {"flight", "fight"}
    shown.find(ipyvuetify.Checkbox, "Conflicts of all robots").v_model = True
    assert len({row[1] for row in shown.tables()[0].rows}) > 1


def test_the_drawing_has_conflict_sectors_on_demand(show: Callable[[str], RenderedPage]) -> None:
    shown = show("fig-6.1c")
    assert not shown.arena().frame["sectors"]
    unfold(shown, "Drawing")
    shown.find(ipyvuetify.Checkbox, "Conflict sectors").v_model = True
    shown.find(ipyvuetify.Checkbox, "Sensors").v_model = False
    assert shown.arena().frame["sectors"]
    assert shown.arena().frame["sensors"] is None


def test_a_running_game_is_shown_frame_by_frame_and_the_panels_less_often(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(page, "_DRAW_TIMEOUT", 0.0)
    monkeypatch.setattr(page, "_PANELS_EVERY", 0.2)
    session, signals, over = Session("fig-6.1c"), page.Signals(), threading.Event()
    seen: list[float] = []
    panels: list[float] = []
    signals.frame.subscribe(lambda _: seen.append(session.player.time))
    signals.panels.subscribe(lambda _: panels.append(session.player.time))
    session.change(duration=8.0)

    def begin() -> None:
        session.toggle()
        signals.wake.set()

    def end(number: int) -> None:
        over.set()
        signals.wake.set()

    signals.controls.subscribe(end)  # updated when the game has ended
    threading.Timer(0.05, begin).start()
    page.play_session(session, signals, over)
    assert (seen, seen[-1]) == (sorted(seen), 8.0)
    assert 0 < len(panels) < len(seen)


# The server of solara imports it.
@pytest.mark.filterwarnings("ignore:websockets.legacy is deprecated:DeprecationWarning")
def test_a_page_is_served_at_the_printed_address(monkeypatch: pytest.MonkeyPatch) -> None:
    import uvicorn
    from solara.server import settings

    from kswarms.scenarios.explore import server

    opened: queue.Queue[str] = queue.Queue()
    announced: queue.Queue[str] = queue.Queue()
    links: list[Path] = []

    def run(own: uvicorn.Server, sockets: list[socket.socket]) -> None:
        own.started = True
        (listener,) = sockets
        address = f"http://127.0.0.1:{listener.getsockname()[1]}/?token={own.config.app.token}"
        assert announced.get(timeout=10) == address
        # The command line of a browser, which all users see, has no token.
        links.append(Path(opened.get(timeout=10).removeprefix("file://")))
        assert address in links[0].read_text()
        assert stat.S_IMODE(links[0].parent.stat().st_mode) == 0o700

    monkeypatch.setattr(uvicorn.Server, "run", run)
    monkeypatch.setattr(server.webbrowser, "open", opened.put)
    server.serve(new_session := partial(Session, "fig-6.2"), 0, True, announced.put)
    assert page.new_session is new_session
    assert not links[0].parent.exists()
    assert not settings.telemetry.mixpanel_enable
    with (
        socket.create_server(("127.0.0.1", 0)) as taken,
        pytest.raises(InputError, match="must be a free port"),
    ):
        server.serve(new_session, taken.getsockname()[1], False, announced.put)


@pytest.mark.filterwarnings("ignore:websockets.legacy is deprecated:DeprecationWarning")
@pytest.mark.parametrize("options", [[], ["--allow-code"]])
def test_the_controls_name_code_only_with_the_option(
    options: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from kswarms.scenarios.explore import server

    sessions: list[Session] = []
    monkeypatch.setattr(server, "serve", lambda new_session, *_: sessions.append(new_session()))
    assert invoke(["explore", "fig-6.1c", *options]) == 0
    sessions[0].change_swarm(0, policy=f"{tmp_path}/missing.py:Mine")
    assert ("must not name code or a file" in sessions[0].error) is (options == [])
    assert ("No such file" in sessions[0].error) is (options == ["--allow-code"])


def test_a_page_that_is_closed_ends_its_thread_and_frees_its_game(
    show: Callable[[str], RenderedPage],
) -> None:
    before = set(threading.enumerate())
    shown = show("fig-6.1c")
    (thread,) = set(threading.enumerate()) - before
    shown.click("Play")
    game = weakref.ref(shown.session.player.model)
    shown.context.close()
    assert not thread.is_alive()
    assert not shown.session.playing
    shown.session.player.__dict__.clear()
    gc.collect()
    assert game() is None
