"""Contributions of robots to their swarm, compared with their rewards (docs/contribution.md).

The contribution of a robot to a game is the SUD of its swarm minus the SUD in the same game without the
robot. The functions take rows of `contribution.parquet` of one scenario, condition, N and kind of absence.
"""

from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from kswarms.agents.common.errors import InputError
from kswarms.agents.theory.swarms import swarm_utility_difference
from kswarms.analysis.measures.utilities import COLUMNS, robot_utilities, utilities_by_swarm
from kswarms.analysis.results.tables import check_frame
from kswarms.analysis.statistics.curves import spearman
from kswarms.analysis.statistics.intervals import Interval, bootstrap_interval
from kswarms.analysis.statistics.means import mean_by_group

Floats = NDArray[np.float64]

_MIN_ROBOTS: Final = 3
"""Minimum number of robots for a rank correlation."""

_SELECTION: Final = ("scenario", "condition", "n", "absent_from")
MEASURES: Final = {"pucks": "pucks", "time": "s"}
"""Kinds of SUD and their units."""
QUANTITIES: Final = (*MEASURES, "reward", "reward_rate")
"""Quantities of a robot: contributions, reward in a game (s), reward per second."""
OTHERS: Final = ("mates", "opponents")
"""Other robots: in the same swarm, and in other swarms."""
_TIMES: Final = ("t_a", "t_a_without", "t_p", "t_p_without")


def time_sud(conflicts: Mapping[str, Sequence[Any]], swarms: int) -> list[float]:
    """Return the SUD in time-utility (s) of each swarm of a game (Eq. 3.7 with 4.2 to 4.6, α = β = 1).

    `conflicts` has the columns of ``conflicts.parquet``; conflicts of the learning phase are ignored.
    """
    table = pd.DataFrame({name: conflicts[name] for name in COLUMNS})
    table = table[table["phase"] == "game"]
    utilities = [0.0] * swarms  # a swarm without conflicts has no row
    if not table.empty:
        of_swarms = utilities_by_swarm(robot_utilities(table))
        for swarm, utility in zip(of_swarms["swarm"], of_swarms["utility"], strict=True):
            utilities[swarm - 1] = utility
    return [swarm_utility_difference(utilities, swarm) for swarm in range(swarms)]


def select_contributions(rows: pd.DataFrame, **selection: object) -> pd.DataFrame:
    """Return the rows of one scenario, condition, N and kind of absence, with the contributions.

    Parameters
    ----------
    rows : pandas.DataFrame
        Rows of `contribution.parquet`.
    **selection
        Values of `scenario`, `condition`, `n`, `absent_from`; required for columns with several values.

    Returns
    -------
    pandas.DataFrame
        The columns of `rows`, and: `pucks` and `time` (s), the contributions to SUD; `reward_rate`, reward
        per second of conflicts and following program time (Eq. 4.15), NaN without conflicts.
    """
    rows = check_frame(rows, "contribution")
    for name, value in selection.items():
        if name not in _SELECTION:
            raise InputError(name, value, f"unknown column; allowed: {', '.join(_SELECTION)}")
        if value not in set(rows[name]):
            raise InputError(name, value, f"must be one of {', '.join(map(repr, sorted(set(rows[name]))))}")
        rows = rows[rows[name] == value]
    for name in _SELECTION:
        values = sorted(set(rows[name]))
        if not values:
            raise InputError("contribution", "no rows", "must hold at least one row")
        if len(values) != 1:
            raise InputError(name, selection.get(name), f"must be one of {', '.join(map(repr, values))}")
    rows = rows.reset_index(drop=True)
    return rows.assign(
        pucks=(rows["sud"] - rows["sud_without"]).astype(float),
        time=rows["time_sud"] - rows["time_sud_without"],
        reward_rate=rows["reward"] / rows["reward_time"].where(rows["reward_time"] > 0),
    )


def measures_with_values(rows: pd.DataFrame) -> list[str]:
    """Return the keys of `MEASURES` with at least one value."""
    return [measure for measure in MEASURES if rows[measure].notna().any()]


def mean_contributions(rows: pd.DataFrame) -> pd.DataFrame:
    """Return means over the seeds for each robot, and for the mean robot of each swarm.

    `rows` come from `select_contributions`. The result has one row for each `swarm` and `robot`, then one row
    with robot −1 for the mean robot of each swarm. Columns are `seeds`, and for each of `QUANTITIES` its mean
    (column of the same name) and 95 % interval (``…_low``, ``…_high``; NaN for fewer than six seeds).
    """
    key = ["swarm", "robot"]
    mean_robot = rows.groupby(["swarm", "seed"])[list(QUANTITIES)].mean().reset_index().assign(robot=-1)
    both = pd.concat([rows, mean_robot])
    table = both.groupby(key).agg(seeds=("seed", "nunique"))
    for quantity in QUANTITIES:
        columns = mean_by_group(both, key, quantity).set_index(key)
        for suffix, name in (("", "mean"), ("_low", "low"), ("_high", "high")):
            table[f"{quantity}{suffix}"] = columns[name]
    return table.reset_index().sort_values(key, key=lambda column: column.where(column >= 0, np.inf))


