"""The controls at the side of the page: what is played."""

import math
from collections.abc import Callable, Iterable
from typing import Any, Final

import solara

from kswarms.agents.body import BODIES
from kswarms.agents.common.errors import InputError
from kswarms.agents.learning.rewards import REWARDS
from kswarms.agents.learning.selection_rules import RULES
from kswarms.agents.policies.registry import ALIASES, POLICIES
from kswarms.analysis.colours import swarm_colour
from kswarms.model.description.fields import LAYOUTS
from kswarms.model.description.parameters import Parameters, parse_parameters
from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.explore.form import learning_of
from kswarms.scenarios.explore.session import Act, Session

MOST_ROBOTS: Final = 100
_SLIDERS: Final = {
    "friction": ("Friction μ", (0.0, 1.0, 0.02)),
    "conflict_distance": ("Conflict distance (m)", (0.02, 0.4, 0.01)),
    "flight_duration": ("Flight (s)", (0.1, 5.0, 0.1)),
    "fight_duration": ("Fight (s)", (0.1, 5.0, 0.1)),
    "base_range": ("Base seen from (m)", (0.1, 2.0, 0.02)),
    "leg_mean": ("Mean wander leg (s)", (0.5, 20.0, 0.5)),
    "push_share": ("Push share", (0.0, 1.0, 0.05)),
}
"""Parameters of the world that have a slider: label; least, greatest, step."""
_DRIVE: Final = (0.05, 1.0, 0.05)
_KNOWN_POLICIES: Final = [name for name in (*POLICIES, *ALIASES) if name != "learned"]


@solara.component
def Controls(session: Session, beat: solara.Reactive[int], act: Act) -> None:
    """Show all controls of a session."""
    beat.get()
    form = session.form

    def change(**changes: Any) -> None:
        # The form as it is then: the page may not have been drawn again since the last change.
        act(lambda: session.change(session.form._replace(**changes)))

    _scenario(session, act)
    step = session.step_of_n()
    solara.SliderInt(
        f"Robots N = {form.n}",
        form.n,
        min=step,
        max=max(step, MOST_ROBOTS // step * step),
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
    with solara.Row(gap="6px"):
        swarms = len(form.swarms)
        solara.Button(
            "Add a swarm",
            small=True,
            text=True,
            on_click=lambda: act(lambda: session.change_swarms(len(session.form.swarms) + 1)),
        )
        solara.Button(
            f"Remove S{swarms}",
            small=True,
            text=True,
            disabled=swarms == 1,
            on_click=lambda: act(lambda: session.change_swarms(len(session.form.swarms) - 1)),
        )
    _learning(session, act)
    with solara.Details("World"):
        _world(session, change, act)
    with solara.Details("Drawing"):
        for name, label in (
            ("show_sectors", "Conflict sectors of all"),
            ("show_sensors", "Sensors of the chosen"),
        ):
            solara.Checkbox(
                label=label,
                value=getattr(session, name),
                on_value=lambda on, name=name: act(lambda: setattr(session, name, on)),
            )


# No components of their own: such a one is drawn anew only where its arguments are others.


def _slider(
    label: str, value: float, scale: tuple[float, float, float], tell: Callable[[float], None]
) -> None:
    """Show a slider; a value between its steps stays as it is until it is moved."""
    # Vuetify reports the nearest value that it can show as if somebody had chosen it.
    least, greatest, step = scale
    nearest = min(max(least + round((value - least) / step) * step, least), greatest)
    solara.SliderFloat(
        label,
        value,
        min=least,
        max=greatest,
        step=step,
        on_value=lambda chosen: None if math.isclose(chosen, nearest, abs_tol=1e-9) else tell(chosen),
    )


def _scenario(session: Session, act: Act) -> None:
    solara.v.Combobox(
        label="Scenario, or a TOML file",
        v_model=session.source,
        items=list(CATALOGUE),
        on_v_model=lambda text: act(lambda: session.load(text or "")),
        hint=session.title,
        persistent_hint=True,
    )
    if len(session.curves) > 1:
        solara.Select(
            "Condition",
            value=session.curve,
            values=list(session.curves),
            on_value=lambda name: act(lambda: session.choose_curve(name)),
        )


def _swarm(session: Session, k: int, act: Act) -> None:
    swarm = session.form.swarms[k]

    def change(**changes: Any) -> None:
        act(lambda: session.change_swarm(k, **changes))

    border = f"border-left: 6px solid {swarm_colour(k + 1)}"
    with solara.v.Html(tag="div", class_="kswarms-swarm", style_=border):
        solara.v.Combobox(
            label=f"S{k + 1}: policy",
            v_model=swarm.policy,
            items=_KNOWN_POLICIES,
            on_v_model=lambda policy: change(policy=policy or ""),
            class_="kswarms-policy",
        )
        solara.InputInt("Share of the robots", swarm.share, on_value=lambda share: change(share=share))
        _slider(f"Drive in P {swarm.drive:g}", swarm.drive, _DRIVE, lambda drive: change(drive=drive))
        _slider(
            f"Drive in A {swarm.drive_action:g}",
            swarm.drive_action,
            _DRIVE,
            lambda drive: change(drive_action=drive),
        )


def _learning(session: Session, act: Act) -> None:
    form = session.form
    learning = learning_of([swarm.policy for swarm in form.swarms])
    if learning is None:
        return

    def change(part: str, name: str = "", **arguments: float) -> None:
        act(lambda: session.change_learning(part, name, **arguments))

    def choose(label: str, part: str, known: Iterable[str], name: str) -> None:
        names = list(dict.fromkeys([*known, name]))
        solara.Select(label, value=name, values=names, on_value=lambda name: change(part, name))

    with solara.Details("Learning", expand=True):
        choose("Reward", "reward", REWARDS, learning.reward)
        if learning.delta is not None:
            label = f"Δ = {learning.delta:g}"
            _slider(label, learning.delta, (0.0, 0.5, 0.005), lambda delta: change("reward", delta=delta))
        choose("Selection rule", "rule", RULES, learning.rule)
        if learning.gamma is not None:
            label = f"γ = {learning.gamma:g}"
            _slider(label, learning.gamma, (0.0, 1.0, 0.005), lambda gamma: change("rule", gamma=gamma))
        solara.InputFloat(
            "Time to learn (s)",
            form.learning,
            on_value=lambda seconds: act(lambda: session.change(session.form._replace(learning=seconds))),
        )


def _world(session: Session, change: Callable[..., None], act: Act) -> None:
    form = session.form
    parameters: Parameters | None
    try:
        parameters = parse_parameters(form.parameters)
    except InputError:
        parameters = None  # the message above the arena says what is wrong with them
    if parameters is not None:
        for name, (label, scale) in _SLIDERS.items():
            value = getattr(parameters, name)

            def tell(value: float, name: str = name) -> None:
                act(lambda: session.change_parameter(name, value))

            _slider(f"{label} {value:.4g}", value, scale, tell)
    solara.InputText("Parameters", form.parameters, on_value=lambda text: change(parameters=text))
    solara.Select(
        "Layout", value=form.layout, values=list(LAYOUTS), on_value=lambda name: change(layout=name)
    )
    solara.Select("Body", value=form.body, values=list(BODIES), on_value=lambda name: change(body=name))
    solara.InputFloat("Length of the game (s)", form.duration, on_value=lambda s: change(duration=s))
    solara.InputInt("Ends with this puck (0: none)", form.puck_limit, on_value=lambda n: change(puck_limit=n))
    solara.InputInt("Pucks at a station (0: no end)", form.supply, on_value=lambda n: change(supply=n))
