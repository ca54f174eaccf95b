"""Utilities of players and swarms, and the Swarm Utility Difference (specification, section 1.1).

Utilities of N players against K swarms are an array u of shape (N, K) with u_i^m in row i, column m. Swarms
are counted from 0.
"""

from collections.abc import Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike

from kswarms.agents.common.arrays import Floats
from kswarms.agents.common.errors import InputError

_Utility = TypeVar("_Utility", int, float)
_Numbers = TypeVar("_Numbers", float, Floats)

_TOLERANCE = 1e-9  # relative, for the equality of utilities


def opponents_utility(u: _Numbers) -> _Numbers:
    """Return u_j^k = −u_i^m, the utility of the opponent in an interaction between swarms (Eq. 3.1)."""
    return -u


def utility_between(u: ArrayLike, swarm_of: Sequence[int]) -> Floats:
    """Return Σ_{i∈S_k} u_i^m, which is −Σ_{j∈S_m} u_j^k between two swarms (Eq. 3.2).

    `swarm_of` is the swarm of each of the N players. The result has shape (K, K), with the utility of swarm k
    from its interactions with swarm m in row k, column m.
    """
    u = np.asarray(u, dtype=float)
    between = np.zeros((u.shape[1], u.shape[1]))
    np.add.at(between, np.asarray(swarm_of, dtype=int), u)
    return between


def is_zero_sum_between(u: ArrayLike, swarm_of: Sequence[int]) -> bool:
    """Return whether, for each pair of swarms, the utilities from their interactions sum to zero (Eq. 3.2).

    Parameters are those of `utility_between`.
    """
    between = utility_between(u, swarm_of)
    off = ~np.eye(len(between), dtype=bool)
    scale = max(1.0, float(np.abs(u).sum()))
    return bool((np.abs(between + between.T)[off] <= _TOLERANCE * scale).all())


def player_utilities(u: ArrayLike) -> Floats:
    """Return U_i = Σ_m u_i^m of each player (Eq. 3.3), shape (N,)."""
    utilities: Floats = np.asarray(u, dtype=float).sum(axis=1)
    return utilities


def swarm_utilities(utilities: ArrayLike, swarm_of: Sequence[int], swarms: int) -> Floats:
    """Return U_Sk = Σ_{i∈S_k} U_i of each of K swarms (Eq. 3.5), shape (K,), from U_i, shape (N,)."""
    totals = np.zeros(swarms)
    np.add.at(totals, np.asarray(swarm_of, dtype=int), np.asarray(utilities, dtype=float))
    return totals


def swarm_utility_difference(utilities: Sequence[_Utility], swarm: int) -> _Utility:
    """Return SUD_k = U_Sk − Σ_{m≠k} U_Sm (Eq. 3.7).

    Parameters
    ----------
    utilities : sequence of int or of float, length K
        U_Sk of every swarm, in pucks, seconds or another unit.
    swarm : int
        k, from 0.

    Examples
    --------
    >>> [swarm_utility_difference([5, 3, 1], k) for k in range(3)]
    [1, -3, -7]
    """
    return 2 * utilities[swarm] - sum(utilities)


def sum_of_differences(utilities: Sequence[_Utility]) -> _Utility:
    """Return Σ_k SUD_k = (2 − K) · Σ_k U_Sk (Eq. 3.8).

    Examples
    --------
    >>> sum_of_differences([5, 3, 1])
    -9
    """
    return (2 - len(utilities)) * sum(utilities)


def is_zero_sum_difference(utilities: ArrayLike) -> bool:
    """Return whether the differences SUD_k sum to zero in every outcome (Thm 5, Cor. 6).

    With two swarms they always do (Cor. 6). With another number of swarms, they do only if the utilities sum
    to zero (Thm 5).

    Parameters
    ----------
    utilities : array_like of float, shape (outcomes, K)
        U_Sk of every swarm in each outcome of a game.
    """
    table = np.atleast_2d(np.asarray(utilities, dtype=float))
    sums = np.array([sum_of_differences(outcome) for outcome in table.tolist()])
    scale = np.maximum(1.0, np.abs(table).sum(axis=1))
    return bool((np.abs(sums) <= _TOLERANCE * scale).all())


def dummy_utility(utilities: ArrayLike) -> float:
    """Return −C, the utility of the dummy swarm that makes a constant-sum game zero-sum (Thm 7).

    Parameters
    ----------
    utilities : array_like of float, shape (outcomes, K)
        U_Sk of every swarm in each outcome of the game.

    Raises
    ------
    InputError
        If the outcomes have different sums, so the game is not constant-sum.

    Examples
    --------
    >>> dummy_utility([[5, 3, 1], [0, 9, 0]])
    -9.0
    """
    table = np.atleast_2d(np.asarray(utilities, dtype=float))
    sums = table.sum(axis=1)
    if np.ptp(sums) > _TOLERANCE * max(1.0, float(np.abs(table).sum(axis=1).max())):
        raise InputError("utilities", sums.tolist(), "must have the same sum in every outcome")
    return float(-sums[0])
