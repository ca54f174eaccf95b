"""Emergence of policies: choices and values Q over the learning time, and arms of each robot at the end.

Choices and values come from the conflicts of one game: rows of `conflicts.parquet`, or
`model.datacollector.get_table_dataframe("conflicts")`. The arms come from rows of `robots.parquet`.
"""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from kswarms.agents.common.errors import InputError
from kswarms.analysis.results.tables import check_frame

BINS = 40
"""Number of time intervals in the learning phase."""
BANDIT = ["swarm", "opponent_swarm"]
"""Columns that identify a bandit: a learning swarm and its opponent."""


def learning_conflicts(conflicts: pd.DataFrame) -> pd.DataFrame:
    """Return conflicts of the learning phase decided by a bandit; `InputError` if no swarm learned."""
    conflicts = check_frame(conflicts, "conflicts", [*BANDIT, "phase", "robot", "start", "action", "q"])
    learned = conflicts[conflicts["q"].notna()]
    if "learning" not in set(learned["phase"]):
        rule = "must be of the learning phase of a game with a learner"
        raise InputError("conflicts", "no row with a Q", rule)
    bandits = pd.MultiIndex.from_frame(learned[BANDIT].drop_duplicates())
    decided = pd.MultiIndex.from_frame(conflicts[BANDIT]).isin(bandits)
    return conflicts[decided & (conflicts["phase"] == "learning")]


def choices(conflicts: pd.DataFrame, by: Sequence[str] = ()) -> pd.DataFrame:
    """Return the share of each action in the choices of learners over the learning time of one game.

    `by` lists further columns to group by, such as ``robot``. The result has one row for each `swarm`,
    `opponent_swarm` (int64), column of `by`, `time` (float64, s: middle of one of `BINS` intervals) and
    `action` (str), with its `share` (float64) of the conflicts. Intervals without conflicts have no row.
    `InputError` if no swarm learned.
    """
    rows = learning_conflicts(conflicts)
    rows = rows.assign(time=_middles(rows["start"]))
    key = [*BANDIT, *by, "time"]
    counts = rows.groupby([*key, "action"]).size().unstack(fill_value=0)
    shares = counts.div(counts.sum(axis=1), axis=0)
    return shares.reset_index().melt(key, var_name="action", value_name="share")


def arm_values(conflicts: pd.DataFrame) -> pd.DataFrame:
    """Return Q of each learner's arms over the learning time (Eq. 4.15); `InputError` if no swarm learned.

    The result has one row for each `swarm`, `opponent_swarm`, `robot` (int64), `action` (str) and `time`
    (float64, s: middle of one of `BINS` intervals), with the latest `q` (float64, reward per second). An arm
    has no row before its first trial.
    """
    rows = learning_conflicts(conflicts).dropna(subset="q").sort_values("start")
    rows = rows.assign(time=_middles(rows["start"]))
    arms = [*BANDIT, "robot", "action"]
    last = rows.groupby([*arms, "time"])["q"].last().unstack("time").ffill(axis=1)
    return last.reset_index().melt(arms, var_name="time", value_name="q").dropna(subset="q")


def _middles(start: pd.Series) -> np.ndarray:
    """Return the middle of the time interval that contains each start (s)."""
    edges = np.linspace(0, start.max() * (1 + 1e-9), BINS + 1)
    bins = np.clip(np.digitize(start, edges) - 1, 0, BINS - 1)
    return (edges[bins] + edges[bins + 1]) / 2


def preferences(robots: pd.DataFrame) -> pd.DataFrame:
    """Return the arms of each learner at the end, from `robots.parquet`; `InputError` if none tried one.

    The result has one row for each `run` (if given), `swarm`, `opponent_swarm`, `robot` (int64) and tried
    `action` (str), with `q` (float64, reward per second) and `learned` (bool): whether it is the best action.
    """
    robots = check_frame(robots, "robots", ["swarm", "robot", "arms"])
    keys = [name for name in ("run", "swarm", "robot") if name in robots]
    arms = robots[[*keys, "arms"]].explode("arms").dropna(subset="arms").reset_index(drop=True)
    fields = pd.DataFrame(arms["arms"].tolist(), columns=["opponent", "action", "q"])
    rows = pd.concat([arms[keys], fields.rename(columns={"opponent": "opponent_swarm"})], axis=1)
    rows = rows.dropna(subset="q")
    if rows.empty:
        raise InputError("robots", "no arms", "must be of a game with a learner that tried an action")
    best = rows.groupby([*keys, "opponent_swarm"])["q"].transform("max")
    return rows.assign(learned=rows["q"] == best)
