"""Who met whom: networks of conflicts, how much swarms mix in them, and jams as their clusters over time.

All functions take rows of `conflicts.parquet`, or the table of a model's DataCollector
(`model.datacollector.get_table_dataframe("conflicts")`), of one game.
"""

from collections.abc import Sequence

import networkx as nx
import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from kswarms.agents.common.errors import InputError
from kswarms.analysis.colours import swarm_colour
from kswarms.analysis.figures.style import CONDITION_COLOURS, legend_below, sheet

_SMOOTHED = 15
"""Moments that a thick line of jams is the mean of."""

SMALLEST_JAM = 3
"""Robots that hold each other up, from which on it is a jam: two are a conflict."""


def meeting_network(conflicts: pd.DataFrame) -> nx.Graph:
    """Return the network of robots that met.

    Parameters
    ----------
    conflicts : pandas.DataFrame
        Conflicts of one game.

    Returns
    -------
    networkx.Graph
        A node for each robot that began a conflict or was met in one, with its `swarm` (int, from 1); an edge
        for each pair that met, with `meetings` (int): conflicts that either of the two began with the other,
        `time` (float, robot-seconds): T(a) of these, and `kind` (str): ``intra`` or ``inter``.

    Raises
    ------
    InputError
        `conflicts` are of several games.
    """
    if "run" in conflicts and conflicts["run"].nunique() > 1:
        raise InputError("conflicts", f"{conflicts['run'].nunique()} runs", "must be of one game")
    network = nx.Graph()
    swarms = swarms_of(conflicts)
    for robot, swarm in sorted(swarms.items()):
        network.add_node(robot, swarm=swarm)
    pairs = np.sort(conflicts[["robot", "opponent"]].to_numpy(), axis=1)
    met = (
        pd.DataFrame({"first": pairs[:, 0], "second": pairs[:, 1], "t_a": conflicts["t_a"].to_numpy()})
        .groupby(["first", "second"])["t_a"]
        .agg(["size", "sum"])
    )
    for (first, second), (meetings, time) in zip(met.index, met.to_numpy(), strict=True):
        kind = "intra" if swarms[first] == swarms[second] else "inter"
        network.add_edge(int(first), int(second), meetings=int(meetings), time=float(time), kind=kind)
    return network


def swarms_of(conflicts: pd.DataFrame) -> dict[int, int]:
    """Return the swarm, from 1, of each robot that began a conflict or was met in one."""
    robots = np.concatenate([conflicts["robot"], conflicts["opponent"]])
    swarms = np.concatenate([conflicts["swarm"], conflicts["opponent_swarm"]])
    return {int(robot): int(swarm) for robot, swarm in zip(robots, swarms, strict=True)}


def describe(network: nx.Graph) -> dict[str, float]:
    """Describe a network of meetings.

    Parameters
    ----------
    network : networkx.Graph
        As `meeting_network` returns it, with at least one edge.

    Returns
    -------
    dict of str to float
        `robots`; `pairs` that met; `met`: pairs that met of all there are; `meetings`; `time` (robot-seconds
        in conflict); `inter`: share of that time spent with other swarms; `degree`: others that a robot met,
        mean; `strength` (s): time that a robot spent in meetings, begun by either side, mean; `assortativity`
        by swarm-ID, of the pairs; `assortativity_time`, the same with pairs weighted by time; and `chance`:
        both, had everybody met everybody alike, which is below 0 since nobody meets itself.
    """
    swarms = sorted(set(nx.get_node_attributes(network, "swarm").values()))
    sizes = np.array([sum(s == swarm for _, s in network.nodes(data="swarm")) for swarm in swarms], float)
    time = mixing_matrix(network, "time")
    robots = network.number_of_nodes()
    pairs = network.number_of_edges()
    return {
        "robots": robots,
        "pairs": pairs,
        "met": pairs / (robots * (robots - 1) / 2),
        "meetings": sum(meetings for *_, meetings in network.edges(data="meetings")),
        "time": float(time.sum() / 2),
        "inter": float(1 - np.trace(time) / time.sum()),
        "degree": 2 * pairs / robots,
        "strength": float(time.sum() / robots),
        "assortativity": _assortativity(mixing_matrix(network, None)),
        "assortativity_time": _assortativity(time),
        "chance": _assortativity(np.outer(sizes, sizes) - np.diag(sizes)),
    }


