"""Networks of conflicts: meetings of robots, mixing of swarms, and jams over time.

All functions take the conflicts of one game: rows of `conflicts.parquet`, or
`model.datacollector.get_table_dataframe("conflicts")`.
"""

import math
from numbers import Real
from typing import Final

import networkx as nx
import numpy as np
import pandas as pd
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from kswarms.agents.common.errors import InputError
from kswarms.analysis.results.tables import check_frame

_MAX_NODES: Final = 10**8
"""Maximum number of pairs (moment, robot), which limits the memory of `jams`."""
MIN_JAM_SIZE = 3
"""Minimum number of robots in a jam; a conflict of two robots is not a jam."""


def meeting_network(conflicts: pd.DataFrame) -> nx.Graph:
    """Return the network of robots that met; `InputError` if `conflicts` are of several games.

    Returns
    -------
    networkx.Graph
        A node for each robot in a conflict, with its `swarm` (int, from 1). An edge for each pair that met,
        with `meetings` (int): number of conflicts that either robot began; `time` (float, robot-seconds):
        T(a) of these conflicts; and `kind` (str): ``intra`` or ``inter``.
    """
    columns = ["robot", "swarm", "opponent", "opponent_swarm", "t_a"]
    conflicts = check_frame(conflicts, "conflicts", columns)
    if "run" in conflicts and conflicts["run"].nunique() > 1:
        raise InputError("conflicts", f"{conflicts['run'].nunique()} runs", "must be of one game")
    if (alone := conflicts["robot"] == conflicts["opponent"]).any():
        robot = int(conflicts["robot"][alone].iloc[0])
        raise InputError("conflicts column opponent", robot, "must be another robot")
    network = nx.Graph()
    robots = np.concatenate([conflicts["robot"], conflicts["opponent"]]).tolist()
    of_robots = np.concatenate([conflicts["swarm"], conflicts["opponent_swarm"]]).tolist()
    swarms = dict(zip(robots, of_robots, strict=True))
    for robot, swarm in sorted(swarms.items()):
        network.add_node(robot, swarm=swarm)
    pairs = np.sort(conflicts[["robot", "opponent"]].to_numpy(), axis=1)
    met = conflicts["t_a"].groupby([pairs[:, 0], pairs[:, 1]]).agg(["size", "sum"])
    for (first, second), (meetings, time) in zip(met.index, met.to_numpy(), strict=True):
        kind = "intra" if swarms[first] == swarms[second] else "inter"
        network.add_edge(int(first), int(second), meetings=int(meetings), time=float(time), kind=kind)
    return network


def require_edges(network: nx.Graph) -> None:
    """Raise an `InputError` if a network has no edge."""
    if not network.number_of_edges():
        raise InputError("network", "no edges", "must have at least one edge")


def describe_network(network: nx.Graph) -> dict[str, float]:
    """Return summary statistics of a network of meetings with at least one edge.

    * `robots`, `pairs` that met, `met`: share of all pairs that met, `meetings`;
    * `time`: robot-seconds in conflict, `inter`: share of that time between swarms;
    * `degree`: mean number of robots that a robot met, `strength`: mean time of a robot in meetings (s);
    * `assortativity` by swarm-ID: of pairs; `assortativity_time`: of pairs weighted by time; `chance`: of a
      complete network, which is below 0 because no robot meets itself.
    """
    require_edges(network)
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
        "inter": float(1 - np.trace(time) / time.sum()) if time.any() else math.nan,
        "degree": 2 * pairs / robots,
        "strength": float(time.sum() / robots),
        "assortativity": _assortativity(mixing_matrix(network, None)),
        "assortativity_time": _assortativity(time),
        "chance": _assortativity(np.outer(sizes, sizes) - np.diag(sizes)),
    }


