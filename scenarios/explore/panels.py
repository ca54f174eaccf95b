"""Panels beside the arena: charts, the selected robot, conflicts."""

import math
from collections.abc import Sequence
from typing import Final

import solara

from kswarms.scenarios.explore.session import Act, Session
from kswarms.scenarios.explore.views import Json, charts_of
from kswarms.scenarios.watch.conflicts import HEADINGS, Arm, WatchedConflict, conflict_cells, format_number
from kswarms.scenarios.watch.robot_view import RobotView

_CONFLICTS_SHOWN: Final = 60
_CONFLICT_HEADINGS: Final = (
    "t (s)", "who →\nmet", "where\n(m)", "known:\nQ (N)", "chose\nR (s)",
    "Q\nafter", "T(a)\n(s)", "T(p)\n(s)", "n′", "saw",
)  # fmt: skip


@solara.component_vue("vue/table.vue")
def _Table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Show a table of texts; cells that start with a star are bold."""


@solara.component_vue("vue/chart.vue")
def _Chart(option: Json) -> None:
    """Draw a chart of ECharts."""


@solara.component
def Panels(session: Session, signal: solara.Reactive[int], act: Act) -> None:
    """Show the panels as tabs."""
    tab = solara.use_reactive(0)
    with solara.v.Tabs(v_model=tab.value, on_v_model=tab.set, grow=True):
        for name in ("Curves", "Robot", "Conflicts"):
            solara.v.Tab(children=[name])
    if tab.value == 0:
        _Curves(session, signal)
    elif tab.value == 1:
        _Robot(session, signal, act)
    else:
        _Conflicts(session, signal, act)


@solara.component
def _Curves(session: Session, signal: solara.Reactive[int]) -> None:
    signal.get()
    for heading, option in charts_of(session.player.history).items():
        solara.Text(heading, classes=["kswarms-heading"])
        _Chart(option=option)


def _robot_input(session: Session, act: Act) -> None:
    solara.InputInt(
        f"Robot, 0 to {session.player.game.size - 1} (or click on one)",
        session.selected,
        on_value=lambda robot: act(lambda: session.select(robot)),
        continuous_update=True,
    )


@solara.component
def _Robot(session: Session, signal: solara.Reactive[int], act: Act) -> None:
    signal.get()
    _robot_input(session, act)
    view = session.player.view_robot(session.selected)
    if view is None:
        solara.Text(f"Robot {session.selected} is absent.")
        return
    _Table(header=["", ""], rows=_facts(view))
    solara.Text("Sensors: free distance (m), active ones bold", classes=["kswarms-heading"])
    _Table(
        header=[f"{round(math.degrees(sensor.angle))}°" for sensor in view.sensors],
        rows=[[f"{'*' if sensor.active else ''}{sensor.free:z.2f}" for sensor in view.sensors]],
    )
    for opponent, arms in view.bandits.items():
        swarm = "its own swarm" if opponent == view.swarm else f"S{opponent}"
        solara.Text(f"Bandit against {swarm}", classes=["kswarms-heading"])
        _Table(
            header=["action", "N(a)", "Q(a) = ΣR/ΣT", "√(γ ln N/N(a))", "bound"],
            rows=[_arm_row(arm) for arm in arms],
        )
    if view.bandits:
        phase = "learns" if view.learning else "has learned: takes the action with the greatest Q"
        solara.Text(f"{view.rule}; {phase}")
    else:
        solara.Text("It does not learn.")


def _facts(view: RobotView) -> list[list[str]]:
    swarms = range(1, len(view.t_a) + 1)
    return [
        ["robot", f"{view.robot} of S{view.swarm}, {view.policy}"],
        ["activity", f"{view.doing}{', with a puck' if view.carrying else ''}"],
        ["met last", view.opponent or "nobody"],
        ["pucks", str(view.pucks)],
        ["T(a) against", ", ".join(f"S{m}: {t:.1f} s" for m, t in zip(swarms, view.t_a, strict=True))],
        ["T(p)", f"{view.t_p:.1f} s"],
        ["conflicts", ", ".join(f"S{m}: {n}" for m, n in zip(swarms, view.conflicts, strict=True))],
    ]


def _arm_row(arm: Arm) -> list[str]:
    return [arm.action, f"{arm.n:g}", *map(format_number, (arm.q, arm.bound - arm.q, arm.bound))]


@solara.component
def _Conflicts(session: Session, signal: solara.Reactive[int], act: Act) -> None:
    signal.get()
    of_all = solara.use_reactive(False)
    _robot_input(session, act)
    solara.Checkbox(label="Conflicts of all robots", value=of_all)
    player = session.player
    conflicts = player.latest_conflicts(None if of_all.value else session.selected, _CONFLICTS_SHOWN)
    if not conflicts:
        solara.Text("No conflict has ended yet.")
        return
    _Table(header=_CONFLICT_HEADINGS, rows=[_conflict_row(each, player.begin) for each in conflicts])


def _conflict_row(conflict: WatchedConflict, begin: float) -> list[str]:
    """Return the cells of `conflict_cells` in short lines, so that the table fits beside the arena."""
    cell = dict(zip(HEADINGS, conflict_cells(conflict, begin), strict=True))
    return [
        cell["t (s)"],
        f"{cell['who']} →\n{cell['met']}",
        cell["where (m)"].replace(", ", "\n"),
        cell["known: Q (N)"].replace(", ", "\n"),
        f"{cell['chose']}\n{cell['R']}",
        *(cell[name] for name in ("Q after", "T(a)", "T(p)", "n′")),
        cell["saw"].replace(", ", "\n"),
    ]
