"""Controls of the page: the description of the game."""

import math
from collections.abc import Callable, Iterable
from functools import partial
from typing import Any, Final

import solara

from kswarms.agents.body import BODIES
from kswarms.agents.common.errors import InputError
from kswarms.agents.learning.rewards import REWARDS
from kswarms.agents.learning.selection_rules import RULES
from kswarms.agents.policies.registry import ALIASES, POLICIES
from kswarms.analysis.colours import swarm_colour
from kswarms.model.description.fields import LAYOUTS
from kswarms.model.description.presets import parse_parameters
from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.explore.form import learning_of
from kswarms.scenarios.explore.session import Act, Session

_SLIDER_ROBOTS: Final = 100
_SLIDERS: Final = {
    "friction": ("Friction μ", (0.0, 1.0, 0.02)),
    "conflict_distance": ("Conflict distance (m)", (0.02, 0.4, 0.01)),
    "flight_duration": ("Flight (s)", (0.1, 5.0, 0.1)),
    "fight_duration": ("Fight (s)", (0.1, 5.0, 0.1)),
    "base_range": ("Base visible from (m)", (0.1, 2.0, 0.02)),
    "leg_mean": ("Mean wander leg (s)", (0.5, 20.0, 0.5)),
    "push_share": ("Push share", (0.0, 1.0, 0.05)),
}
"""Parameters of the world with a slider: label; minimum, maximum, step."""
_DRIVE: Final = (0.05, 1.0, 0.05)
_POLICY_NAMES: Final = [name for name in (*POLICIES, *ALIASES) if name != "learned"]


