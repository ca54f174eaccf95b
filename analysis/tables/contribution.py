"""Text tables of contributions: means of robots, rank correlations, and freed time."""

from collections.abc import Mapping
from typing import Any

import pandas as pd

from kswarms.analysis.measures import contribution
from kswarms.analysis.statistics.means import describe_seeds
from kswarms.analysis.text_tables import with_interval


def contribution_tables(rows: pd.DataFrame) -> list[tuple[str, list[list[str]]]]:
    """Return the tables that `kswarms contribution` prints, from rows of `select_contributions`.

    Each table is a pair of a title and rows of cells; the first row is the header.
    """
    seeds = rows["seed"].nunique()
    by_robot = [["robot", "swarm", "SUD (pucks)", "SUD (s)", "reward (s)", "reward per second"]]
    for found in contribution.mean_contributions(rows).to_dict("records"):
        robot = f"mean of S{found['swarm']}" if found["robot"] < 0 else str(found["robot"])
        forms = zip(contribution.QUANTITIES, (".2f", ".1f", ".1f", ".3f"), strict=True)
        by_robot.append([robot, f"S{found['swarm']}", *(estimate_text(found, *each) for each in forms)])
    ranks = [["swarm", "contribution to SUD in", "of robots' means", "within a game"]]
    for found in contribution.rank_correlations(rows).to_dict("records"):
        cells = (estimate_text(found, name) for name in ("robots", "games"))
        ranks.append([f"S{found['swarm']}", contribution.MEASURES[found["measure"]], *cells])
    freed = [["robot of", "others", "T(a)", "without", "T(p)", "without", "T(a) against it", "share freed"]]
    for found in contribution.freed_time(rows).to_dict("records"):
        times = (f"{found[name]:.1f}" for name in ("t_a", "t_a_without", "t_p", "t_p_without", "met"))
        freed.append([f"S{found['swarm']}", found["others"], *times, estimate_text(found, "share")])
    return [
        (f"contribution and reward of each robot: {describe_seeds(seeds, seeds)}", by_robot),
        ("rank correlation of reward and contribution (95 % interval)", ranks),
        ("seconds of other robots in a game, with and without the robot", freed),
    ]


def estimate_text(found: Mapping[Any, Any], name: str, form: str = ".2f") -> str:
    """Format a number with its interval, from the columns `name`, ``…_low`` and ``…_high``."""
    return with_interval(found[name], found[f"{name}_low"], found[f"{name}_high"], form)