def mixing_matrix(network: nx.Graph, weight: str | None) -> np.ndarray:
    """Return how much swarms had to do with each other.

    Parameters
    ----------
    network : networkx.Graph
        As `meeting_network` returns it.
    weight : {'time', 'meetings'}, optional
        What is added up for each pair; None counts pairs.

    Returns
    -------
    ndarray of float64, shape (K, K)
        Symmetric; row and column k are the k-th of the swarms present. Each pair counts once from either
        side, so that a row sums to what its swarm's robots had to do with anyone.
    """
    swarm = nx.get_node_attributes(network, "swarm")
    index = {name: k for k, name in enumerate(sorted(set(swarm.values())))}
    matrix = np.zeros((len(index), len(index)))
    for first, second, value in network.edges(data=weight) if weight else network.edges(data="kind"):
        amount = value if weight else 1
        matrix[index[swarm[first]], index[swarm[second]]] += amount
        matrix[index[swarm[second]], index[swarm[first]]] += amount
    return matrix


def _assortativity(mixing: np.ndarray) -> float:
    """Return Newman's assortativity, r = (Σ e_kk − Σ a_k²) / (1 − Σ a_k²), NaN for a single swarm."""
    shares = mixing / mixing.sum()
    by_chance = float((shares.sum(axis=1) ** 2).sum())
    return float((np.trace(shares) - by_chance) / (1 - by_chance)) if by_chance < 1 else float("nan")


def jams(conflicts: pd.DataFrame, every: float = 1.0) -> pd.DataFrame:
    """Follow jams: robots linked by conflicts that go on at the same moment.

    Parameters
    ----------
    conflicts : pandas.DataFrame
        Conflicts of one game.
    every : float
        Time between the moments looked at (s).

    Returns
    -------
    pandas.DataFrame
        One row for each moment from the first start to the last end of a conflict: `time` (float64, s),
        `jams` (int64): connected components of at least `SMALLEST_JAM` robots, `jammed` (int64): robots in
        these, `largest` (int64): robots in the largest component, 0 without any conflict.

    Raises
    ------
    InputError
        `every` is not above 0, or there is no conflict.
    """
    if every <= 0:
        raise InputError("every", every, "must be above 0")
    if conflicts.empty:
        raise InputError("conflicts", "no rows", "must hold at least one conflict")
    start = conflicts["start"].to_numpy()
    # A moment belongs to the conflicts with start ≤ moment < end. Moments are whole multiples of `every`,
    # starts of the control period, and rounding must not carry one across a moment.
    first = np.ceil(start / every - 1e-9).astype(int)
    last = np.ceil((start + conflicts["t_a"].to_numpy()) / every - 1e-9).astype(int)
    origin, moments = first.min(), last.max() - first.min()
    lengths = last - first
    edge = np.repeat(np.arange(len(conflicts)), lengths)
    moment = (
        np.arange(lengths.sum()) - np.repeat(np.cumsum(lengths) - lengths, lengths) + first[edge] - origin
    )
    robots = int(conflicts[["robot", "opponent"]].to_numpy().max()) + 1
    # One graph of (moment, robot), in which no edge joins two moments: components of all moments in one call.
    a = moment * robots + conflicts["robot"].to_numpy()[edge]
    b = moment * robots + conflicts["opponent"].to_numpy()[edge]
    nodes = max(moments, 1) * robots
    graph = coo_array((np.ones(len(a), bool), (a, b)), shape=(nodes, nodes))
    _, component = connected_components(graph, directed=False)
    size = np.bincount(component)
    at = np.zeros(len(size), int)
    at[component] = np.arange(nodes) // robots
    of = pd.DataFrame({"at": at, "size": size})[size > 1]
    jammed = of[of["size"] >= SMALLEST_JAM].groupby("at")["size"].agg(["size", "sum"])
    index = pd.RangeIndex(moments)
    return pd.DataFrame(
        {
            "time": (origin + np.arange(moments)) * every,
            "jams": jammed["size"].reindex(index, fill_value=0),
            "jammed": jammed["sum"].reindex(index, fill_value=0),
            "largest": of.groupby("at")["size"].max().reindex(index, fill_value=0),
        }
    )


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
