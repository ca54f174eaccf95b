"""The page: the arena and its buttons, the controls at the side, the panels beside it.

One thread of each page lets its game run. It waits for the browser to have drawn a frame before it makes the
next, so a slow browser sees fewer frames of the same game, never a growing delay.
"""

import threading
import time
from collections.abc import Callable
from itertools import count
from typing import Any, Final

import solara

from kswarms.scenarios.catalogue.selecting import FIRST_SCENARIO
from kswarms.scenarios.explore.controls import Controls
from kswarms.scenarios.explore.panels import Panels
from kswarms.scenarios.explore.session import SPEEDS, Act, Session
from kswarms.scenarios.explore.views import Json, frame_of, scene_of
from kswarms.scenarios.runs.run import Run

FASTEST: Final = 1 / 25
"""Between two frames, at least (s)."""
_PANELS_EVERY: Final = 0.5
"""Between two looks of the panels at a game that runs (s)."""
_GIVE_UP: Final = 1.0
"""For how long a browser is waited for: one that shows another tab draws nothing (s)."""

_STYLE: Final = """
.kswarms-page { margin: 0; }
.kswarms-heading { font-weight: 600; display: block; margin-top: 10px; }
.kswarms-swarm { padding: 4px 0 4px 10px; margin: 4px 0; }
"""

start: str | Run = FIRST_SCENARIO
"""What a new page begins with; the command line sets it."""


class Beats:
    """What tells the page that there is something new to show."""

    def __init__(self) -> None:
        # A number of its own for each beat: two threads that add to one could both arrive at the same.
        self._numbers = count(1)
        self.frame = solara.Reactive(0)
        self.panels = solara.Reactive(0)
        self.controls = solara.Reactive(0)
        self.drawn = threading.Event()
        self.wake = threading.Event()

    def beat(self, *parts: solara.Reactive[int]) -> None:
        """Have some parts of the page shown anew."""
        for part in parts:
            part.value = next(self._numbers)

    def changed(self) -> None:
        """Have all of it shown anew."""
        self.beat(self.frame, self.panels, self.controls)
        self.wake.set()


@solara.component_vue("arena.vue")
def _Arena(
    scene: Json, frame: Json, event_drawn: Callable[[int], None], event_choose: Callable[[int], None]
) -> None:
    """Draw the arena on a canvas of the browser."""


@solara.component
def Page() -> None:  # components are written like classes, as solara has it
    """Show a game and its controls."""
    session = solara.use_memo(lambda: Session(start), [])
    beats = solara.use_memo(Beats, [])
    solara.use_effect(lambda: _run(session, beats), [])

    def act(action: Callable[[], None]) -> None:
        action()
        beats.changed()

    solara.Title("kswarms explore")
    solara.Style(_STYLE)
    with solara.Sidebar():
        Controls(session, beats.controls, act)
    with solara.v.Row(class_="kswarms-page"):
        with solara.v.Col(cols=12, md=7):
            _Message(session, beats.controls)
            _ArenaView(session, beats, act)
            _Transport(session, beats.controls, act)
        with solara.v.Col(cols=12, md=5):
            Panels(session, beats.panels, act)


@solara.component
def Layout(children: list[Any]) -> None:
    """Show the controls beside the page, or on a button where there is no room; solara asks for the name."""
    # None leaves it to the browser; True, solara's default, would hide the arena of a narrow window.
    solara.AppLayout(children=children, sidebar_open=None)


def _run(session: Session, beats: Beats) -> Callable[[], None]:
    """Start the thread that lets the game run; return what ends it."""
    over = threading.Event()
    thread = threading.Thread(target=let_run, args=(session, beats, over), daemon=True)
    thread.start()

    def end() -> None:
        over.set()
        beats.wake.set()
        beats.drawn.set()
        thread.join()
        session.close()

    return end


def let_run(session: Session, beats: Beats, over: threading.Event) -> None:
    """Let a game run, and have it shown, until it is over with the page."""
    last = shown = time.monotonic()
    while not over.is_set():
        if not session.active:
            beats.wake.wait()
            beats.wake.clear()
            last = time.monotonic()
            continue
        now = time.monotonic()
        # A pause of the machine does not make the game jump.
        moved = session.tick(min(now - last, 0.25))
        last = now
        if moved:
            beats.drawn.clear()
            beats.beat(beats.frame)
            if not session.active:
                beats.changed()
            elif now - shown >= _PANELS_EVERY:
                shown = now
                beats.beat(beats.panels)
            beats.drawn.wait(_GIVE_UP)
        time.sleep(max(0.0, FASTEST - (time.monotonic() - now)))


@solara.component
def _ArenaView(session: Session, beats: Beats, act: Act) -> None:
    number = beats.frame.value
    player = session.player
    scene = solara.use_memo(lambda: scene_of(player), [player])
    _Arena(
        scene=scene,
        frame=frame_of(player, number, session.chosen, session.show_sectors, session.show_sensors),
        event_drawn=lambda _: beats.drawn.set(),
        event_choose=lambda robot: act(lambda: session.choose(robot)),
    )


@solara.component
def _Message(session: Session, beat: solara.Reactive[int]) -> None:
    beat.get()
    if session.error:
        solara.Error(session.error, icon=False, dense=True)


@solara.component
def _Transport(session: Session, beat: solara.Reactive[int], act: Act) -> None:
    """Show the buttons below the arena."""
    beat.get()
    player = session.player
    runs = session.playing and not player.ended

    def button(label: str, icon: str, action: Callable[[], None], **rest: Any) -> None:
        solara.Button(label, icon_name=icon, on_click=lambda: act(action), small=True, **rest)

    with solara.Row(gap="6px", style={"flex-wrap": "wrap", "align-items": "center", "row-gap": "6px"}):
        button(
            "Pause" if runs else "Play", "mdi-pause" if runs else "mdi-play", session.play, color="primary"
        )
        button("Step", "mdi-step-forward", session.step)
        button("Reset", "mdi-skip-backward", session.reset)
        button("Next conflict", "mdi-target", session.next_conflict)
        if player.time < 0:
            button("Skip learning", "mdi-fast-forward", lambda: session.go_to(0.0), color="secondary")
        button("To the end", "mdi-skip-forward", lambda: session.go_to(player.game.duration))
    with solara.Row(gap="16px", style={"flex-wrap": "wrap", "padding-top": "6px"}):
        with solara.Div(style={"width": "9rem"}):
            solara.Select(
                "Speed (× real time)",
                value=session.speed,
                values=list(SPEEDS),
                on_value=lambda speed: act(lambda: setattr(session, "speed", speed)),
            )
        with solara.Div(style={"width": "9rem"}):
            solara.InputFloat(
                "Go to t (s)",
                round(player.time, 1),
                on_value=lambda time: act(lambda: session.go_to(time)),
            )
