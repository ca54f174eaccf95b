"""The page: the arena with its buttons, the controls at the side, the panels.

Each page has a thread that plays its game. It waits until the browser has drawn a frame before it sends the
next, so a slow browser shows fewer frames and does not fall behind.
"""

import threading
import time
from collections.abc import Callable
from functools import partial
from itertools import count
from typing import Any, Final

import solara

from kswarms.scenarios.catalogue.selection import DEFAULT_SCENARIO
from kswarms.scenarios.explore.controls import Controls
from kswarms.scenarios.explore.panels import Panels
from kswarms.scenarios.explore.playback import SPEEDS
from kswarms.scenarios.explore.session import Act, Session
from kswarms.scenarios.explore.views import Json, frame_of, scene_of

FRAME_INTERVAL: Final = 1 / 25
"""Minimum time between two frames (s)."""
_PANELS_EVERY: Final = 0.5
"""Time between two updates of the panels while the game runs (s)."""
_DRAW_TIMEOUT: Final = 1.0
"""Maximum time to wait for the browser; a hidden tab draws nothing (s)."""

_STYLE: Final = """
.kswarms-page { margin: 0; }
.kswarms-heading { font-weight: 600; display: block; margin-top: 10px; }
.kswarms-swarm { padding: 4px 0 4px 10px; margin: 4px 0; }
.kswarms-message { position: sticky; top: 0; z-index: 3; background: #fff; border-radius: 4px; }
.v-navigation-drawer .kswarms-message { display: none; }
@media (max-width: 959px) {
  .v-navigation-drawer { min-width: min(400px, 100vw) !important; }
  .v-navigation-drawer .kswarms-message { display: block; }
}
"""

new_session: Callable[[], Session] = partial(Session, DEFAULT_SCENARIO)
"""Makes the session of a new page; set by the server."""


class Signals:
    """Signals that update parts of the page."""

    def __init__(self) -> None:
        # A unique number for each signal: two threads that increment a value could set the same number.
        self._numbers = count(1)
        self.frame = solara.Reactive(0)
        self.panels = solara.Reactive(0)
        self.controls = solara.Reactive(0)
        self.drawn = threading.Event()
        self.wake = threading.Event()

    def send(self, *parts: solara.Reactive[int]) -> None:
        """Update some parts of the page."""
        for part in parts:
            part.value = next(self._numbers)

    def send_all(self) -> None:
        """Update the whole page."""
        self.send(self.frame, self.panels, self.controls)
        self.wake.set()


@solara.component_vue("vue/arena.vue")
def _Arena(
    scene: Json, frame: Json, event_drawn: Callable[[int], None], event_select: Callable[[int], None]
) -> None:
    """Draw the arena on a canvas."""


@solara.component
def Page() -> None:
    """Show a game and its controls."""
    session = solara.use_memo(lambda: new_session(), [])
    signals = solara.use_memo(Signals, [])
    solara.use_effect(lambda: _run(session, signals), [])

    def act(action: Callable[[], None]) -> None:
        action()
        signals.send_all()

    solara.Title("kswarms explore")
    solara.Style(_STYLE)
    with solara.Sidebar():
        _Message(session, signals.controls)  # in a narrow window, where the controls cover the other one
        Controls(session, signals.controls, act)
    with solara.v.Row(class_="kswarms-page"):
        with solara.v.Col(cols=12, md=7):
            _Message(session, signals.controls)
            _ArenaView(session, signals, act)
            _Transport(session, signals.controls, act)
        with solara.v.Col(cols=12, md=5):
            Panels(session, signals.panels, act)


@solara.component
def Layout(children: list[Any]) -> None:
    """Show the controls beside the page, or behind a button on narrow screens; solara requires the name."""
    # None lets the browser decide; solara's default, True, would hide the arena in a narrow window.
    solara.AppLayout(children=children, sidebar_open=None)


def _run(session: Session, signals: Signals) -> Callable[[], None]:
    """Start the thread that plays the game; return a function that ends it."""
    stop = threading.Event()
    thread = threading.Thread(target=play_session, args=(session, signals, stop), daemon=True)
    thread.start()

    def end() -> None:
        stop.set()
        signals.wake.set()
        signals.drawn.set()
        thread.join()
        session.close()

    return end


def play_session(session: Session, signals: Signals, stop: threading.Event) -> None:
    """Play the game and update the page until `stop` is set."""
    last = panels_sent = time.monotonic()
    while not stop.is_set():
        if not session.active:
            signals.wake.wait()
            signals.wake.clear()
            last = time.monotonic()
            continue
        now = time.monotonic()
        # The limit prevents a jump of the game after the machine was suspended.
        moved = session.tick(min(now - last, 0.25))
        last = now
        if moved:
            signals.drawn.clear()
            signals.send(signals.frame)
            if not session.active:
                signals.send_all()
            elif now - panels_sent >= _PANELS_EVERY:
                panels_sent = now
                signals.send(signals.panels)
            signals.drawn.wait(_DRAW_TIMEOUT)
        time.sleep(max(0.0, FRAME_INTERVAL - (time.monotonic() - now)))


@solara.component
def _ArenaView(session: Session, signals: Signals, act: Act) -> None:
    number = signals.frame.value
    player = session.player
    scene = solara.use_memo(lambda: scene_of(player), [player])
    _Arena(
        scene=scene,
        frame=frame_of(player, number, session.selected, session.show_sectors, session.show_sensors),
        event_drawn=lambda _: signals.drawn.set(),
        event_select=lambda robot: act(lambda: session.select(robot)),
    )


@solara.component
def _Message(session: Session, signal: solara.Reactive[int]) -> None:
    signal.get()
    if session.error:
        with solara.v.Html(tag="div", class_="kswarms-message"):
            solara.Error(session.error, icon=False, dense=True)


@solara.component
def _Transport(session: Session, signal: solara.Reactive[int], act: Act) -> None:
    """Show the buttons below the arena."""
    signal.get()
    player = session.player
    runs = session.playing and not player.ended

    def button(label: str, icon: str, action: Callable[[], None], **rest: Any) -> None:
        solara.Button(label, icon_name=icon, on_click=lambda: act(action), small=True, **rest)

    def set_speed(speed: int) -> None:
        act(lambda: setattr(session, "speed", speed))

    with solara.Row(gap="6px", style={"flex-wrap": "wrap", "align-items": "center", "row-gap": "6px"}):
        button(
            "Pause" if runs else "Play", "mdi-pause" if runs else "mdi-play", session.toggle, color="primary"
        )
        button("Step", "mdi-step-forward", session.step)
        button("Reset", "mdi-skip-backward", session.reset)
        button("Next conflict", "mdi-target", lambda: session.next_conflict(session.selected))
        if player.time < 0:
            button("Skip learning", "mdi-fast-forward", lambda: session.go_to(0.0), color="secondary")
        button("To the end", "mdi-skip-forward", lambda: session.go_to(player.game.duration))
    with solara.Row(gap="16px", style={"flex-wrap": "wrap", "padding-top": "6px"}):
        with solara.Div(style={"width": "9rem"}):
            speeds = list(SPEEDS)
            solara.Select("Speed (× real time)", value=session.speed, values=speeds, on_value=set_speed)
        with solara.Div(style={"width": "9rem"}):
            solara.InputFloat(
                "Go to t (s)", round(player.time, 1), on_value=lambda time: act(lambda: session.go_to(time))
            )
