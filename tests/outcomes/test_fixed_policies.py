"""What the source found for fixed policies (specification, section 3.4, figures 6.1 to 6.3), on our seeds."""

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from scenarios.catalogue import CATALOGUE
from scenarios.runner import play_all
from scenarios.runs import expand

pytestmark = pytest.mark.slow

FEW = pytest.param((6, 16, 50), 8, id="few")
WHOLE = pytest.param((6, 10, 16, 20, 26, 30, 36, 40, 46, 50), 20, id="whole", marks=pytest.mark.full)


def play(scenario: str, densities: tuple[int, ...], seeds: int) -> pd.DataFrame:
    """Return one row for each (density, seed): results of S1 and S2 in columns ``name_1``, ``name_2``."""
    planned = CATALOGUE[scenario].replace(densities=densities, seeds=seeds)
    rows = []
    for run, outcome in play_all(expand([planned]), jobs=2):
        row = {"n": run.n, "seed": run.seed}
        for swarm in outcome.swarms:
            row |= {f"{name}_{swarm['swarm']}": value for name, value in swarm.items()}
        rows.append(row)
    return pd.DataFrame(rows).set_index(["n", "seed"]).sort_index()


def interval(values: pd.Series) -> tuple[float, float]:
    """Return the 95 % interval of the mean (Student's t)."""
    if values.std() == 0:
        return float(values.mean()), float(values.mean())
    low, high = stats.t.interval(0.95, len(values) - 1, values.mean(), stats.sem(values))
    return float(low), float(high)


def test_an_interval_leaves_zero_out_only_if_the_values_do() -> None:
    draws = np.random.default_rng(1).normal(size=50)
    assert interval(pd.Series(draws + 1))[0] > 0
    assert interval(pd.Series(draws - draws.mean()))[0] < 0


@pytest.mark.parametrize(("densities", "seeds"), [FEW, WHOLE])
def test_scores_of_avoid_and_attack(densities: tuple[int, ...], seeds: int) -> None:
    avoid, attack, mixed = (play(f"fig-6.1{letter}", densities, seeds) for letter in "abc")
    totals = pd.DataFrame(
        {name: games.pucks_1 + games.pucks_2 for name, games in [("a", avoid), ("b", attack), ("c", mixed)]}
    )

    # 6.1a: both score alike (summed over the densities), and the total rises with N, then falls.
    low, high = interval((avoid.pucks_1 - avoid.pucks_2).groupby("seed").sum())
    assert low <= 0 <= high
    peak = totals.a.groupby("n").mean().idxmax()
    assert interval(totals.a.loc[peak] - totals.a.loc[densities[0]])[0] > 0
    assert interval(totals.a.loc[peak] - totals.a.loc[densities[-1]])[0] > 0

    # 6.1b: the lowest scores of all three at every N.
    for n in densities:
        assert interval((totals.a - totals.b).loc[n])[0] > 0
        assert interval((totals.c - totals.b).loc[n])[0] > 0

    # 6.1c: attack scores more at high N; together, summed over the densities, they score more than in 6.1a.
    assert interval((mixed.pucks_2 - mixed.pucks_1).loc[densities[-1]])[0] > 0
    assert interval((totals.c - totals.a).groupby("seed").sum())[0] > 0


@pytest.mark.parametrize(("densities", "seeds"), [FEW, WHOLE])
def test_attackers_spend_the_larger_share_of_time_in_conflict(densities: tuple[int, ...], seeds: int) -> None:
    games = play("fig-6.3", densities, seeds)
    assert (games.ended_1 == "pucks").all()
    assert (games.pucks_1 + games.pucks_2 == 50).all()
    shares = {
        k: (games[f"t_a_intra_{k}"] + games[f"t_a_inter_{k}"])
        / (games[f"t_a_intra_{k}"] + games[f"t_a_inter_{k}"] + games[f"t_p_{k}"])
        for k in (1, 2)
    }
    for n in densities:
        assert interval((shares[2] - shares[1]).loc[n])[0] > 0
        # Most of it between the swarms.
        assert interval((games.t_a_inter_2 - games.t_a_intra_2).loc[n])[0] > 0
