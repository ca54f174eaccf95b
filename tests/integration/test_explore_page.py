"""The page, rendered without a browser: its widgets do what they say, and it lets its game go."""

import gc
import socket
import threading
import time
import weakref
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

solara = pytest.importorskip("solara", reason="needs the extra `explore`")

import ipyvuetify  # noqa: E402  # which comes with solara

from agents.errors import InputError  # noqa: E402
from agents.selection import UCB  # noqa: E402
from scenarios.catalogue import CATALOGUE  # noqa: E402
from scenarios.explore import page  # noqa: E402
from scenarios.explore.session import Session  # noqa: E402
from scenarios.runs import Run, digest  # noqa: E402


@solara.component
def _App() -> None:  # noqa: N802  # a component
    page.Layout(children=[page.Page()])


class Shown:
    """The rendered page, with ways to find and use its widgets."""

    def __init__(self, session: Session) -> None:
        self.session = session
        self.box, self.context = solara.render(_App(), handle_error=False)

    def widgets(self) -> list[Any]:
        """Return all widgets, outer ones first."""
        found, rest = [], [self.box]
        while rest:
            widget = rest.pop(0)
            if not isinstance(widget, str):
                found.append(widget)
                slots = [slot["children"] for slot in getattr(widget, "v_slots", None) or []]
                inner = [*(getattr(widget, "children", None) or []), *slots]
                rest = [each for one in inner for each in (one if isinstance(one, list) else [one])] + rest
        return found

    def text_of(self, widget: Any) -> str:
        inner = getattr(widget, "children", None) or []
        label = getattr(widget, "label", "")
        return " ".join(each.strip() for each in (label, *inner) if isinstance(each, str) and each)

    def texts(self) -> str:
        """Return all text on the page, but that which Vue components have."""
        return " | ".join(filter(None, map(self.text_of, self.widgets())))

    def find(self, kind: type[Any], text: str) -> Any:
        """Return the first widget of a kind whose text begins so."""
        return next(w for w in self.widgets() if isinstance(w, kind) and self.text_of(w).startswith(text))

    def click(self, text: str) -> None:
        self.find(ipyvuetify.Btn, text).fire_event("click", {})

    def write(self, text: str, value: object) -> None:
        """Write into a field, and leave it."""
        field = self.find(ipyvuetify.TextField, text)
        field.v_model = str(value)
        if field._event_handlers_map:  # else it takes each letter at once
            field.fire_event("focusout", {})

    def open(self, tab: int) -> None:
        next(w for w in self.widgets() if isinstance(w, ipyvuetify.Tabs)).v_model = tab

    def tables(self) -> list[Any]:
        return [widget for widget in self.widgets() if hasattr(widget, "rows")]

    def arena(self) -> Any:
        return next(widget for widget in self.widgets() if hasattr(widget, "scene"))


@pytest.fixture
def show(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[str], Shown]]:
    shown: list[Shown] = []
    monkeypatch.setattr(page, "_GIVE_UP", 0.02)  # there is no browser that would draw

    def render(start: str | Run) -> Shown:
        session = Session(start)
        monkeypatch.setattr(page, "Session", lambda _: session)
        shown.append(Shown(session))
        return shown[-1]

    yield render
    for each in shown:
        each.context.close()


def _wait(for_this: Callable[[], bool]) -> None:
    """Wait for what the thread of a page does."""
    patience = time.monotonic() + 10.0
    while not for_this():
        assert time.monotonic() < patience
        time.sleep(0.01)


def test_the_page_shows_the_arena_the_controls_and_the_curves(show: Callable[[str], Shown]) -> None:
    shown = show("fig-6.1c")
    assert len(shown.arena().frame["x"]) == 20
    texts = shown.texts()
    for text in ("Play", "Robots N = 20", "S1: policy", "S2: policy", "Pucks", "SUD (pucks)", "World"):
        assert text in texts
    assert "Skip learning" not in texts  # nobody learns
    assert "Δ" not in texts


