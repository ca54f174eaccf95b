"""The forms of a multi-swarm game: extensive, normal, polymatrix (specification, section 1.1).

A player meets one robot at a time. Nature draws the robot's swarm, then both players choose an action
simultaneously. Interactions are independent, so the tree folds into one normal form for each swarm-ID.
Swarm-IDs count from 1.
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
"""Players of the extensive form: Nature, the player itself, and the robot that it meets."""

_TOLERANCE: Final = 1e-9  # relative, for the equality of payoffs


@dataclass(frozen=True, eq=False)
class NormalForm:
    """A two-player game in normal form. Within a swarm it is general-sum (Table 3.1).

    Parameters
    ----------
    rows, columns : tuple of str
        Actions of the player itself and of the robot that it meets.
    own, met : ndarray of float64, shape (rows, columns)
        Payoffs of both.

    Raises
    ------
    InputError
        If names of actions repeat, or payoffs have another shape or are not finite.
    """

    rows: tuple[str, ...]
    columns: tuple[str, ...]
    own: Floats
    met: Floats

    def __post_init__(self) -> None:
        for name in ("rows", "columns"):
            actions = getattr(self, name)
            if len(set(actions)) < len(actions) or not actions:
                raise InputError(name, actions, "must be distinct action names")
        for name in ("own", "met"):
            payoffs = np.array(getattr(self, name), dtype=float)
            if payoffs.shape != (len(self.rows), len(self.columns)) or not np.isfinite(payoffs).all():
                raise InputError(name, payoffs.tolist(), "must have a payoff for each row and column")
            payoffs.flags.writeable = False
            object.__setattr__(self, name, payoffs)

    def is_zero_sum(self) -> bool:
        """Return whether the payoffs sum to zero, as between swarms (Eq. 3.1)."""
        return bool(np.allclose(self.met, opponents_utility(self.own), rtol=0, atol=_tolerance(self.own)))

    def potential(self) -> Floats | None:
        """Return an exact potential, shape (rows, columns), or None; see `exact_potential`."""
        return exact_potential((self.own, self.met))


def zero_sum(rows: Sequence[str], columns: Sequence[str], own: Floats) -> NormalForm:
    """Return the game between players of two swarms, u_j^k = −u_i^m (Table 3.2).

    Parameters are those of `NormalForm`.
    """
    own = np.asarray(own, dtype=float)
    return NormalForm(tuple(rows), tuple(columns), own, opponents_utility(own))


def exact_potential(payoffs: Sequence[Floats]) -> Floats | None:
    """Return the exact potential of a game, or None if the game has none.

    When one player alone changes its action, the potential changes by the same amount as its payoff. The
    potential is 0 where every player takes its first action.

    Parameters
    ----------
    payoffs : sequence of ndarray of float64, length n, each of shape (A_1, …, A_n)
        Payoff of each player for every combination of actions. The potential has the same shape.
    """
    tables = [np.asarray(payoff, dtype=float) for payoff in payoffs]
    potential = np.zeros(tables[0].shape)
    for profile in np.ndindex(potential.shape):
        # Change the actions one player after the other. In a potential game every order gives the same sum.
        for i, table in enumerate(tables):
            rest = (0,) * (len(tables) - i - 1)
            potential[profile] += table[(*profile[: i + 1], *rest)] - table[(*profile[:i], 0, *rest)]
    return potential if is_potential(potential, tables) else None


def is_potential(potential: Floats, payoffs: Sequence[Floats]) -> bool:
    """Return whether `potential` is an exact potential of the payoffs (see `exact_potential`).

    For the players of one swarm, with the actions of all others fixed, SUD is a potential of their WLU
    (section 1.2).
    """
    for i, payoff in enumerate(payoffs):
        rest = np.asarray(payoff, dtype=float) - potential
        # The difference must not depend on the own action.
        if np.ptp(rest, axis=i).max(initial=0.0) > _tolerance(payoff, potential):
            return False
    return True


def extensive_form(forms: Mapping[int, NormalForm], chances: Mapping[int, float] | None = None) -> nx.DiGraph:
    """Return the tree of an interaction: Nature draws a swarm, then both players act (Fig. 3.1).

    Parameters
    ----------
    forms : mapping of int to NormalForm
        The game with a robot of each swarm.
    chances : mapping of int to float, optional
        Probability of each swarm; equal by default.

    Returns
    -------
    networkx.DiGraph
        A tree with root ``()``. A node is the tuple of moves so far: swarm, own action, action of the other
        robot. It has a ``player``, `NATURE`, `OWN` or `MET`, and an ``information`` set; the other robot does
        not see the own action. Leaves have an empty player and ``payoffs`` (own, met). Edges have an
        ``action``, those of Nature also a ``chance``.

    Raises
    ------
    InputError
        If there is no swarm, or the chances are not probabilities of these swarms.
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
    """Return the normal form for each swarm of a tree from `extensive_form` (Tables 3.1, 3.2).

    Raises
    ------
    InputError
        If the other robot's nodes differ in information or actions, so the players do not act simultaneously.
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
    """Return a game of K swarms as a graph of two-player games (section 1.1).

    Parameters
    ----------
    forms : mapping of (int, int) to NormalForm
        The game of each pair k ≤ m, with swarm k in the rows. Games within a swarm, k = m, are optional.

    Returns
    -------
    networkx.Graph
        Nodes are the swarms 1 … K with their ``actions``, edges have their game as ``form``. Self-loops are
        games within a swarm.

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
                raise InputError("forms", (k, m), f"must give swarm {swarm} the same actions in all games")
            graph.add_node(swarm, actions=actions)
        graph.add_edge(k, m, form=form)
    return graph


def is_pairwise_zero_sum(graph: nx.Graph) -> bool:
    """Return whether every game between two swarms of a polymatrix game is zero-sum (Eq. 3.1)."""
    return all(form.is_zero_sum() for k, m, form in graph.edges(data="form") if k != m)


def swarm_payoffs(graph: nx.Graph) -> Floats:
    """Return U_Sk of every swarm of a polymatrix game in which each swarm acts as one player.

    The result has shape (K, A_1, …, A_K): swarm, then the action of each swarm. A game within a swarm adds
    the payoffs of both players.
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
