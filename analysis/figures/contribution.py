"""What robots contributed, for people: the scatter of contribution over reward, and tables to print."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from kswarms.analysis.figures.files import save
from kswarms.analysis.figures.style import LineStyle, brief, heading, legend_below, sheet, swarm_style
from kswarms.analysis.measures.contribution import (
    MEASURES,
    QUANTITIES,
    assumption,
    means,
    measures_of,
    of_question,
    rank_correlations,
    read,
)
from kswarms.analysis.text_tables import with_interval


def scatter(rows: pd.DataFrame, title: str = "") -> Figure:
    """Draw the true contribution of each robot over the reward that it computed.

    Parameters
    ----------
    rows : pandas.DataFrame
        As `of_question` returns them.
    title : str
        What the scenario is, printed after its id.

    Returns
    -------
    matplotlib.figure.Figure
        A panel for each of `MEASURES`: each robot's means with their intervals, single games as light points.
    """
    first, seeds, measures = rows.iloc[0], rows["seed"].nunique(), measures_of(rows)
    absent = "from learning and game" if first["absent_from"] == "learning" else "from the measured game"
    name = heading(first["scenario"], title)
    above = [name, first["condition"], f"N = {first['n']}", f"robots absent {absent}"]
    robots, correlations = means(rows), rank_correlations(rows)
    with sheet(", ".join(filter(None, above)), 5.5 * len(measures) + 1, 5.5) as figure:
        panels = figure.subplots(1, len(measures), squeeze=False)[0]
        for axes, measure in zip(panels, measures, strict=True):
            axes.axhline(0, color="0.4", linewidth=1)
            for swarm in sorted(set(rows["swarm"])):
                style = swarm_style(swarm)
                of_swarm = robots[(robots["swarm"] == swarm) & (robots["robot"] >= 0)]
                _draw_swarm(axes, rows[rows["swarm"] == swarm], of_swarm, measure, style)
            axes.set_title(_title(correlations[correlations["measure"] == measure]), fontsize="small")
            axes.set_xlabel("reward that the robot computes in a game (s)")
            axes.set_ylabel(f"change of its swarm's SUD by the robot ({MEASURES[measure]})")
        note = f"means of {seeds} seeds, bars: their 95 % intervals, points: single games"
        legend_below(figure, note if seeds > 1 else "one seed")
    return figure


def _draw_swarm(
    axes: Axes, games: pd.DataFrame, robots: pd.DataFrame, measure: str, style: LineStyle
) -> None:
    if games["seed"].nunique() > 1:
        axes.scatter(games["reward"], games[measure], s=7, color=style.colour, alpha=0.25, linewidths=0)
    axes.errorbar(
        robots["reward"],
        robots[measure],
        xerr=_reach(robots, "reward"),
        yerr=_reach(robots, measure),
        label=f"S{robots['swarm'].iloc[0]}: {', '.join(dict.fromkeys(map(brief, games['policy'])))}",
        color=style.colour,
        linestyle="none",
        marker=style.marker,
        markerfacecolor=style.colour if style.filled else "white",
        elinewidth=0.8,
    )


def _reach(table: pd.DataFrame, quantity: str) -> pd.Series:
    return table[f"{quantity}_high"] - table[quantity]


def _title(correlations: pd.DataFrame) -> str:
    lines = []
    for found in correlations.to_dict("records"):
        robots, games = (_told(found, name) for name in ("robots", "games"))
        lines.append(f"S{found['swarm']}: rank correlation of robots {robots}, in a game {games}")
    return "\n".join(lines)


def _told(found: Mapping[Any, Any], name: str, form: str = ".2f") -> str:
    """Return a number with its interval, from columns like those of `means`."""
    return with_interval(found[name], found[f"{name}_low"], found[f"{name}_high"], form)


def draw(directory: Path, title: str = "", **question: object) -> Path:
    """Write `figures/contribution-<id>.png` in a results directory.

    Parameters
    ----------
    directory : Path
        A directory that holds `contribution.parquet`.
    title : str
        As for `scatter`.
    **question
        As for `of_question`.

    Raises
    ------
    InputError
        If the table cannot be read, or the figure cannot be written; then it is as it was.
    """
    rows = of_question(read(directory), **question)
    path = directory / "figures" / f"contribution-{rows['scenario'].iloc[0]}.png"
    save(scatter(rows, title), path)
    return path


def printed(rows: pd.DataFrame) -> list[tuple[str, list[list[str]]]]:
    """Put what was found into tables for people.

    Parameters
    ----------
    rows : pandas.DataFrame
        As `of_question` returns them.

    Returns
    -------
    list of (str, list of list of str)
        For each table what it is, and its lines of cells, the header first.
    """
    seeds = rows["seed"].nunique()
    by_robot = [["robot", "swarm", "SUD (pucks)", "SUD (s)", "reward (s)", "reward per second"]]
    for found in means(rows).to_dict("records"):
        robot = f"mean of S{found['swarm']}" if found["robot"] < 0 else str(found["robot"])
        forms = zip(QUANTITIES, (".2f", ".1f", ".1f", ".3f"), strict=True)
        by_robot.append([robot, f"S{found['swarm']}", *(_told(found, *each) for each in forms)])
    ranks = [["swarm", "contribution to SUD in", "of robots' means", "within a game"]]
    for found in rank_correlations(rows).to_dict("records"):
        cells = (_told(found, name) for name in ("robots", "games"))
        ranks.append([f"S{found['swarm']}", MEASURES[found["measure"]], *cells])
    became = [["robot of", "others", "T(a)", "without", "T(p)", "without", "T(a) against it", "share freed"]]
    for found in assumption(rows).to_dict("records"):
        times = (f"{found[name]:.1f}" for name in ("t_a", "t_a_without", "t_p", "t_p_without", "met"))
        became.append([f"S{found['swarm']}", found["others"], *times, _told(found, "share")])
    interval = "one seed" if seeds == 1 else f"mean of {seeds} seeds (95 % interval)"
    return [
        (f"contribution of each robot, and its own reward: {interval}", by_robot),
        ("rank correlation of reward and contribution (95 % interval)", ranks),
        ("seconds of the others in a game, with the robot and without it", became),
    ]
