"""Synthetic results for which claims hold, fail or are undecided, and the verdicts on them."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from kswarms.analysis.findings import Finding, Verdict, judge
from kswarms.analysis.findings.claims import Claim, Compare
from kswarms.analysis.findings.quantity import Quantity
from kswarms.analysis.results.runs import Results

DENSITIES = (6, 16, 30, 40, 50)
S1, S2 = Quantity(scenario="duel", swarm=1), Quantity(scenario="duel", swarm=2)
LEARNED = Quantity(measure="learned_attack", scenario="fig-6.4a", swarm=2)


def noise(seeds: int, densities: int, scale: float = 1.0, seed: int = 0) -> Any:
    """Return noise of shape (seeds, densities) with mean 0 at each density."""
    draws = np.random.default_rng(seed).normal(scale=scale, size=(seeds, densities))
    return draws - draws.mean(axis=0)


def runs(
    curves: Sequence[Sequence[float]],
    densities: Sequence[int] = DENSITIES,
    seeds: int = 10,
    scenario: str = "duel",
    condition: str = "",
    scale: float = 1.0,
) -> pd.DataFrame:
    """Return runs in which the mean score of swarm k is the k-th curve."""
    rows = []
    for swarm, curve in enumerate(curves, start=1):
        values = np.asarray(curve) + noise(seeds, len(densities), scale, seed=swarm)
        for (seed, column), pucks in np.ndenumerate(values):
            n = densities[column]
            size, lived = n // 2, 600.0 * (n // 2)
            row = {"scenario": scenario, "condition": condition, "n": n, "seed": seed, "swarm": swarm}
            row |= {"size": size, "pucks": pucks, "sud": pucks, "duration": 600.0}
            row |= {"t_a_intra": 0.1 * lived, "t_a_inter": 0.3 * lived, "t_p": 0.6 * lived}
            row |= {"conflicts_intra": 3, "conflicts_inter": 5}
            rows.append(row)
    return pd.DataFrame(rows)


def policies(
    shares: Sequence[float],
    densities: Sequence[int] = DENSITIES,
    seeds: int = 10,
    scenario: str = "fig-6.4a",
    opponent: int = 1,
    scale: float = 0.0,
) -> pd.DataFrame:
    """Return policies of S2 in which these shares of robots learned to attack a swarm."""
    values = np.asarray(shares) + noise(seeds, len(densities), scale)
    rows = [
        {"scenario": scenario, "condition": "", "n": densities[column], "seed": seed, "swarm": 2}
        | {"opponent": opponent, "action": action, "attack_share": share}
        for (seed, column), share in np.ndenumerate(values)
        for action in ("flight", "fight")
    ]
    return pd.DataFrame(rows)


def learners(shares: Sequence[float], **rest: Any) -> Results:
    """Return results of learners: policies and runs."""
    scenario = rest.get("scenario", "fig-6.4a")
    seeds = rest.get("seeds", 10)
    densities = rest.get("densities", DENSITIES)
    level = [0.0] * len(densities)
    return Results(runs([level, level], densities, seeds, scenario), policies(shares, **rest))


def verdict_on(claim: Claim, results: Results, confidence: float = 0.95) -> Verdict:
    """Return the verdict on a claim."""
    return judge(Finding(id="it", statement="It is so.", claim=claim, confidence=confidence), results)


def more(relation: str = ">", over: str = "each N", margin: float = 0.0, **rest: Any) -> Compare:
    """Return the claim that S2 scores more than S1."""
    return Compare(**{"left": S2, "relation": relation, "right": S1, "over": over, "margin": margin, **rest})


LEVEL = [10.0] * 5


def duel(lead: Sequence[float], **rest: Any) -> Results:
    """Return results in which the score of S2 exceeds that of S1 by `lead`."""
    return Results(runs([LEVEL, [10 + each for each in lead]], **rest))


FAR, NEAR, TIE, BEHIND = [5.0] * 5, [0.5] * 5, [0.0] * 5, [-5.0] * 5
MIXED = [5.0, 5.0, 5.0, 5.0, -5.0]
