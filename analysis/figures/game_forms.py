"""Drawings of the forms of a multi-swarm game: the extensive form (Fig. 3.1) and the polymatrix game."""

import math
from itertools import pairwise
from typing import Final

import networkx as nx
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from kswarms.agents.theory.games import MET, NATURE, OWN, NormalForm
from kswarms.analysis.colours import swarm_colour
from kswarms.analysis.figures.style import LITERAL_TEXT, default_settings

_NODE_STYLES: Final = {
    NATURE: ("o", 9, "0.35"),
    OWN: ("s", 9, "tab:blue"),
    MET: ("D", 9, "tab:orange"),
    "": (".", 5, "black"),
}
"""Marker, size and colour of a node, by the player who decides there."""
_MOVES: Final = {
    NATURE: "Nature draws\nthe swarm met",
    OWN: "the player\nacts",
    MET: "the robot met acts,\nwithout seeing it",
}
_MATRICES_PER_LINE: Final = 3
_LABEL: Final = {"boxstyle": "round,pad=0.15", "facecolor": "white", "edgecolor": "none"}


@default_settings(LITERAL_TEXT)
def draw_extensive_form(tree: nx.DiGraph) -> Figure:
    """Draw the tree of an interaction, from left to right (Fig. 3.1).

    Dashed lines join the nodes of an information set, which the deciding player cannot distinguish.

    Parameters
    ----------
    tree : networkx.DiGraph
        Result of `kswarms.agents.theory.games.extensive_form`.
    """
    leaves = [node for node in nx.dfs_preorder_nodes(tree, ()) if not tree.out_degree(node)]
    height = {leaf: -float(rank) for rank, leaf in enumerate(leaves)}
    for node in nx.dfs_postorder_nodes(tree, ()):
        if node not in height:
            below = [height[after] for after in tree.successors(node)]
            height[node] = sum(below) / len(below)
    figure = Figure(figsize=(8.0, 1.6 + 0.34 * len(leaves)), layout="constrained")
    axes = figure.add_subplot()
    axes.set_axis_off()
    for before, after, edge in tree.edges(data=True):
        x, y = [len(before), len(after)], [height[before], height[after]]
        axes.plot(x, y, color="0.6", linewidth=1, zorder=1)
        chance = f", p = {edge['chance']:.3g}" if "chance" in edge else ""
        # The label is nearer to the later node, where branches are farther apart.
        place = x[0] + 0.62, y[0] + 0.62 * (y[1] - y[0])
        axes.annotate(edge["action"] + chance, place, ha="center", va="center", fontsize=9, bbox=_LABEL)
    sets: dict[object, list[tuple[int, float]]] = {}
    for node, data in tree.nodes(data=True):
        marker, size, colour = _NODE_STYLES[data["player"]]
        axes.plot(len(node), height[node], marker, color=colour, markersize=size, zorder=3)
        if "payoffs" in data:
            axes.annotate(_payoff_text(*data["payoffs"]), (3.06, height[node]), va="center", fontsize=9)
        else:
            sets.setdefault(data["information"], []).append((len(node), height[node]))
    _, _, colour = _NODE_STYLES[MET]
    for places in sets.values():
        for first, second in pairwise(places):
            axes.plot(*zip(first, second, strict=True), "--", color=colour, linewidth=1.2, zorder=2)
    for column, player in enumerate((NATURE, OWN, MET)):
        axes.annotate(_MOVES[player], (column, 0.9), ha="center", va="bottom", fontsize=10)
    axes.annotate("payoffs (own, met)", (3.0, 0.9), ha="left", va="bottom", fontsize=10)
    axes.set(xlim=(-0.45, 3.75), ylim=(min(height.values()) - 0.6, 1.7))
    return figure


@default_settings(LITERAL_TEXT)
def draw_polymatrix(graph: nx.Graph) -> Figure:
    """Draw the graph of the games between K swarms, and the payoff matrix of each game below it.

    Nodes are swarms; loops are games within a swarm. Payoffs are (row, column); rows belong to the swarm with
    the lower number.

    Parameters
    ----------
    graph : networkx.Graph
        Result of `kswarms.agents.theory.games.polymatrix`.
    """
    forms = sorted((min(ends), max(ends), form) for *ends, form in graph.edges(data="form"))
    lines = math.ceil(len(forms) / _MATRICES_PER_LINE)
    height = 0.45 + 0.19 * max(len(form.rows) for *_, form in forms)
    figure = Figure(figsize=(9.5, 3.6 + height * lines), layout="constrained")
    grid = figure.add_gridspec(
        lines + 1, _MATRICES_PER_LINE, height_ratios=[3.6, *[height] * lines], hspace=0.02
    )
    _draw_graph(figure.add_subplot(grid[0, :]), graph)
    figure.legend(loc="upper right", frameon=False)
    for index, (k, m, form) in enumerate(forms):
        axes = figure.add_subplot(grid[1 + index // _MATRICES_PER_LINE, index % _MATRICES_PER_LINE])
        axes.set_axis_off()
        _draw_matrix(axes, form, f"within S{k}" if k == m else f"S{k} (rows), S{m} (columns)")
    return figure


def _draw_graph(axes: Axes, graph: nx.Graph) -> None:
    axes.set_axis_off()
    axes.set_aspect("equal")
    swarms = sorted(graph.nodes)
    # Two swarms are side by side; more are on a circle, clockwise from the top.
    first = math.pi if len(swarms) == 2 else math.pi / 2
    angles = {swarm: first - 2 * math.pi * k / len(swarms) for k, swarm in enumerate(swarms)}
    place = {swarm: (math.cos(angle), math.sin(angle)) for swarm, angle in angles.items()}
    shown = set()
    for k, m, form in graph.edges(data="form"):
        line, colour, kind = ("-", "0.2", "zero-sum") if form.is_zero_sum() else ("--", "0.55", "general-sum")
        x, y = zip(place[k], place[m], strict=True) if k != m else _loop(*place[k])
        axes.plot(x, y, line, color=colour, label=None if kind in shown else kind, zorder=1)
        shown.add(kind)
    for k, swarm in enumerate(swarms):
        axes.plot(*place[swarm], "o", color=swarm_colour(k + 1), markersize=24, zorder=3)
        name = axes.text(*place[swarm], f"S{swarm}", color="white", weight="bold", zorder=4)
        name.set(ha="center", va="center")


def _loop(x: float, y: float) -> tuple[list[float], list[float]]:
    """Return a circle through a node, on the side away from the centre of the graph."""
    angles = [2 * math.pi * step / 60 for step in range(61)]
    return [1.22 * x + 0.22 * math.cos(a) for a in angles], [1.22 * y + 0.22 * math.sin(a) for a in angles]


def _draw_matrix(axes: Axes, form: NormalForm, title: str) -> None:
    """Draw the payoff matrix of a game as monospaced text."""
    cells = [
        [_payoff_text(*pair) for pair in zip(*row, strict=True)]
        for row in zip(form.own.tolist(), form.met.tolist(), strict=True)
    ]
    table = [["", *form.columns], *([name, *row] for name, row in zip(form.rows, cells, strict=True))]
    widths = [max(len(row[c]) for row in table) for c in range(len(table[0]))]
    lines = ["  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True)) for row in table]
    axes.set_title(title, fontsize=9)
    axes.annotate("\n".join(lines), (0.5, 1.0), ha="center", va="top", fontsize=8, family="monospace")


def _payoff_text(own: float, met: float) -> str:
    """Return two payoffs as text; zero has no sign."""
    return f"({own + 0.0:.3g}, {met + 0.0:.3g})"
