"""Scatter charts of the true contribution of robots over the reward that they computed."""

from pathlib import Path

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from kswarms.analysis.figures.files import save
from kswarms.analysis.figures.style import LineStyle, heading, legend_below, new_figure, swarm_style
from kswarms.analysis.measures.contribution import (
    MEASURES,
    mean_contributions,
    measures_of,
    of_question,
    rank_correlations,
)
from kswarms.analysis.measures.quantities import short_policy
from kswarms.analysis.results.records import read_contributions
from kswarms.analysis.statistics.intervals import fewest_seeds
from kswarms.analysis.tables.contribution import estimate_text


def contribution_figure(rows: pd.DataFrame, title: str = "") -> Figure:
    """Draw the true contribution of each robot over the reward that it computed.

    `rows` come from `of_question`. A panel for each of `MEASURES` shows the mean and interval of each robot;
    light points are single games.
    """
    first, seeds, measures = rows.iloc[0], rows["seed"].nunique(), measures_of(rows)
    absent = "from learning and game" if first["absent_from"] == "learning" else "from the measured game"
    condition = f"{first['condition']}, " if first["condition"] else ""
    name = f"{heading(first['scenario'], title)}, {condition}N = {first['n']}, robots absent {absent}"
    robots, correlations = mean_contributions(rows), rank_correlations(rows)
    with new_figure(name, 5.5 * len(measures) + 1, 5.5) as figure:
        panels = figure.subplots(1, len(measures), squeeze=False)[0]
        for axes, measure in zip(panels, measures, strict=True):
            axes.axhline(0, color="0.4", linewidth=1)
            for swarm in sorted(set(rows["swarm"])):
                means = robots[(robots["swarm"] == swarm) & (robots["robot"] >= 0)]
                _draw_swarm(axes, rows[rows["swarm"] == swarm], means, measure, swarm_style(swarm))
            axes.set_title(_title(correlations[correlations["measure"] == measure]), fontsize="small")
            change = f"change of its swarm's SUD by the robot ({MEASURES[measure]})"
            axes.set(xlabel="reward that the robot computes in a game (s)", ylabel=change)
        bars = ", bars: their 95 % intervals" if seeds >= fewest_seeds() else ""
        note = f"means of {seeds} seeds{bars}, points: single games"
        legend_below(figure, note if seeds > 1 else "one seed")
    return figure


def _draw_swarm(axes: Axes, games: pd.DataFrame, means: pd.DataFrame, measure: str, style: LineStyle) -> None:
    if games["seed"].nunique() > 1:
        axes.scatter(games["reward"], games[measure], s=7, color=style.colour, alpha=0.25, linewidths=0)
    axes.errorbar(
        means["reward"],
        means[measure],
        xerr=means["reward_high"] - means["reward"],
        yerr=means[f"{measure}_high"] - means[measure],
        label=f"S{means['swarm'].iloc[0]}: {', '.join(dict.fromkeys(map(short_policy, games['policy'])))}",
        color=style.colour,
        linestyle="none",
        marker=style.marker,
        markerfacecolor=style.colour if style.filled else "white",
        elinewidth=0.8,
    )


def _title(correlations: pd.DataFrame) -> str:
    """Return a line for each swarm."""
    return "\n".join(
        f"S{row['swarm']}: rank correlation of robots {estimate_text(row, 'robots')}, "
        f"in a game {estimate_text(row, 'games')}"
        for row in correlations.to_dict("records")
    )


def write_contribution_figure(directory: Path, title: str = "", **question: object) -> Path:
    """Write `figures/contribution-<id>.png` from `contribution.parquet` in a results directory.

    `title` is the scenario's; `question` is as for `of_question`. `InputError` if the table cannot be read or
    the figure cannot be written; then an existing file is unchanged.
    """
    rows = of_question(read_contributions(directory), **question)
    path = directory / "figures" / f"contribution-{rows['scenario'].iloc[0]}.png"
    save(contribution_figure(rows, title), path)
    return path
