"""The page of `kswarms explore`, rendered without a browser, with functions that use its widgets.

It needs the extra `explore`; tests that import it are skipped without solara.
"""

import time
from collections.abc import Callable, Iterator
from typing import Any

import ipyvuetify
import pytest
import solara

from kswarms.scenarios.explore import page
from kswarms.scenarios.explore.session import Session
from kswarms.scenarios.runs.run import Run


@solara.component
def _App() -> None:  # noqa: N802  # a component
    page.Layout(children=[page.Page()])


class RenderedPage:
    """A rendered page. Its methods find and use widgets."""

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
        """Return all text on the page, except the text in Vue components."""
        return " | ".join(filter(None, map(self.text_of, self.widgets())))

    def find(self, kind: type[Any], text: str) -> Any:
        """Return the first widget of a kind whose text starts with `text`."""
        return next(w for w in self.widgets() if isinstance(w, kind) and self.text_of(w).startswith(text))

    def click(self, text: str) -> None:
        self.find(ipyvuetify.Btn, text).fire_event("click", {})

    def write(self, text: str, value: object) -> None:
        """Write into a field and leave it."""
        field = self.find(ipyvuetify.TextField, text)
        field.v_model = str(value)
        if field._event_handlers_map:  # other fields report every letter
            field.fire_event("focusout", {})

    def open(self, tab: int) -> None:
        next(w for w in self.widgets() if isinstance(w, ipyvuetify.Tabs)).v_model = tab

    def tables(self) -> list[Any]:
        return [widget for widget in self.widgets() if hasattr(widget, "rows")]

    def arena(self) -> Any:
        return next(widget for widget in self.widgets() if hasattr(widget, "scene"))


def render_pages(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[str | Run], RenderedPage]]:
    """Yield a function that renders a page; close all pages afterwards."""
    shown: list[RenderedPage] = []
    monkeypatch.setattr(page, "_DRAW_TIMEOUT", 0.02)  # no browser draws

    def render(start: str | Run) -> RenderedPage:
        session = Session(start)
        monkeypatch.setattr(page, "new_session", lambda: session)
        shown.append(RenderedPage(session))
        return shown[-1]

    yield render
    for each in shown:
        each.context.close()


def wait(condition: Callable[[], bool]) -> None:
    """Wait until a condition holds; fail after 10 s."""
    deadline = time.monotonic() + 10.0
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.01)


def unfold(shown: RenderedPage, heading: str) -> None:
    """Expand the folded parts of the controls, and check that a heading is visible."""
    panels = [w for w in shown.widgets() if isinstance(w, ipyvuetify.ExpansionPanels)]
    for panel in panels:
        panel.v_model = 0
    assert heading in shown.texts()
