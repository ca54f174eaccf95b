"""Synthetic rows of result tables."""

import math
from collections.abc import Iterable
from typing import Any

import pandas as pd

DENSITIES = (6, 16, 26)


def runs_of(
    scenario: str,
    swarms: Iterable[int] = (1, 2),
    conditions: Iterable[str] = ("",),
    densities: Iterable[int] = DENSITIES,
    seeds: int = 4,
) -> pd.DataFrame:
    """Return runs in which swarm k deposits 10 k + n + 100 (index of the condition) ± 1 pucks."""
    names = ("avoid", "attack", "aggressive")
    return pd.DataFrame(
        {"run": f"{condition}-{n}-{seed}", "scenario": scenario, "condition": condition, "n": n, "seed": seed}
        | {"swarm": swarm, "size": n // 2, "policy": names[swarm - 1]}
        | {"pucks": 100 * index + 10 * swarm + n + (-1) ** seed, "sud": 100 * index - 10 * swarm + n}
        | {"t_a_intra": 10.0 * swarm, "t_a_inter": 20.0 * swarm, "t_p": 400.0 - 30.0 * swarm}
        | {"conflicts_intra": 5, "conflicts_inter": 6, "duration": 600.0, "ended": "time"}
        for index, condition in enumerate(conditions)
        for n in densities
        for seed in range(seeds)
        for swarm in swarms
    )


SWARM = {0: 1, 1: 1, 2: 2, 3: 2, 4: 1, 5: 2}


def conflict(robot: int, opponent: int, start: float, t_a: float = 2.0, **rest: Any) -> dict[str, Any]:
    row = {"run": "a", "phase": "game", "robot": robot, "swarm": SWARM[robot]}
    row |= {"opponent": opponent, "opponent_swarm": SWARM[opponent], "start": start, "x": 0.0, "y": 0.0}
    row |= {"action": "flight", "t_a": t_a, "t_p": 1.0, "active": 3, "reward": math.nan, "q": math.nan}
    return row | rest


_MET = [(0, 2, 0.0, 2.0), (2, 0, 1.0, 3.0), (0, 1, 3.0, 1.0), (2, 3, 8.0, 2.0)]
MET = pd.DataFrame([conflict(*each) for each in _MET])


def robots(runs: tuple[str, ...] = ("a",)) -> pd.DataFrame:
    def arms(fight: float | None, flight: float) -> list[dict[str, Any]]:
        arm = {"opponent": 1, "reward": 1.0, "time": 1.0, "count": 1.0}
        return [arm | {"action": "flight", "q": flight}, arm | {"action": "fight", "q": fight}]

    of_robots = [(0, 1, []), (2, 2, arms(0.2, 0.1)), (3, 2, arms(None, 0.3))]
    return pd.DataFrame(
        {"run": run, "robot": robot, "swarm": swarm, "policy": "p"}
        | {"pucks": 0, "t_a": 0.0, "t_p": 0.0, "arms": arms}
        for run in runs
        for robot, swarm, arms in of_robots
    )


def learning_conflicts() -> pd.DataFrame:
    """Return conflicts. Robot 2 fights S1 from 10 s on, with Q up to 1.9; robot 3 never does."""
    rows = [conflict(0, 2, 0.0, phase="learning", action="fight")]
    for second in range(20):
        late = {"action": "fight", "q": second / 10} if second >= 10 else {"q": 0.1}
        rows.append(conflict(2, 0, second, phase="learning", **late))
        rows.append(conflict(3, 1, second, phase="learning", q=0.5))
    rows.append(conflict(3, 2, 5.5, phase="learning", action="fight"))  # S2 has no bandit for it
    rows.append(conflict(2, 0, 25.0))  # the measured game
    return pd.DataFrame(rows)


PLACED = pd.DataFrame(
    [
        conflict(0, 2, 0, x=-0.99, y=-0.99),
        conflict(0, 2, 1, x=-0.99, y=-0.99, action="fight"),
        conflict(0, 2, 2, x=0.99, y=-0.99, run="b"),
        conflict(0, 2, 3, x=0.99, y=0.42, run="b"),
    ]
)