def rank_correlations(rows: pd.DataFrame) -> pd.DataFrame:
    """Return rank correlations of reward and contribution in each swarm, from rows of `select_contributions`.

    Returns
    -------
    pandas.DataFrame
        One row for each `swarm` of at least three robots and each `measure`, with Spearman's ρ and its 95 %
        interval. ``robots``, ``…_low``, ``…_high``: ρ of the robots' means over the seeds. ``games``,
        ``…_low``, ``…_high``: ρ within a game, averaged over the games. ρ is NaN if all robots have the same
        value; the bounds are NaN for fewer than six seeds.
    """
    table = []
    for swarm, of_swarm in rows.groupby("swarm"):
        reward = _by_seed(of_swarm, "reward")
        for measure in measures_with_values(rows) if reward.shape[1] >= _MIN_ROBOTS else ():
            contribution = _by_seed(of_swarm, measure)
            both = np.stack([reward, contribution], axis=-1)
            in_games = spearman(reward, contribution)
            of_means = bootstrap_interval(
                both, lambda means: spearman(means[..., 0], means[..., 1]), smooth=False
            )
            in_games = in_games[~np.isnan(in_games)]
            of_games = bootstrap_interval(in_games) if len(in_games) else Interval(np.nan, np.nan, np.nan)
            table.append((swarm, measure, *_finite(of_means), *_finite(of_games)))
    columns = ("robots", "robots_low", "robots_high", "games", "games_low", "games_high")
    return pd.DataFrame(table, columns=["swarm", "measure", *columns])


def freed_time(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the share of conflict time with a robot that becomes program time if the robot is absent.

    The source assumes a share of 1 (Eqs. 4.9 to 4.11). Times without the robot are scaled to the
    duration of the game with it; durations differ only if a number of pucks ends the game.

    Returns
    -------
    pandas.DataFrame
        One row for each `swarm` of the robot and kind of `others` (`OTHERS`). Times are seconds per game,
        summed over the others and averaged over robots and seeds:

        * `t_a`, `t_a_without`, `t_p`, `t_p_without`: T(a) and T(p) with and without the robot;
        * `met`: T(a) in the others' conflicts with the robot;
        * `share`, `share_low`, `share_high`: (t_a − t_a_without) / met with its 95 % interval. It is 1 if the
          assumption holds, 0 if other conflicts replace these, NaN if no robot met the robot.
    """
    table = []
    for swarm, of_swarm in rows.groupby("swarm"):
        scale = of_swarm["duration"] / of_swarm["duration_without"]
        for others in OTHERS:
            times = of_swarm[[f"{others}_{name}" for name in (*_TIMES, "t_a_met")]]
            times = times.set_axis([*_TIMES, "met"], axis=1)
            without = ["t_a_without", "t_p_without"]
            times[without] = times[without].mul(scale, axis=0)
            if (times["t_a"] + times["t_p"] == 0).all():
                continue  # the game has no such robots
            of_seeds = times.groupby(of_swarm["seed"]).mean().to_numpy()
            share, low, high = _finite(bootstrap_interval(of_seeds, _share))
            found: dict[str, Any] = {"swarm": swarm, "others": others, **times.mean()}
            table.append(found | {"share": share, "share_low": low, "share_high": high})
    return pd.DataFrame(table)


def _share(means: Floats) -> Floats:
    """Return `share` of `freed_time` from means of its five time columns, shape (resamples, 5)."""
    t_a, t_a_without, _, _, met = means.T
    share: Floats = np.divide(t_a - t_a_without, met, out=np.full_like(met, np.nan), where=met > 0)
    return share


def _by_seed(rows: pd.DataFrame, quantity: str) -> Floats:
    """Return a quantity as an array of shape (seeds, robots)."""
    table: Floats = rows.pivot(index="seed", columns="robot", values=quantity).to_numpy()
    return table


def _finite(interval: Interval) -> tuple[float, float, float]:
    """Return estimate and bounds; infinite bounds (too few seeds) become NaN."""
    if np.isinf(interval.low):
        return interval.estimate, np.nan, np.nan
    return interval.estimate, interval.low, interval.high