@solara.component
def Controls(session: Session, signal: solara.Reactive[int], act: Act) -> None:
    """Show all controls."""
    signal.get()
    form = session.form

    def change(**changes: Any) -> None:
        act(lambda: session.change(**changes))

    _scenario(session, act)
    step = session.step_of_n()
    solara.SliderInt(
        f"Robots N = {form.n}",
        form.n,
        min=step,
        max=max(step, _SLIDER_ROBOTS // step * step),
        step=step,
        on_value=lambda n: change(n=n),
    )
    solara.InputInt("Seed", form.seed, on_value=lambda seed: change(seed=seed))
    if form.absent:
        solara.InputText(
            "Absent robots" + (" (they learn)" if form.absent_from == "game" else ""),
            ", ".join(map(str, form.absent)),
            on_value=lambda text: act(lambda: session.change_absent(text)),
        )
    for k in range(len(form.swarms)):
        _swarm(session, k, act)
    swarms = len(form.swarms)
    with solara.Row(gap="6px"):
        for label, more in (("Add a swarm", 1), (f"Remove S{swarms}", -1)):
            add = partial(act, partial(session.add_swarms, more))
            solara.Button(label, small=True, text=True, disabled=swarms + more == 0, on_click=add)
    _learning(session, change, act)
    with solara.Details("World"):
        _world(session, change, act)
    drawings = {
        "show_sectors": "Conflict sectors of all robots",
        "show_sensors": "Sensors of the selected robot",
    }
    with solara.Details("Drawing"):
        for name, label in drawings.items():
            solara.Checkbox(
                label=label,
                value=getattr(session, name),
                on_value=lambda on, name=name: act(lambda: setattr(session, name, on)),
            )


# Plain functions, not components: solara renders a component again only if its arguments change.


def _slider(
    label: str, value: float, scale: tuple[float, float, float], change: Callable[[float], None]
) -> None:
    """Show a slider; a value between two steps is kept until the slider is moved."""
    # Vuetify reports the nearest step as if the user had selected it.
    least, greatest, step = scale
    nearest = min(max(least + round((value - least) / step) * step, least), greatest)
    solara.SliderFloat(
        label,
        value,
        min=least,
        max=greatest,
        step=step,
        on_value=lambda new: None if math.isclose(new, nearest, abs_tol=1e-9) else change(new),
    )


def _scenario(session: Session, act: Act) -> None:
    solara.v.Combobox(
        label="Scenario, or a TOML file" if session.allow_code else "Scenario",
        v_model=session.source,
        items=list(CATALOGUE),
        on_v_model=lambda text: act(lambda: session.load(text or "")),
        hint=session.title,
        persistent_hint=True,
    )
    if len(session.conditions) > 1:
        solara.Select(
            "Condition",
            value=session.condition,
            values=list(session.conditions),
            on_value=lambda name: act(lambda: session.select_condition(name)),
        )


def _swarm(session: Session, k: int, act: Act) -> None:
    swarm = session.form.swarms[k]

    def change(**changes: Any) -> None:
        act(lambda: session.change_swarm(k, **changes))

    border = f"border-left: 6px solid {swarm_colour(k + 1)}"
    with solara.v.Html(tag="div", class_="kswarms-swarm", style_=border):
        solara.v.Combobox(
            label=f"S{k + 1}: policy",
            v_model=swarm["policy"],
            items=_POLICY_NAMES,
            on_v_model=lambda policy: change(policy=policy or ""),
            class_="kswarms-policy",
        )
        solara.InputInt("Share of the robots", swarm["share"], on_value=lambda share: change(share=share))
        p, a = swarm["drive"], swarm["drive_action"]
        _slider(f"Drive in P {p:g}", p, _DRIVE, lambda drive: change(drive=drive))
        _slider(f"Drive in A {a:g}", a, _DRIVE, lambda drive: change(drive_action=drive))


def _learning(session: Session, change: Callable[..., None], act: Act) -> None:
    form = session.form
    learning = learning_of([swarm["policy"] for swarm in form.swarms], form.fields["parameters"])
    if learning is None:
        return

    def change_learning(part: str, name: str = "", **arguments: float) -> None:
        act(lambda: session.change_learning(part, name, **arguments))

    def choose(label: str, part: str, known: Iterable[str], name: str) -> None:
        names = list(dict.fromkeys([*known, name]))
        solara.Select(label, value=name, values=names, on_value=lambda name: change_learning(part, name))

    with solara.Details("Learning", expand=True):
        choose("Reward", "reward", REWARDS, learning.reward)
        if (delta := learning.delta) is not None:
            scale = (0.0, 0.5, 0.005)
            _slider(f"Δ = {delta:g}", delta, scale, lambda new: change_learning("reward", delta=new))
        choose("Selection rule", "rule", RULES, learning.rule)
        if (gamma := learning.gamma) is not None:
            scale = (0.0, 1.0, 0.005)
            _slider(f"γ = {gamma:g}", gamma, scale, lambda new: change_learning("rule", gamma=new))
        seconds = session.form.fields["learning"]
        solara.InputFloat("Time to learn (s)", seconds, on_value=lambda new: change(learning=new))


def _world(session: Session, change: Callable[..., None], act: Act) -> None:
    fields = session.form.fields
    try:
        parameters = dict(parse_parameters(fields["parameters"]))
    except InputError:
        parameters = {}  # the message above the arena describes the error
    for name, (label, scale) in _SLIDERS.items():

        def change_parameter(new: float, name: str = name) -> None:
            act(lambda: session.change_parameter(name, new))

        if (value := parameters.get(name)) is not None:
            _slider(f"{label} {value:.4g}", value, scale, change_parameter)
    solara.InputText("Parameters", fields["parameters"], on_value=lambda text: change(parameters=text))
    layout = fields["layout"]
    solara.Select("Layout", value=layout, values=list(LAYOUTS), on_value=lambda name: change(layout=name))
    body = getattr(fields["body"], "name", fields["body"])
    bodies = list(dict.fromkeys([*BODIES, body]))
    solara.Select("Body", value=body, values=bodies, on_value=lambda name: change(body=name))
    for kind, name, label in (
        (solara.InputFloat, "side", "Side of the arena (m)"),
        (solara.InputFloat, "duration", "Length of the game (s)"),
        (solara.InputInt, "puck_limit", "Pucks that end the game (0: no limit)"),
        (solara.InputInt, "supply", "Pucks at each station (0: no limit)"),
    ):
        kind(label, fields[name] or 0, on_value=lambda value, name=name: change(**{name: value}))
