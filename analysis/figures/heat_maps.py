"""Where conflicts happen: heat maps of rows of `conflicts.parquet`, or of a DataCollector's table."""

import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from kswarms.agents.common.errors import InputError
from kswarms.analysis.colours import swarm_colour
from kswarms.analysis.figures.style import sheet
from kswarms.analysis.film.painter import Places
from kswarms.analysis.measures.conflict_density import CELL, conflict_density


def heat_maps(conflicts: pd.DataFrame, title: str = "", places: Places | None = None) -> Figure:
    """Draw where conflicts happen: all of them, and those with each action.

    Parameters
    ----------
    conflicts : pandas.DataFrame
        Conflicts of one game or several.
    title : str
        What it is of.
    places : Places, optional
        Stations and bases to be drawn in.

    Returns
    -------
    matplotlib.figure.Figure
        A panel for all conflicts and one for each action, of one logarithmic scale; black is none.

    Raises
    ------
    InputError
        There is no conflict.
    """
    if conflicts.empty:
        raise InputError("conflicts", "no rows", "must hold at least one conflict")
    half = places.half if places is not None else 1.0
    actions = sorted(set(conflicts["action"]))
    kinds = {f"all: {len(conflicts):,}": conflicts}
    if len(actions) > 1:
        of_action = {action: conflicts[conflicts["action"] == action] for action in actions}
        kinds |= {f"{action}: {len(rows):,}": rows for action, rows in of_action.items()}
    games = conflicts["run"].nunique() if "run" in conflicts else 1
    # Logarithmic, or a corner in which two hold each other would leave the rest of the arena black.
    norm = LogNorm(1 / games, max(conflict_density(conflicts, half).max(), 2 / games))
    colours = colormaps["magma"].with_extremes(bad="black")
    side = f"{100 * CELL:.0f}"
    with sheet(title, width=max(5.5, 4.0 * len(kinds)), height=4.4) as figure:
        panels = figure.subplots(1, len(kinds), squeeze=False, sharey=True)[0]
        for axes, (name, rows) in zip(panels, kinds.items(), strict=True):
            counts = conflict_density(rows, half) * (rows["run"].nunique() / games if "run" in rows else 1)
            image = axes.imshow(
                np.ma.masked_equal(counts, 0),
                norm=norm,
                cmap=colours,
                origin="lower",
                extent=(-half, half, -half, half),
            )
            axes.set_title(name)
            axes.set_xticks(np.linspace(-half, half, 5))
            axes.set_yticks(np.linspace(-half, half, 5))
            axes.set_xlabel("x (m)")
            axes.set_ylabel("y (m)")
            axes.label_outer()
            axes.grid(False)
            if places is not None:
                _draw_places(axes, places)
        figure.colorbar(image, ax=panels, shrink=0.8, label=f"conflicts begun in {side} × {side} cm, a game")
    return figure


def _draw_places(axes: Axes, places: Places) -> None:
    for station in places.stations:
        axes.add_patch(
            Circle(tuple(station), places.station_radius, fill=False, color="white", linewidth=1.5)
        )
        axes.annotate("station", station, color="white", ha="center", va="center", fontsize="small")
    for index, base in enumerate(places.bases):
        colour = swarm_colour(index + 1)
        axes.add_patch(Circle(tuple(base), places.base_radius, fill=False, color="white", linewidth=3))
        axes.add_patch(Circle(tuple(base), places.base_radius, fill=False, color=colour, linewidth=1.5))
        axes.annotate(f"S{index + 1}", base, color="white", ha="center", va="center", fontsize="small")
