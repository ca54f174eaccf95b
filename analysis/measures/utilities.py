"""Utilities of recorded games: chapter 3 with the time-utilities of chapter 4 (section 1.3).

    robots = robot_utilities(conflicts, alpha=1.0, beta=1.0)   # u_i^m, U_i, W_i of every robot
    swarms = utilities_by_swarm(robots)                        # U_Sk, SUD of every swarm

`conflicts` has the columns of ``conflicts.parquet``, with ``seen``: `read_conflicts(directory, seen=True)` or
``pandas.DataFrame(model.tables()["conflicts"])``. The column ``run`` is optional.

A conflict that robot i begins is an interaction with all robots that its active sensors read at the start
(column ``seen``): n_k robots of its own swarm, n_m robots of each other swarm. It lasts until i begins its
next conflict. T(a_i) and T(p_i) are the times of i; T(a_j) and T(p_j) are the seconds that robot j spends in
A and in P during that interval, whether or not j notices i. Then

* u_i^k is Eq. 4.2. The seen robots of swarm k get no utility from this conflict.
* u_i^m is Eq. 4.5. Each seen opponent j gets −1 times its term, Eq. 4.3, by Eq. 3.1. So the utilities of two
  swarms from each other sum to zero. If both robots begin a conflict, both conflicts count.
* W_i is Eq. 4.14, summed over the conflicts that i begins.

α and β are positive numbers: one for all swarms, one for each swarm (``{1: …, 2: …}``), or one for each pair
of swarm and opponent's swarm (``{(1, 1): …, (1, 2): …, …}``). For robot i the pair is its swarm and the swarm
of the robot it meets; for every other robot, its swarm and the swarm of i.

A robot without conflicts that no robot sees has no row; its utilities are 0. The rest of an action that began
before the measured game counts as program time.
"""

import math
from collections.abc import Mapping, Sequence
from numbers import Real
from typing import Any, Final

import numpy as np
import pandas as pd

from kswarms.agents.common.errors import InputError
from kswarms.agents.theory import swarms as theory
from kswarms.agents.theory.times import (
    Interaction,
    approximate_wlu,
    inter_utility,
    intra_utility,
    pair_utility,
)
from kswarms.analysis.results.tables import check_frame

Weights = float | Mapping[int, float] | Mapping[tuple[int, int], float]
"""α or β: for all, by swarm, or by (swarm, opponent's swarm); swarms from 1."""

COLUMNS: Final = ("phase", "robot", "swarm", "opponent_swarm", "start", "seen", "t_a", "t_p")
"""Required columns of a table of conflicts."""


def robot_utilities(
    conflicts: pd.DataFrame, alpha: Weights = 1.0, beta: Weights = 1.0, phase: str = "game"
) -> pd.DataFrame:
    """Return the utilities of every robot over its game (Eqs. 3.1, 3.3, 4.2, 4.3, 4.5, 4.14).

    Parameters
    ----------
    conflicts : pandas.DataFrame
        Conflicts of one game, or of several with the column ``run``.
    alpha, beta : float, or mapping of int or of (int, int) to float
        Weights of the seconds in A (α) and in P (β).
    phase : {'game', 'learning'}
        Phase of the game.

    Returns
    -------
    pandas.DataFrame
        One row for each robot that began a conflict or was seen in one, sorted by number: ``run`` (if given),
        ``robot``, ``swarm`` (from 1), ``conflicts`` (number it began), ``u_1`` … ``u_K`` (u_i^m), ``utility``
        (U_i) and ``wlu`` (W_i), in weighted seconds. K is the largest number of swarms of any game; u_m is 0
        if a game has no swarm m.

    Raises
    ------
    InputError
        A column is missing, the phase has no conflicts, or a weight is missing or not positive.
    """
    rows = _phase_conflicts(conflicts, phase)
    if "run" not in rows.columns:
        return _game_utilities(rows, alpha, beta)
    games = {run: _game_utilities(game, alpha, beta) for run, game in rows.groupby("run", sort=False)}
    widest = max(games.values(), key=lambda table: len(table.columns))
    together = pd.concat(games, names=["run", None]).reset_index("run")[["run", *widest]]
    return together.fillna(0.0).reset_index(drop=True)


def utilities_by_swarm(robots: pd.DataFrame) -> pd.DataFrame:
    """Return U_Sk and SUD_k of every swarm (Eqs. 3.5, 3.7), from rows of `robot_utilities`.

    One row for each swarm: ``run`` (if given), ``swarm``, ``utility`` (U_Sk) and ``sud`` (SUD_k), in weighted
    seconds.
    """
    games = robots.groupby("run", sort=False) if "run" in robots.columns else [(None, robots)]
    parts = []
    for run, game in games:
        swarms = sorted(set(game["swarm"]))
        totals = theory.swarm_utilities(
            game["utility"], [swarms.index(k) for k in game["swarm"]], len(swarms)
        ).tolist()
        sud = [theory.swarm_utility_difference(totals, k) for k in range(len(swarms))]
        part = pd.DataFrame({"swarm": swarms, "utility": totals, "sud": sud})
        if run is not None:
            part.insert(0, "run", run)
        parts.append(part)
    return pd.concat(parts, ignore_index=True)


