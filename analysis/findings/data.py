"""From result tables to samples: one value of a quantity for each seed and density."""

from collections.abc import Iterable, Sequence

import numpy as np
import pandas as pd

from kswarms.agents.common.errors import InputError
from kswarms.analysis.findings.claims import LEARNED, Claim, Quantity
from kswarms.analysis.results.runs import Results

_TIMES = ["t_a_intra", "t_a_inter", "t_p"]
_COUNTS = ["pucks", "conflicts_intra", "conflicts_inter", "size"]


class NoDataError(Exception):
    """What a claim is about has not been played; the message says what."""


class Data:
    """The samples that a claim is about, and the densities at which it can be judged."""

    def __init__(self, claim: Claim, results: Results) -> None:
        self.results = results
        self.tables = [sample(results, quantity) for quantity in claim.quantities]
        missing = [
            _named(quantity)
            for quantity, table in zip(claim.quantities, self.tables, strict=True)
            if table.empty
        ]
        if missing:
            raise NoDataError(f"no runs of {', '.join(dict.fromkeys(missing))}")
        played = shared_densities(self.tables)
        self.densities = [n for n in claim.densities or played if n in played]
        if not self.densities:
            wanted = listed(claim.densities) if claim.densities else "the same N"
            raise NoDataError(f"nothing played at {wanted}")
        absent = [n for n in claim.densities if n not in played]
        self.notes = [listed(self.densities), f"without {listed(absent)}" if absent else ""]

    def complete(self) -> list[pd.DataFrame]:
        """Return the tables at all densities, on the seeds that have been played at each."""
        tables = complete(self.tables, self.densities)
        if tables[0].empty:
            raise NoDataError(f"no seed has been played at all of {listed(self.densities)}")
        return tables


def sample(results: Results, quantity: Quantity) -> pd.DataFrame:
    """Return a quantity by seed (rows) and N (columns), float64 in its unit.

    Parameters
    ----------
    results : Results
        Where it is looked up.
    quantity : Quantity
        What is looked up.

    Returns
    -------
    pandas.DataFrame
        Rows and columns ascend; NaN where a density has not been played with a seed; empty if there is
        nothing of the quantity at all.

    Raises
    ------
    InputError
        A game has several values: the same rows twice, or several opponents and none named.
    """
    values = _learned(results, quantity) if quantity.measure in LEARNED else _measured(results, quantity)
    return _spread(values)


def sizes(results: Results, quantity: Quantity) -> pd.DataFrame:
    """Return the number of robots that a quantity is of, by seed and N, as `sample` does."""
    return _spread(_summed(results, quantity)["size"])


def complete(tables: Sequence[pd.DataFrame], densities: Sequence[int]) -> list[pd.DataFrame]:
    """Cut tables of `sample` to what all of them have: these densities, and the seeds that no gap is in.

    Parameters
    ----------
    tables : sequence of pandas.DataFrame
        Seeds by densities.
    densities : sequence of int
        Columns wanted, which each table has.
    """
    cut = [table[list(densities)].dropna() for table in tables]
    seeds = cut[0].index
    for table in cut[1:]:
        seeds = seeds.intersection(table.index)
    return [table.loc[seeds] for table in cut]


def shared_densities(tables: Sequence[pd.DataFrame]) -> list[int]:
    """Return the densities that all tables have, in ascending order."""
    shared = set(tables[0].columns).intersection(*(table.columns for table in tables[1:]))
    return sorted(int(n) for n in shared)


def listed(densities: Iterable[int]) -> str:
    """Return densities as a note names them."""
    return f"N = {', '.join(map(str, densities))}"


def _named(quantity: Quantity) -> str:
    parts = [quantity.scenario]
    parts += [f"condition {quantity.condition!r}"] if quantity.condition else []
    parts += [f"S{quantity.swarm}"] if quantity.swarm else []
    parts += [f"({quantity.measure})"] if quantity.measure in LEARNED else []
    return " ".join(parts)


def _spread(values: pd.Series) -> pd.DataFrame:
    """Turn a series over (n, seed) into seeds by densities."""
    return values.unstack("n").sort_index().sort_index(axis=1).astype(np.float64)


def _of_curve(rows: pd.DataFrame, quantity: Quantity) -> pd.DataFrame:
    mask = (rows["scenario"] == quantity.scenario) & (rows["condition"] == quantity.condition)
    if quantity.swarm is not None:
        mask &= rows["swarm"] == quantity.swarm
    return rows[mask]


def _summed(results: Results, quantity: Quantity) -> pd.DataFrame:
    """Sum what adds up over the swarms asked for, by (n, seed)."""
    rows = _of_curve(results.runs, quantity)
    if rows.duplicated(["n", "seed", "swarm"]).any():
        raise InputError("runs", quantity.scenario, "must have one row for each condition, N, seed and swarm")
    return rows.groupby(["n", "seed"])[[*_TIMES, *_COUNTS, "sud", "duration"]].sum()


def _measured(results: Results, quantity: Quantity) -> pd.Series:
    summed = _summed(results, quantity)
    if not quantity.measure.startswith("time_"):
        return summed[quantity.measure]
    spent = {
        "time_in_conflict": summed["t_a_intra"] + summed["t_a_inter"],
        "time_inter": summed["t_a_inter"],
        "time_intra": summed["t_a_intra"],
    }
    return 100 * spent[quantity.measure] / summed[_TIMES].sum(axis=1)


def _learned(results: Results, quantity: Quantity) -> pd.Series:
    if results.policies is None:
        return pd.Series(dtype=np.float64, index=pd.MultiIndex.from_arrays([[], []], names=["n", "seed"]))
    # The share of attack stands on the row of each action.
    rows = _of_curve(results.policies, quantity).drop_duplicates(["n", "seed", "opponent"])
    within = quantity.measure == "learned_flight_within"
    rows = rows[(rows["opponent"] == rows["swarm"]) == within]
    if quantity.opponent is not None:
        rows = rows[rows["opponent"] == quantity.opponent]
    if rows.duplicated(["n", "seed"]).any():
        opponents = sorted(set(rows["opponent"]))
        raise InputError(
            "opponent",
            quantity.opponent,
            f"must be one of {', '.join(map(str, opponents))} in {quantity.scenario}",
        )
    share = rows.set_index(["n", "seed"])["attack_share"]
    return 100 * (1 - share if within else share)
