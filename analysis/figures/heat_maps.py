"""Heat maps of the places where conflicts begin."""

import math

import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from kswarms.agents.common.errors import InputError
from kswarms.analysis.colours import swarm_colour
from kswarms.analysis.figures.style import figure_text, new_figure
from kswarms.analysis.film.painter import ArenaLayout
from kswarms.analysis.measures.conflict_density import cell_side, conflict_density
from kswarms.analysis.results.tables import check_frame


def heat_map_figure(conflicts: pd.DataFrame, title: str = "", arena: ArenaLayout | None = None) -> Figure:
    """Draw the places where conflicts begin: all conflicts, and conflicts with each action.

    Parameters
    ----------
    conflicts : pandas.DataFrame
        Conflicts of one or several games: rows of `conflicts.parquet` or of a DataCollector's table. There
        must be at least one.
    title : str
        Heading.
    arena : ArenaLayout, optional
        Arena with the stations and bases to draw, such as `model.arena`. By default, the maps cover all
        conflicts, and at least 2 × 2 m.

    Returns
    -------
    matplotlib.figure.Figure
        Panels with a common logarithmic scale; cells without conflicts are black.
    """
    conflicts = check_frame(conflicts, "conflicts", ["x", "y", "action"])
    if conflicts.empty:
        raise InputError("conflicts", "no rows", "must hold at least one conflict")
    farthest = float(conflicts[["x", "y"]].abs().to_numpy().max())
    half = arena.half if arena is not None else max(1.0, math.ceil(2 * farthest) / 2)
    panel_rows = {f"all: {len(conflicts):,}": conflicts}
    if conflicts["action"].nunique() > 1:
        panel_rows |= {f"{action}: {len(rows):,}": rows for action, rows in conflicts.groupby("action")}
    games = conflicts["run"].nunique() if "run" in conflicts else 1
    # Two robots stuck in a corner have so many conflicts that a linear scale would show only them.
    norm = LogNorm(1 / games, max(conflict_density(conflicts, half).max(), 2 / games))
    colours = colormaps["magma"].with_extremes(bad="black")
    cell = 100 * cell_side(half)
    label = f"conflicts per game and {cell:.0f} × {cell:.0f} cm"
    ticks = np.linspace(-half, half, 5)
    with new_figure(title, width=max(5.5, 4.0 * len(panel_rows)), height=4.4) as figure:
        panels = figure.subplots(1, len(panel_rows), squeeze=False, sharey=True)[0]
        for axes, (name, rows) in zip(panels, panel_rows.items(), strict=True):
            # The density is a mean over the games of `rows`; scale it to a mean over all games.
            counts = conflict_density(rows, half) * (rows["run"].nunique() / games if "run" in rows else 1)
            cells, extent = np.ma.masked_equal(counts, 0), (-half, half, -half, half)
            image = axes.imshow(cells, norm=norm, cmap=colours, origin="lower", extent=extent)
            axes.set(title=figure_text(name), xticks=ticks, yticks=ticks, xlabel="x (m)", ylabel="y (m)")
            axes.label_outer()
            axes.grid(False)
            if arena is not None:
                _draw_arena(axes, arena)
        figure.colorbar(image, ax=panels, shrink=0.8, label=label)
    return figure


def _draw_arena(axes: Axes, arena: ArenaLayout) -> None:
    def add_circle(x: float, y: float, radius: float, colour: str, width: float) -> None:
        axes.add_patch(Circle((x, y), radius, fill=False, color=colour, linewidth=width))

    def add_name(x: float, y: float, name: str) -> None:
        axes.annotate(name, (x, y), color="white", ha="center", va="center", fontsize="small")

    for x, y in arena.stations:
        add_circle(x, y, arena.station_radius, "white", 1.5)
        add_name(x, y, "station")
    for swarm, (x, y) in enumerate(arena.bases, 1):
        add_circle(x, y, arena.base_radius, "white", 3)
        add_circle(x, y, arena.base_radius, swarm_colour(swarm), 1.5)
        add_name(x, y, f"S{swarm}")
