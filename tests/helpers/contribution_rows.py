"""Synthetic rows of the table of contributions."""

from typing import Any

import numpy as np
import pandas as pd

SEEDS, ROBOTS = 12, 8


def contribution_rows(
    seeds: int = SEEDS, robots: int = ROBOTS, swarm: int = 2, **columns: Any
) -> pd.DataFrame:
    """Return rows of contributions; columns are arrays of shape (seeds, robots), or the same for all."""
    shape = (seeds, robots)
    seed, robot = (index.ravel() for index in np.indices(shape))
    times = {
        f"{others}_{what}": 100.0
        for others in ("mates", "opponents")
        for what in ("t_a", "t_a_without", "t_p", "t_p_without", "t_a_met")
    }
    question = {"scenario": "fig-6.4b", "condition": "", "n": 16, "absent_from": "game"}
    question |= {"run": "with", "run_without": "without"}
    policy = "inter-learner(rule='greedy')"
    robots_own = {"swarm": swarm, "policy": policy, "reward": 1.0, "reward_time": 10.0}
    suds = {"sud": 0, "sud_without": 0, "time_sud": 0.0, "time_sud_without": 0.0}
    durations = {"duration": 600.0, "duration_without": 600.0}
    plain: dict[str, Any] = {**question, **robots_own, **suds, **durations, **times, **columns}
    filled = {name: np.broadcast_to(values, shape).ravel() for name, values in plain.items()}
    return pd.DataFrame({"seed": seed, "robot": robot + 10 * swarm, **filled})


def noise(size: float = 1.0, seed: int = 0, shape: tuple[int, int] = (SEEDS, ROBOTS)) -> Any:
    return np.random.default_rng(seed).normal(0.0, size, shape)
