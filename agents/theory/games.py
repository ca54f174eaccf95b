"""The forms of a multi-swarm game: extensive, normal, polymatrix (specification, section 1.1).

A player meets one robot at a time. Nature draws which swarm it is of, then both choose an action at once;
since nothing of an interaction outlasts it, the tree folds into one game in normal form for each swarm-ID.
Swarm-IDs count from 1 here, as users write them.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Final

import networkx as nx
import numpy as np

from kswarms.agents.common.arrays import Floats
from kswarms.agents.common.errors import InputError
from kswarms.agents.theory.swarms import opponents_utility

NATURE: Final = "Nature"
OWN: Final = "own"
MET: Final = "met"
"""Who decides at a node of the extensive form: Nature, the player itself, or the one that it meets."""

_TOLERANCE: Final = 1e-9
"""Payoffs that differ by less than this part of the largest of them are equal."""


@dataclass(frozen=True, eq=False)
class NormalForm:
    """A game of two players, general-sum as within a swarm (Table 3.1).

    Parameters
    ----------
    rows, columns : tuple of str
        Actions of the player itself and of the one that it meets.
    own, met : ndarray of float64, shape (rows, columns)
        Their payoffs.

    Raises
    ------
    InputError
        If two actions have one name, or the payoffs do not have this shape or are not finite.
    """

    rows: tuple[str, ...]
    columns: tuple[str, ...]
    own: Floats
    met: Floats

    def __post_init__(self) -> None:
        for name in ("rows", "columns"):
            actions = getattr(self, name)
            if len(set(actions)) < len(actions) or not actions:
                raise InputError(name, actions, "must be actions of different names")
        for name in ("own", "met"):
            payoffs = np.array(getattr(self, name), dtype=float)
            if payoffs.shape != (len(self.rows), len(self.columns)) or not np.isfinite(payoffs).all():
                raise InputError(name, payoffs.tolist(), "must have a payoff for each row and column")
            payoffs.flags.writeable = False
            object.__setattr__(self, name, payoffs)

    def is_zero_sum(self) -> bool:
        """Tell whether what one player gets the other one loses, as between swarms (Eq. 3.1)."""
        return bool(np.allclose(self.met, opponents_utility(self.own), rtol=0, atol=_tolerance(self.own)))

    def potential(self) -> Floats | None:
        """Return an exact potential, shape (rows, columns), or None: see `exact_potential`."""
        return exact_potential((self.own, self.met))


def zero_sum(rows: Sequence[str], columns: Sequence[str], own: Floats) -> NormalForm:
    """Return the game between players of two swarms, u_j^k = −u_i^m (Table 3.2).

    Parameters
    ----------
    rows, columns : sequence of str
        Actions of the player itself and of the one that it meets.
    own : array_like of float, shape (rows, columns)
        Payoffs of the player itself.
    """
    own = np.asarray(own, dtype=float)
    return NormalForm(tuple(rows), tuple(columns), own, opponents_utility(own))


def exact_potential(payoffs: Sequence[Floats]) -> Floats | None:
    """Return a function whose change is that of the payoff of whoever alone changes its action.

    Parameters
    ----------
    payoffs : sequence of ndarray of float64, length n, each of shape (A_1, …, A_n)
        Payoff of each player under every combination of actions.

    Returns
    -------
    ndarray of float64, shape (A_1, …, A_n), or None
        The potential that is 0 where all take their first action; None if the game has none.
    """
    tables = [np.asarray(payoff, dtype=float) for payoff in payoffs]
    potential = np.zeros(tables[0].shape)
    for profile in np.ndindex(potential.shape):
        # From the first actions to the profile, one player after the other: in a potential game every way
        # gives the same sum.
        for i, table in enumerate(tables):
            rest = (0,) * (len(tables) - i - 1)
            potential[profile] += table[(*profile[: i + 1], *rest)] - table[(*profile[:i], 0, *rest)]
    return potential if is_potential(potential, tables) else None


def is_potential(potential: Floats, payoffs: Sequence[Floats]) -> bool:
    """Tell whether a function changes as the payoff of whoever alone changes its action.

    For the players of one swarm, the actions of all others fixed, SUD is such a function of their WLU
    (section 1.2).

    Parameters
    ----------
    potential : array_like of float, shape (A_1, …, A_n)
    payoffs : sequence of array_like of float, length n, each of the same shape
    """
    for i, payoff in enumerate(payoffs):
        rest = np.asarray(payoff, dtype=float) - potential
        # What is left over does not depend on the own action.
        if np.ptp(rest, axis=i).max(initial=0.0) > _tolerance(payoff, potential):
            return False
    return True


def extensive_form(forms: Mapping[int, NormalForm], chances: Mapping[int, float] | None = None) -> nx.DiGraph:
    """Return the tree of an interaction: Nature draws whom a player meets, then both act at once (Fig. 3.1).

    Parameters
    ----------
    forms : mapping of int to NormalForm
        What the interaction with a robot of each swarm is worth.
    chances : mapping of int to float, optional
        Probability of each swarm; equal if not given.

    Returns
    -------
    networkx.DiGraph
        A tree from the root ``()``. Nodes are the moves made so far, (swarm, own action, action of the one
        met), with ``player``: `NATURE`, `OWN`, `MET`, or empty at the leaves, which have ``payoffs`` (own,
        met). Nodes of one ``information`` set look the same to whoever decides there: the one met does not
        see what has been chosen. Edges have their ``action``, those of Nature a ``chance`` as well.

    Raises
    ------
    InputError
        If there is no swarm, or the chances are no probabilities of these swarms.
    """
    if not forms:
        raise InputError("forms", {}, "must have a game for at least one swarm")
    if chances is None:
        chances = dict.fromkeys(forms, 1 / len(forms))
    if set(chances) != set(forms) or min(chances.values()) < 0 or abs(sum(chances.values()) - 1) > _TOLERANCE:
        raise InputError("chances", dict(chances), f"must be probabilities of the swarms {sorted(forms)}")
    tree = nx.DiGraph()
    tree.add_node((), player=NATURE, information=())
    for swarm, form in forms.items():
        tree.add_node((swarm,), player=OWN, information=(swarm, OWN))
        tree.add_edge((), (swarm,), action=f"S{swarm}", chance=chances[swarm])
        for a, row in enumerate(form.rows):
            tree.add_node((swarm, row), player=MET, information=(swarm, MET))
            tree.add_edge((swarm,), (swarm, row), action=row)
            for b, column in enumerate(form.columns):
                payoffs = (float(form.own[a, b]), float(form.met[a, b]))
                tree.add_node((swarm, row, column), player="", payoffs=payoffs)
                tree.add_edge((swarm, row), (swarm, row, column), action=column)
    return tree


def fold(tree: nx.DiGraph) -> dict[int, NormalForm]:
    """Return the game in normal form for each swarm that Nature can draw (Tables 3.1, 3.2).

    Parameters
    ----------
    tree : networkx.DiGraph
        As `extensive_form` returns it.

    Raises
    ------
    InputError
        If the one met can tell its nodes apart, or has other actions in some of them: then the players do
        not act at once, and there is no such form.
    """
    forms = {}
    for (swarm,) in tree.successors(()):
        nodes = list(tree.successors((swarm,)))
        information = {tree.nodes[node]["information"] for node in nodes}
        actions = {_actions(tree, node) for node in nodes}
        if len(information) > 1 or len(actions) > 1:
            raise InputError(f"S{swarm}", sorted(map(str, information)), "must be one information set")
        leaves = [[tree.nodes[leaf]["payoffs"] for leaf in tree.successors(node)] for node in nodes]
        payoffs = np.array(leaves, dtype=float)
        rows, (columns,) = _actions(tree, (swarm,)), actions
        forms[swarm] = NormalForm(rows, columns, payoffs[..., 0], payoffs[..., 1])
    return forms


def _actions(tree: nx.DiGraph, node: tuple[object, ...]) -> tuple[str, ...]:
    return tuple(tree.edges[node, after]["action"] for after in tree.successors(node))


def polymatrix(forms: Mapping[tuple[int, int], NormalForm]) -> nx.Graph:
    """Return the game of K swarms as the graph of the games between each two (section 1.1).

    Parameters
    ----------
    forms : mapping of (int, int) to NormalForm
        The game of each pair k ≤ m, swarm k in the rows; k = m is the game within a swarm, and may be
        missing.

    Returns
    -------
    networkx.Graph
        Nodes are the swarms 1 … K, with their ``actions``; edges have their game as ``form``, self-loops
        those within a swarm.

    Raises
    ------
    InputError
        If the game of a pair is missing, or a swarm has different actions in two games.
    """
    swarms = range(1, len({swarm for pair in forms for swarm in pair}) + 1)
    needed = set(combinations(swarms, 2))
    if not forms or not needed <= set(forms) <= needed | {(k, k) for k in swarms}:
        raise InputError("forms", sorted(forms), "must have one game for each pair k < m of the swarms 1 … K")
    graph = nx.Graph()
    for (k, m), form in sorted(forms.items()):
        for swarm, actions in ((k, form.rows), (m, form.columns)):
            if graph.nodes.get(swarm, {}).get("actions", actions) != actions:
                raise InputError("forms", (k, m), f"must have swarm {swarm}'s actions of its other games")
            graph.add_node(swarm, actions=actions)
        graph.add_edge(k, m, form=form)
    return graph


def is_pairwise_zero_sum(graph: nx.Graph) -> bool:
    """Tell whether every game between two swarms of a polymatrix game is zero-sum (Eq. 3.1)."""
    return all(form.is_zero_sum() for k, m, form in graph.edges(data="form") if k != m)


def swarm_payoffs(graph: nx.Graph) -> Floats:
    """Return U_Sk of every swarm of a polymatrix game, each acting as one.

    Within a swarm, both players' payoffs are the swarm's.

    Returns
    -------
    ndarray of float64, shape (K, A_1, …, A_K)
        Swarm, then the action of each swarm.
    """
    swarms = sorted(graph.nodes)
    shape = [len(graph.nodes[swarm]["actions"]) for swarm in swarms]
    payoffs = np.zeros((len(swarms), *shape))
    for first, second, form in graph.edges(data="form"):
        k, m = sorted((first, second))
        for profile in np.ndindex(*shape):
            cell = profile[k - 1], profile[m - 1]
            payoffs[(k - 1, *profile)] += form.own[cell]
            payoffs[(m - 1, *profile)] += form.met[cell]
    return payoffs


def _tolerance(*tables: Floats) -> float:
    return _TOLERANCE * max(1.0, *(float(np.abs(table).max()) for table in tables))