def _phase_conflicts(conflicts: pd.DataFrame, phase: str) -> pd.DataFrame:
    """Return the conflicts of a phase."""
    conflicts = check_frame(conflicts, "conflicts", COLUMNS)
    rows = conflicts[conflicts["phase"] == phase]
    if rows.empty:
        known = ", ".join(map(str, dict.fromkeys(conflicts["phase"]))) or "none"
        raise InputError("phase", phase, f"must be a phase with conflicts: {known}")
    return rows


def _game_utilities(rows: pd.DataFrame, alpha: Weights, beta: Weights) -> pd.DataFrame:
    """Return `robot_utilities` of one game; swarms are counted from 0 inside, conflicts by row."""
    seen = [[[int(j) for j in robots] for robots in each] for each in rows["seen"]]
    swarms = len(seen[0])
    named = [*rows["swarm"], *rows["opponent_swarm"]]
    if any(len(each) != swarms for each in seen) or not all(1 <= k <= swarms for k in named):
        raise InputError("conflicts column seen", swarms, "must have a list for each swarm in every row")
    swarm_of = {j: m for each in seen for m, robots in enumerate(each) for j in robots}
    swarm_of |= {int(i): int(k) - 1 for i, k in zip(rows["robot"], rows["swarm"], strict=True)}
    weights = _by_pair("alpha", alpha, swarms), _by_pair("beta", beta, swarms)
    spent = _times_of_seen(rows, seen)
    u = {robot: [0.0] * swarms for robot in swarm_of}
    wlu = dict.fromkeys(swarm_of, 0.0)
    columns = [rows[name].tolist() for name in ("robot", "opponent_swarm", "t_a", "t_p")]
    for c, (i, met, t_a, t_p) in enumerate(zip(*columns, strict=True)):
        k = swarm_of[i]
        own = Interaction(t_a, t_p, *(weight[k][met - 1] for weight in weights))
        others = [
            [Interaction(*spent[c, j], *(weight[m][k] for weight in weights)) for j in robots]
            for m, robots in enumerate(seen[c])
        ]
        for m, swarm in enumerate(others):
            if m == k:
                u[i][k] += intra_utility(len(swarm), *own)
                continue
            u[i][m] += inter_utility(own, swarm)
            for j, other in zip(seen[c][m], swarm, strict=True):
                u[j][k] += theory.opponents_utility(pair_utility(own, other))
        opponents = [other for m, swarm in enumerate(others) if m != k for other in swarm]
        wlu[i] += approximate_wlu(own, others[k], opponents)
    began = rows["robot"].value_counts()
    robots = sorted(swarm_of)
    by_swarm = np.array([u[robot] for robot in robots])
    table = pd.DataFrame({"robot": robots, "swarm": [swarm_of[robot] + 1 for robot in robots]})
    table["conflicts"] = began.reindex(robots, fill_value=0).to_numpy()
    for m in range(swarms):
        table[f"u_{m + 1}"] = by_swarm[:, m]
    table["utility"] = theory.player_utilities(by_swarm)
    table["wlu"] = [wlu[robot] for robot in robots]
    return table


def _times_of_seen(
    rows: pd.DataFrame, seen: Sequence[Sequence[Sequence[int]]]
) -> dict[tuple[int, int], tuple[float, float]]:
    """Return the seconds in A and in P of each robot seen in each conflict, by (conflict, robot)."""
    start = rows["start"].to_numpy(float)
    action = rows["t_a"].to_numpy(float)
    end = start + action + rows["t_p"].to_numpy(float)
    pairs = [(c, j) for c, each in enumerate(seen) for robots in each for j in robots]
    conflict, robot = np.array(pairs, dtype=int).reshape(-1, 2).T
    t_a = np.zeros(len(pairs))
    for j, own in rows.reset_index(drop=True).groupby("robot"):
        order = own.sort_values("start").index
        # Cumulative seconds in A: they rise within actions and are constant between actions.
        instants = np.column_stack([start[order], start[order] + action[order]]).ravel()
        total = np.cumsum(np.column_stack([np.zeros(len(order)), action[order]]).ravel())
        # Rounding can put the end of an action after the start of the next one.
        instants = np.maximum.accumulate(instants)
        of_j = robot == j
        until_end, until_start = (np.interp(t[conflict[of_j]], instants, total) for t in (end, start))
        t_a[of_j] = until_end - until_start
    t_a = t_a.round(9)
    t_p = np.maximum(0.0, ((end - start)[conflict] - t_a).round(9))
    return dict(zip(pairs, zip(t_a.tolist(), t_p.tolist(), strict=True), strict=True))


def _by_pair(name: str, given: Weights, swarms: int) -> list[list[float]]:
    """Return the weight of each swarm (row) against each swarm (column), both counted from 0."""
    ids = range(1, swarms + 1)
    return [[_weight(name, given, k, m) for m in ids] for k in ids]


def _weight(name: str, given: Weights, swarm: int, opponent: int) -> float:
    found: object = given
    if isinstance(given, Mapping):
        either: Mapping[Any, float] = given
        found = either.get((swarm, opponent), either.get(swarm))
    if not isinstance(found, Real) or not 0 < float(found) < math.inf:
        raise InputError(f"{name} of swarm {swarm} against {opponent}", found, "must be a number > 0")
    return float(found)
