"""Figures of scenarios over the number of robots, from the rows of `runs.parquet` and `policies.parquet`.

Figures are `matplotlib.figure.Figure` objects; no window opens, and global settings do not change.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from kswarms.agents.common.errors import InputError, require_type
from kswarms.agents.common.quoting import for_file_name
from kswarms.analysis.figures.files import save_figure
from kswarms.analysis.figures.style import (
    LineStyle,
    condition_style,
    draw_curves,
    draw_line,
    heading,
    legend_below,
    new_figure,
    scale_from_zero,
    seeds_legend_title,
)
from kswarms.analysis.measures.learned import named_curves
from kswarms.analysis.measures.quantities import (
    TIME_SHARES,
    add_time_shares,
    scenario_rows,
    shown_quantities,
    split_curves,
)
from kswarms.analysis.results.runs import Results, read_results
from kswarms.analysis.results.sweeps import Sweep


def pucks_over_n(runs: pd.DataFrame, scenario: str, title: str = "", detail: bool = True) -> Figure:
    """Draw the pucks deposited in the measured game over the number of robots, for each swarm.

    Parameters
    ----------
    runs : pandas.DataFrame
        Rows of `runs.parquet`.
    scenario : str
        Id of the scenario.
    title : str
        Title of the scenario; the heading is its id and this title.
    detail : bool
        Whether intervals and single seeds are drawn; the source shows means only.

    Returns
    -------
    matplotlib.figure.Figure
        A curve for each condition and swarm.

    Raises
    ------
    InputError
        `runs` has no row of the scenario.
    """
    rows = scenario_rows(runs, scenario)
    with new_figure(heading(scenario, title)) as figure:
        axes = figure.subplots()
        draw_curves(axes, split_curves(rows), "pucks", detail)
        axes.set_ylabel("pucks deposited by the swarm")
        scale_from_zero(axes, rows["pucks"])
        legend_below(figure, seeds_legend_title(rows, detail))
    return figure


def time_shares(runs: pd.DataFrame, scenario: str, title: str = "", detail: bool = True) -> Figure:
    """Draw the share of time in conflict, T(a) / (T(a) + T(p)), over the number of robots (Fig. 6.3).

    Three panels show all conflicts, conflicts with other swarms, and conflicts within the swarm. Parameters
    and errors are those of `pucks_over_n`.
    """
    rows = add_time_shares(scenario_rows(runs, scenario))
    with new_figure(heading(scenario, title), width=11.0) as figure:
        panels: Sequence[Axes] = figure.subplots(1, len(TIME_SHARES), sharey=True)
        for axes, kind in zip(panels, TIME_SHARES, strict=True):
            draw_curves(axes, split_curves(rows), kind, detail)
            axes.set_title(kind)
            axes.set_ylabel("share of time, T(a) / (T(a) + T(p))")
            axes.label_outer()
        scale_from_zero(panels[0], rows["total"])
        legend_below(figure, seeds_legend_title(rows, detail))
    return figure


def sud_over_n(
    runs: pd.DataFrame, scenario: str, title: str = "", detail: bool = True, swarm: int = 2
) -> Figure:
    """Draw the Swarm Utility Difference (Eq. 3.7) of one swarm over the number of robots.

    Parameters and errors are those of `pucks_over_n`. `swarm` is 1 to K; the source shows S2.
    """
    rows = scenario_rows(runs, scenario)
    swarms = sorted(set(rows["swarm"]))
    if swarm not in swarms:
        raise InputError("swarm", swarm, f"must be one of {', '.join(map(str, swarms))} in {scenario}")
    rows = rows[rows["swarm"] == swarm]
    with new_figure(heading(scenario, title)) as figure:
        axes = figure.subplots()
        axes.axhline(0, color="0.4", linewidth=1)
        draw_curves(axes, split_curves(rows), "sud", detail)
        axes.set_ylabel(f"SUD of S{swarm} (pucks)")
        legend_below(figure, seeds_legend_title(rows, detail))
    return figure


def learned_over_n(cells: pd.DataFrame, title: str = "", conditions: Sequence[str] = ()) -> Figure:
    """Draw the share of robots that learned an action over the number of robots.

    Parameters
    ----------
    cells : pandas.DataFrame
        Result of `kswarms.analysis.measures.learned.learned_shares`.
    title : str
        Heading.
    conditions : sequence of str
        Order of the conditions in another figure of the scenario, to draw both with the same colours.

    Returns
    -------
    matplotlib.figure.Figure
        A curve with its 95 % interval for each scenario, condition, learning swarm and opponent. Crosses of
        the same colour on a dotted line are published numbers.
    """
    with new_figure(title) as figure:
        axes = figure.subplots()
        several_opponents = cells.groupby("condition")["opponent"].nunique().max() > 1
        for index, (name, curve) in enumerate(named_curves(cells)):
            style = condition_style(index)
            if len(conditions) > 1:
                condition, opponent = curve["condition"].iloc[0], curve["opponent"].iloc[0]
                style = condition_style(conditions.index(condition), opponent if several_opponents else None)
            axes.fill_between(curve["n"], curve["low"], curve["high"], color=style.colour, alpha=0.2, lw=0)
            draw_line(axes, curve["n"], curve["measured"], style, name)
            if curve["published"].notna().any():
                published = LineStyle(style.colour, ":", "x")
                draw_line(axes, curve["n"], curve["published"], published, f"{name}, published")
        learned = set(cells["learned"])
        phrases = {("attack",): "to attack", ("flight within",): "flight within"}
        action = phrases.get(tuple(learned), "the action")
        axes.set(xlabel="number of robots in all, N", ylabel=f"robots that learned {action} (%)")
        axes.set(xticks=sorted(set(cells["n"])), ylim=(-3, 103))
        legend_below(figure, "learned action; band: 95 % interval of the measured share")
    return figure


def figure_of(runs: pd.DataFrame, scenario: str, title: str = "", detail: bool = True) -> Figure:
    """Draw the quantity that the source shows for a scenario: pucks, SUD of S2 or shares of time.

    Parameters and errors are those of `pucks_over_n`.
    """
    require_type("scenario", scenario, str, "must be the id of a scenario")
    if not scenario.isprintable():
        raise InputError("scenario", scenario, "must be the id of a scenario")
    require_type("title", title, str, "must be a text")
    draw = {("sud",): sud_over_n, TIME_SHARES: time_shares}.get(shown_quantities(scenario), pucks_over_n)
    return draw(runs, scenario, title, detail)


def write_figures(
    source: str | Path | Sweep | Results,
    out: str | Path,
    scenarios: Sequence[str] | None = None,
    titles: Mapping[str, str] | None = None,
) -> list[Path]:
    """Write the figure of each scenario of the results as `<id>.png`, see `for_file_name`.

    Parameters
    ----------
    source : Results, or a source for `read_results`
        Results directory of `kswarms run --out`, or outcomes of a sweep.
    out : Path
        Folder of the figures; it is created if it does not exist.
    scenarios : sequence of str, optional
        Ids of the scenarios to draw, by default all; scenarios without runs are skipped.
    titles : mapping of str to str, optional
        Titles of scenarios by id.

    Returns
    -------
    list of Path
        The figures, in the order of `scenarios`.

    Raises
    ------
    InputError
        The runs cannot be read, or a figure cannot be written; then an existing figure is unchanged.
    """
    runs = (source if isinstance(source, Results) else read_results(source)).runs
    present = dict.fromkeys(runs["scenario"])
    paths = []
    for scenario in present if scenarios is None else scenarios:
        if scenario in present:
            paths.append(Path(out) / f"{for_file_name(scenario)}.png")
            save_figure(figure_of(runs, scenario, (titles or {}).get(scenario, "")), paths[-1])
    return paths