def mixing_matrix(network: nx.Graph, weight: str | None) -> np.ndarray:
    """Return the sums of an edge attribute, ``time`` or ``meetings``, by pair of swarms; None counts edges.

    The matrix is symmetric, float64, shape (K, K). An edge within a swarm counts twice, so that a row sums to
    the meetings of its robots with all swarms.
    """
    swarm = nx.get_node_attributes(network, "swarm")
    index = {name: k for k, name in enumerate(sorted(set(swarm.values())))}
    matrix = np.zeros((len(index), len(index)))
    for first, second, data in network.edges(data=True):
        amount = data[weight] if weight else 1
        matrix[index[swarm[first]], index[swarm[second]]] += amount
        matrix[index[swarm[second]], index[swarm[first]]] += amount
    return matrix


def _assortativity(mixing: np.ndarray) -> float:
    """Return Newman's assortativity, r = (Σ e_kk − Σ a_k²) / (1 − Σ a_k²), NaN for a single swarm."""
    if not mixing.any():
        return math.nan
    shares = mixing / mixing.sum()
    by_chance = float((shares.sum(axis=1) ** 2).sum())
    return float((np.trace(shares) - by_chance) / (1 - by_chance)) if by_chance < 1 else math.nan


def jams(conflicts: pd.DataFrame, every: float = 1.0) -> pd.DataFrame:
    """Return jams over time: groups of robots linked by conflicts at the same moment.

    Moments are multiples of `every` (s).

    Returns
    -------
    pandas.DataFrame
        One row for each moment from the first start to the last end of a conflict: `time` (float64, s),
        `jams` (int64): connected components of at least `MIN_JAM_SIZE` robots, `jammed` (int64): robots in
        jams, `largest` (int64): robots in the largest component, 0 without conflicts.
    """
    if not isinstance(every, Real) or not 0 < every < math.inf:
        raise InputError("every", every, "must be a number above 0")
    conflicts = check_frame(conflicts, "conflicts", ["robot", "opponent", "start", "t_a"])
    if conflicts.empty:
        raise InputError("conflicts", "no rows", "must hold at least one conflict")
    names, numbers = np.unique(conflicts[["robot", "opponent"]].to_numpy(), return_inverse=True)
    robots, start = len(names), conflicts["start"].to_numpy()
    seconds = (start + conflicts["t_a"].to_numpy()).max() - start.min()
    if seconds / every * robots > _MAX_NODES:
        rule = f"must be greater: the conflicts of {robots:,} robots last {seconds:g} s"
        raise InputError("every", every, rule)
    # A conflict covers the moments with start ≤ moment < end. Subtract 1e-9 to absorb rounding errors.
    first = np.ceil(start / every - 1e-9).astype(int)
    last = np.ceil((start + conflicts["t_a"].to_numpy()) / every - 1e-9).astype(int)
    origin, moments = first.min(), last.max() - first.min()
    lengths = last - first
    # One edge for each conflict and moment: `edge` is the row of the conflict.
    edge = np.repeat(np.arange(len(conflicts)), lengths)
    moment = np.arange(lengths.sum()) + np.repeat(first - origin - np.cumsum(lengths) + lengths, lengths)
    # A node is a pair (moment, robot). No edge joins two moments, so one call finds all components.
    a, b = (moment * robots + column[edge] for column in numbers.reshape(-1, 2).T)
    nodes = max(moments, 1) * robots
    graph = coo_array((np.ones(len(a), bool), (a, b)), shape=(nodes, nodes))
    _, component = connected_components(graph, directed=False)
    size = np.bincount(component)
    moment_of = np.zeros(len(size), int)
    moment_of[component] = np.arange(nodes) // robots
    groups = pd.DataFrame({"moment": moment_of, "size": size})[size > 1]
    jammed = groups[groups["size"] >= MIN_JAM_SIZE].groupby("moment")["size"].agg(["size", "sum"])
    largest = groups.groupby("moment")["size"].max()
    columns = {"jams": jammed["size"], "jammed": jammed["sum"], "largest": largest}
    over_time = pd.DataFrame(columns, index=range(moments)).fillna(0).astype(np.int64)
    over_time.insert(0, "time", (origin + np.arange(moments)) * every)
    return over_time
