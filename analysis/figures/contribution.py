"""Scatter charts of the true contribution of robots against their computed reward."""

from pathlib import Path

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from kswarms.agents.common.quoting import for_file_name
from kswarms.analysis.figures.files import save_figure
from kswarms.analysis.figures.style import LineStyle, heading, legend_below, new_figure, swarm_style
from kswarms.analysis.measures.contribution import (
    MEASURES,
    mean_contributions,
    measures_with_values,
    rank_correlations,
    select_contributions,
)
from kswarms.analysis.measures.quantities import short_policy
from kswarms.analysis.results.records import read_contributions
from kswarms.analysis.statistics.intervals import min_seeds
from kswarms.analysis.tables.contribution import estimate_text


def contribution_figure(rows: pd.DataFrame, title: str = "") -> Figure:
    """Draw the true contribution of each robot against its computed reward.

    `rows` come from `select_contributions`. Each of `MEASURES` has a panel. Markers with bars are
    the mean and interval of each robot; light points are single games.
    """
    first, seeds, measures = rows.iloc[0], rows["seed"].nunique(), measures_with_values(rows)
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
            text = _correlation_text(correlations[correlations["measure"] == measure])
            axes.set_title(text, fontsize="small")
            change = f"contribution of the robot to the SUD of its swarm ({MEASURES[measure]})"
            axes.set(xlabel="reward that the robot computes in a game (s)", ylabel=change)
        bars = ", bars: their 95 % intervals" if seeds >= min_seeds() else ""
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


def _correlation_text(correlations: pd.DataFrame) -> str:
    """Return the rank correlations as text, one line per swarm."""
    return "\n".join(
        f"S{row['swarm']}: rank correlation of robots {estimate_text(row, 'robots')}, "
        f"in a game {estimate_text(row, 'games')}"
        for row in correlations.to_dict("records")
    )


def write_contribution_figure(directory: Path, title: str = "", **selection: object) -> Path:
    """Write `figures/contribution-<id>.png` from `contribution.parquet` in a results directory.

    `title` is the title of the scenario; `selection` is as for `select_contributions`. `InputError` if the
    table cannot be read or the figure cannot be written; then an existing file is unchanged.
    """
    rows = select_contributions(read_contributions(directory), **selection)
    name = for_file_name(f"contribution-{rows['scenario'].iloc[0]}")
    path = directory / "figures" / f"{name}.png"
    save_figure(contribution_figure(rows, title), path)
    return path
