"""Figures of the network of conflicts of one game, and of its jams over time."""

from collections.abc import Sequence
from typing import Final

import networkx as nx
import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from kswarms.analysis.colours import swarm_colour
from kswarms.analysis.figures.style import CONDITION_COLOURS, legend_below, new_figure
from kswarms.analysis.measures.networks import MIN_JAM_SIZE, require_edges

_WINDOW: Final = 15
"""Number of samples in the moving mean of jams."""


def network_figure(network: nx.Graph, title: str = "") -> Figure:
    """Draw a network of meetings as a circle of robots and as a matrix.

    Parameters
    ----------
    network : networkx.Graph
        Result of `kswarms.analysis.measures.networks.meeting_network` with at least one edge.
    title : str
        Heading.

    Returns
    -------
    matplotlib.figure.Figure
        Left: edges are wider and darker the longer two robots were in conflict; edges within a swarm are
        grey, edges between swarms black. Right: a matrix of the same times (s) on a logarithmic scale. Robots
        are sorted by swarm; pairs that never met are grey.
    """
    require_edges(network)
    swarm = nx.get_node_attributes(network, "swarm")
    robots = sorted(network, key=lambda robot: (swarm[robot], robot))
    times = nx.to_numpy_array(network, nodelist=robots, weight="time")
    positive = times[times > 0]
    longest, shortest = (positive.max(), positive.min()) if positive.size else (1.0, 1.0)
    with new_figure(title, width=11.0, height=5.6) as figure:
        circle, matrix = figure.subplots(1, 2)
        positions = nx.circular_layout(robots)
        for kind, colour in (("intra", "0.55"), ("inter", "black")):
            edges = [(a, b, met["time"]) for a, b, met in network.edges(data=True) if met["kind"] == kind]
            nx.draw_networkx_edges(
                network,
                positions,
                edgelist=[(a, b) for a, b, _ in edges],
                width=[4 * (time / longest) ** 0.5 for *_, time in edges],
                alpha=[0.05 + 0.65 * time / longest for *_, time in edges],
                edge_color=colour,
                ax=circle,
            )
            circle.plot([], [], color=colour, linewidth=3, label=f"{kind}-swarm meetings")
        for k in sorted(set(swarm.values())):
            x, y = zip(*(positions[robot] for robot in robots if swarm[robot] == k), strict=True)
            circle.scatter(x, y, s=120, color=swarm_colour(k), edgecolors="white", zorder=3, label=f"S{k}")
        circle.set_axis_off()
        circle.set_aspect("equal")
        # Few pairs are in conflict for very long; a linear scale would show only them.
        image = matrix.imshow(
            np.ma.masked_equal(times, 0),
            cmap=colormaps["viridis"].with_extremes(bad="0.85"),
            norm=LogNorm(shortest, max(longest, 2 * shortest)),
        )
        _label_swarms(matrix, [swarm[robot] for robot in robots])
        figure.colorbar(image, ax=matrix, label="time of each pair in conflict, T(a) (s)")
        legend_below(figure)
    return figure


def _label_swarms(axes: Axes, swarms: Sequence[int]) -> None:
    """Label the swarms on both axes of a matrix sorted by swarm, and draw lines between them."""
    names = sorted(set(swarms))
    middles = [np.flatnonzero(np.array(swarms) == name).mean() for name in names]
    for set_ticks in (axes.set_xticks, axes.set_yticks):
        set_ticks(middles, [f"S{name}" for name in names])
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
        Result of `kswarms.analysis.measures.networks.jams`.
    title : str
        Heading.
    """
    time = over_time["time"]
    with new_figure(title, width=11.0, height=4.2) as figure:
        axes = figure.subplots()
        labels = {"jammed": f"in jams of {MIN_JAM_SIZE} or more", "largest": "in the largest cluster"}
        for (quantity, label), colour in zip(labels.items(), CONDITION_COLOURS, strict=False):
            axes.step(time, over_time[quantity], where="post", color=colour, linewidth=0.8, alpha=0.3)
            smooth = over_time[quantity].rolling(_WINDOW, center=True, min_periods=1).mean()
            axes.plot(time, smooth, color=colour, linewidth=2, label=label)
        axes.set(xlabel="time (s)", ylabel="robots")
        axes.set_ylim(bottom=0)
        axes.margins(x=0)
        legend_below(figure, f"thin: each sample, thick: moving mean of {_WINDOW} samples")
    return figure
