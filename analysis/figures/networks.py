"""Figures of the network of conflicts of one game, and of its jams over time."""

from collections.abc import Sequence

import networkx as nx
import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from kswarms.analysis.colours import swarm_colour
from kswarms.analysis.figures.style import CONDITION_COLOURS, legend_below, sheet
from kswarms.analysis.measures.networks import SMALLEST_JAM

_SMOOTHED = 15
"""Moments that a thick line of jams is the mean of."""


def network_figure(network: nx.Graph, title: str = "") -> Figure:
    """Draw who met whom: robots around a circle, swarm by swarm, and the time of each pair as a matrix.

    Parameters
    ----------
    network : networkx.Graph
        As `meeting_network` returns it, with at least one edge.
    title : str
        What it is of.

    Returns
    -------
    matplotlib.figure.Figure
        Left the network, the wider and darker an edge the longer the two met, grey within a swarm and black
        between swarms; right the same times (s), logarithmic, robots in the same order; grey never met.
    """
    swarm = nx.get_node_attributes(network, "swarm")
    order = sorted(network, key=lambda robot: (swarm[robot], robot))
    times = nx.to_numpy_array(network, nodelist=order, weight="time")
    most = times.max()
    with sheet(title, width=11.0, height=5.6) as figure:
        circle, matrix = figure.subplots(1, 2)
        places = nx.circular_layout(order)
        for kind, colour in (("intra", "0.55"), ("inter", "black")):
            edges = [(a, b, met["time"]) for a, b, met in network.edges(data=True) if met["kind"] == kind]
            nx.draw_networkx_edges(
                network,
                places,
                edgelist=[(a, b) for a, b, _ in edges],
                width=[4 * (time / most) ** 0.5 for *_, time in edges],
                alpha=[0.05 + 0.65 * time / most for *_, time in edges],
                edge_color=colour,
                ax=circle,
            )
            circle.plot([], [], color=colour, linewidth=3, label=f"{kind}-swarm meetings")
        for name in sorted(set(swarm.values())):
            of_swarm = [robot for robot in order if swarm[robot] == name]
            colour = swarm_colour(name)
            spots = np.array([places[robot] for robot in of_swarm])
            circle.scatter(*spots.T, s=120, color=colour, edgecolors="white", zorder=3, label=f"S{name}")
        circle.set_axis_off()
        circle.set_aspect("equal")
        # Few pairs hold each other for long: a linear scale would show these alone.
        least = times[times > 0].min()
        image = matrix.imshow(
            np.ma.masked_equal(times, 0),
            cmap=colormaps["viridis"].with_extremes(bad="0.85"),
            norm=LogNorm(least, max(most, 2 * least)),
        )
        _name_swarms(matrix, [swarm[robot] for robot in order])
        figure.colorbar(image, ax=matrix, label="time of the two in conflict with each other, T(a) (s)")
        legend_below(figure)
    return figure


def _name_swarms(axes: Axes, swarms: Sequence[int]) -> None:
    """Name the swarms along both sides of a matrix whose robots lie swarm by swarm, and part them."""
    names = sorted(set(swarms))
    middles = [np.flatnonzero(np.array(swarms) == name).mean() for name in names]
    axes.set_xticks(middles, [f"S{name}" for name in names])
    axes.set_yticks(middles, [f"S{name}" for name in names])
    axes.grid(False)
    for name in names[1:]:
        edge = swarms.index(name) - 0.5
        axes.axhline(edge, color="white", linewidth=1.5)
        axes.axvline(edge, color="white", linewidth=1.5)


def jams_figure(over_time: pd.DataFrame, title: str = "") -> Figure:
    """Draw the robots in jams and the largest cluster over time.

    Parameters
    ----------
    over_time : pandas.DataFrame
        As `jams` returns it.
    title : str
        What it is of.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with sheet(title, width=11.0, height=4.2) as figure:
        axes = figure.subplots()
        time = over_time["time"]
        labels = {"jammed": f"in jams of {SMALLEST_JAM} or more", "largest": "in the largest cluster"}
        for (quantity, label), colour in zip(labels.items(), CONDITION_COLOURS, strict=False):
            axes.step(time, over_time[quantity], where="post", color=colour, linewidth=0.8, alpha=0.3)
            smooth = over_time[quantity].rolling(_SMOOTHED, center=True, min_periods=1).mean()
            axes.plot(time, smooth, color=colour, linewidth=2, label=label)
        axes.set_xlabel("time (s)")
        axes.set_ylabel("robots")
        axes.set_ylim(bottom=0)
        axes.margins(x=0)
        legend_below(figure, f"thin: at each moment, thick: mean of {_SMOOTHED} moments")
    return figure