def test_buttons_play_step_and_reset_the_game(show: Callable[[str], Shown]) -> None:
    shown = show("fig-6.1c")
    session = shown.session
    shown.click("Step")
    assert shown.arena().frame["time"] == 0.1
    shown.click("Play")
    _wait(lambda: session.player.time > 1.0)
    shown.click("Pause")
    assert not session.playing
    _wait(lambda: shown.arena().frame["time"] == session.player.time)
    shown.click("Reset")
    _wait(lambda: shown.arena().frame["time"] == 0.0)
    shown.click("Next conflict")
    _wait(lambda: shown.arena().frame["action"][session.chosen] == 1)
    shown.find(ipyvuetify.Select, "Speed").v_model = 100
    assert session.speed == 100
    shown.click("To the end")
    _wait(lambda: shown.arena().frame["ended"] == "time")
    shown.write("Go to t", 30.0)
    _wait(lambda: shown.arena().frame["time"] == 30.0)


def test_a_page_whose_browser_is_away_plays_on_slowly(
    show: Callable[[str], Shown], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(page, "_PANELS_EVERY", 0.05)
    shown = show("fig-6.1c")
    shown.click("Play")
    _wait(lambda: shown.session.player.time > 2.0)
    frame = shown.arena()
    frame.vue_drawn(frame.frame["number"])  # what a browser does
    shown.click("Pause")


def test_learning_can_be_skipped_and_its_controls_change_it(show: Callable[[str], Shown]) -> None:
    shown = show("fig-6.4b")
    session = shown.session
    shown.write("Time to learn", 100.0)
    assert session.player.time == -100.0
    assert "Share of learners" in shown.texts()
    shown.click("Skip learning")
    _wait(lambda: shown.arena().frame["time"] == 0.0)
    _wait(lambda: "Skip learning" not in shown.texts())
    shown.find(ipyvuetify.Slider, "Δ = 0.125").v_model = 0.2
    shown.find(ipyvuetify.Slider, f"γ = {UCB().gamma:g}").v_model = 0.5
    assert session.player.game.swarms[1].policy == (
        "inter-learner(reward='wlu(delta=0.2)', rule='ucb(gamma=0.5)')"
    )
    shown.find(ipyvuetify.Select, "Reward").v_model = "individual"
    shown.find(ipyvuetify.Select, "Selection rule").v_model = "greedy"
    assert session.player.game.swarms[1].policy == "inter-learner(reward='individual', rule='greedy')"


def test_what_a_slider_cannot_show_stays_until_it_is_moved(
    show: Callable[[str], Shown], tmp_path: Path
) -> None:
    (tmp_path / "off.toml").write_text(
        """
        id = "off"
        title = "Between the steps of the sliders"
        densities = [20]
        [[conditions]]
        learning = 10
        parameters = "fitted, friction=0.1234"
        swarms = [{ policy = "attack", drive = 0.63 }, { policy = "inter-learner(rule='ucb(gamma=0.1211)')" }]
        """
    )
    shown = show(str(tmp_path / "off.toml"))
    described = shown.session.form
    # What Vuetify reports as soon as it has drawn them.
    for label, nearest in (("Drive in P 0.63", 0.65), ("γ", 0.12), ("Friction", 0.12)):
        shown.find(ipyvuetify.Slider, label).v_model = nearest
    assert shown.session.form == described
    shown.find(ipyvuetify.Slider, "γ").v_model = 0.2
    assert shown.session.form.swarms[1].policy == "inter-learner(rule='ucb(gamma=0.2)')"


def test_every_control_changes_the_game(show: Callable[[str], Shown]) -> None:
    shown = show("fig-6.10a")
    session = shown.session
    shown.find(ipyvuetify.Select, "Condition").v_model = list(session.curves)[1]
    assert session.curve == list(session.curves)[1]
    shown.find(ipyvuetify.Slider, "Robots N").v_model = 8
    shown.write("Seed", 5)
    shown.find(ipyvuetify.Combobox, "S1: policy").v_model = "random"
    shown.write("Share of the robots", 3)
    shown.find(ipyvuetify.Slider, "Drive in P").v_model = 0.7
    shown.find(ipyvuetify.Slider, "Drive in A").v_model = 0.5
    game = session.player.game
    assert (game.size, session.player.seed) == (8, 5)
    assert game.swarms[0].model_dump() == {"policy": "random", "size": 6, "drive": 0.7, "drive_action": 0.5}
    shown.click("Add a swarm")
    assert len(session.player.game.swarms) == 3
    shown.click("Remove S3")
    player = session.player
    shown.find(ipyvuetify.TextField, "Seed").fire_event("focusout", {})
    assert session.player is player  # nothing was written
    shown.find(ipyvuetify.Combobox, "Scenario").v_model = "fig-6.1a"
    assert session.curves.keys() == {""}
    assert session.player.game.swarms[1].policy == "avoid"


def test_who_is_absent_is_told_and_can_come_back(show: Callable[[str | Run], Shown]) -> None:
    game = CATALOGUE["fig-6.4b"].game("", 6).replace(absent=(0, 3), absent_from="game")
    shown = show(Run(digest(game, 2), game, 2, (("fig-6.4b", ""),)))
    session = shown.session
    assert shown.find(ipyvuetify.TextField, "Absent robots (they learn)").v_model == "0, 3"
    shown.open(1)
    shown.write("Robot, 0 to 5", 3)
    assert shown.tables()[0].rows[0] == ["robot", "3 of S2, inter-learner"]
    shown.click("Skip learning")
    _wait(lambda: "Robot 3 is absent." in shown.texts())
    _wait(lambda: shown.arena().frame["robots"] == (1, 2, 4, 5))
    _wait(lambda: "Skip learning" not in shown.texts())
    shown.write("Absent robots", "")
    assert session.player.game.absent == ()
    _wait(lambda: "Absent robots" not in shown.texts())


def test_the_world_can_be_changed_by_sliders_and_in_words(show: Callable[[str], Shown]) -> None:
    shown = show("fig-6.1c")
    session = shown.session
    _unfold(shown, "World")
    shown.find(ipyvuetify.Slider, "Friction").v_model = 0.5
    shown.find(ipyvuetify.Slider, "Fight (s)").v_model = 2.0
    assert session.form.parameters == "fitted, fight_duration=2.0, friction=0.5"
    assert session.player.game.parameters.friction == 0.5
    shown.find(ipyvuetify.Select, "Layout").v_model = "nearer-station"
    shown.write("Length of the game", 20.0)
    shown.write("Ends with this puck", 3)
    shown.write("Pucks at a station", 9)
    game = session.player.game
    assert (game.layout, game.duration, game.puck_limit, game.supply) == ("nearer-station", 20.0, 3, 9)
    shown.write("Parameters", "fited")
    assert "parameters='fited': must begin with one of fitted, argos" in shown.texts()
    assert session.player.game == game
    assert "Friction" not in shown.texts()
    shown.write("Parameters", "argos")
    shown.find(ipyvuetify.Select, "Body").v_model = "krembot"
    assert "must begin" not in shown.texts()
    assert session.player.game.body == "krembot"


def test_a_mistake_is_one_line_on_the_page(show: Callable[[str], Shown]) -> None:
    shown = show("fig-6.1c")
    shown.find(ipyvuetify.Combobox, "S2: policy").v_model = "atack"
    assert "policy='atack': must be one of avoid" in shown.texts()
    shown.find(ipyvuetify.Combobox, "S2: policy").v_model = "attack"
    assert "atack" not in shown.texts()
    shown.find(ipyvuetify.Combobox, "Scenario").v_model = None
    assert "id='': must be a scenario" in shown.texts()


def test_a_robot_can_be_chosen_and_looked_into(show: Callable[[str], Shown]) -> None:
    shown = show("fig-6.4b")
    session = shown.session
    session.player.advance(60.0)
    assert session.chosen == 10  # the first that learns
    shown.open(1)
    facts, sensors, bandit = shown.tables()
    assert facts.rows[0] == ["robot", "10 of S2, inter-learner"]
    assert len(sensors.rows[0]) == 8
    assert [row[0] for row in bandit.rows] == ["flight", "fight"]
    assert f"{UCB()!r}; learns" in shown.texts()
    shown.arena().vue_choose(0)
    assert (session.chosen, shown.arena().frame["chosen"]) == (0, 0)
    assert shown.tables()[0].rows[0] == ["robot", "0 of S1, attack"]
    assert "It does not learn." in shown.texts()
    shown.write("Robot, 0 to 19", 99)
    assert session.chosen == 19


def test_conflicts_are_listed_with_what_was_known(show: Callable[[str], Shown]) -> None:
    shown = show("fig-6.4b")
    shown.open(2)
    assert "No conflict has ended yet." in shown.texts()
    shown.session.player.advance(60.0)
    shown.click("Step")
    own = shown.tables()[0].rows
    assert {row[1].split(" →")[0] for row in own} == {"10 of S2"}
    assert any(row[3].startswith("flight ") for row in own)
    assert {row[4].split("\n")[0] for row in own} == {"flight", "fight"}
    shown.find(ipyvuetify.Checkbox, "Those of all robots").v_model = True
    assert len({row[1] for row in shown.tables()[0].rows}) > 1


def test_the_drawing_has_conflict_sectors_on_demand(show: Callable[[str], Shown]) -> None:
    shown = show("fig-6.1c")
    assert not shown.arena().frame["sectors"]
    _unfold(shown, "Drawing")
    shown.find(ipyvuetify.Checkbox, "Conflict sectors").v_model = True
    shown.find(ipyvuetify.Checkbox, "Sensors").v_model = False
    assert shown.arena().frame["sectors"]
    assert shown.arena().frame["sensors"] is None


def test_what_runs_is_shown_frame_by_frame_and_the_panels_less_often(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(page, "_GIVE_UP", 0.0)
    monkeypatch.setattr(page, "_PANELS_EVERY", 0.2)
    session, beats, over = Session("fig-6.1c"), page.Beats(), threading.Event()
    seen: list[float] = []
    panels: list[float] = []
    beats.frame.subscribe(lambda _: seen.append(session.player.time))
    beats.panels.subscribe(lambda _: panels.append(session.player.time))
    session.change(session.form._replace(duration=8.0))

    def begin() -> None:
        session.play()
        beats.wake.set()

    def end(number: int) -> None:
        over.set()
        beats.wake.set()

    beats.controls.subscribe(end)  # which beats when the game has ended
    threading.Timer(0.05, begin).start()
    page.let_run(session, beats, over)
    assert seen == sorted(seen)
    assert seen[-1] == 8.0
    assert 0 < len(panels) < len(seen)


# solara's server still imports it; the version that it asks for has it.
@pytest.mark.filterwarnings("ignore:websockets.legacy is deprecated:DeprecationWarning")
def test_a_page_is_served_where_it_is_said_to_be(monkeypatch: pytest.MonkeyPatch) -> None:
    import uvicorn
    from solara.server import settings

    from scenarios.explore import server

    told, opened = threading.Event(), threading.Event()
    lines: list[str] = []

    def run(own: uvicorn.Server, sockets: list[socket.socket]) -> None:
        own.started = True
        assert told.wait(10)
        assert opened.wait(10)
        (listener,) = sockets
        assert lines == [f"http://localhost:{listener.getsockname()[1]}"]

    def ready(address: str) -> None:
        lines.append(address)
        told.set()

    monkeypatch.setattr(uvicorn.Server, "run", run)
    monkeypatch.setattr(server.webbrowser, "open", lambda address: opened.set())
    server.serve("fig-6.2", 0, True, ready)
    assert page.start == "fig-6.2"
    assert not settings.telemetry.mixpanel_enable
    with (
        socket.create_server(("127.0.0.1", 0)) as taken,
        pytest.raises(InputError, match="must be a free port"),
    ):
        server.serve("fig-6.2", taken.getsockname()[1], False, ready)


def test_a_page_that_is_closed_ends_its_thread_and_frees_its_game(show: Callable[[str], Shown]) -> None:
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


def _unfold(shown: Shown, heading: str) -> None:
    """Open a part of the controls that is folded."""
    panels = [w for w in shown.widgets() if isinstance(w, ipyvuetify.ExpansionPanels)]
    for panel in panels:
        panel.v_model = 0
    assert heading in shown.texts()
