"""Samples of quantities: one value for each seed and density."""

from collections.abc import Iterable, Sequence

import numpy as np
import pandas as pd

from kswarms.agents.common.errors import InputError
from kswarms.agents.theory.times import share_of_time
from kswarms.analysis.findings.claims import Claim
from kswarms.analysis.findings.quantity import LEARNED, Quantity
from kswarms.analysis.results.runs import Results
from kswarms.analysis.results.tables import check_frame, require_columns
from kswarms.analysis.statistics.intervals import Values

_GAME = ["n", "seed", "swarm"]
_TIMES = ["t_a_intra", "t_a_inter", "t_p"]
_COUNTS = ["pucks", "conflicts_intra", "conflicts_inter", "size"]


class NoDataError(Exception):
    """Results lack games that a claim needs; the message names them."""


class ClaimData:
    """Samples of the quantities of a claim, the common densities, and notes on the densities."""

    def __init__(self, claim: Claim, results: Results) -> None:
        self.results = results
        self.tables = [sample(results, quantity) for quantity in claim.quantities]
        pairs = zip(claim.quantities, self.tables, strict=True)
        missing = [str(quantity) for quantity, table in pairs if table.empty]
        if missing:
            raise NoDataError(f"no runs of {', '.join(dict.fromkeys(missing))}")
        common = set.intersection(*(set(table.columns) for table in self.tables))
        played = sorted(int(n) for n in common)
        self.densities = [n for n in claim.densities or played if n in played]
        if not self.densities:
            where = format_densities(claim.densities) if claim.densities else "the same N"
            raise NoDataError(f"no runs at {where}")
        absent = [n for n in claim.densities if n not in played]
        self.notes = [format_densities(self.densities)]
        self.notes += [f"without {format_densities(absent)}"] if absent else []

    def at(self, densities: Sequence[int]) -> list[pd.DataFrame]:
        """Return the tables at some densities, with the seeds that all tables have at these densities."""
        tables = [table[list(densities)].dropna() for table in self.tables]
        seeds = tables[0].index
        for table in tables[1:]:
            seeds = seeds.intersection(table.index)
        return [table.loc[seeds] for table in tables]

    def complete(self) -> list[pd.DataFrame]:
        """Return the tables at all densities, with the seeds that all tables have at each density."""
        tables = self.at(self.densities)
        if tables[0].empty:
            raise NoDataError(f"no seed with all of {format_densities(self.densities)}")
        return tables


def sample(results: Results, quantity: Quantity) -> pd.DataFrame:
    """Return a quantity by seed (rows) and N (columns), ascending, as float64 in its unit.

    Missing games are NaN; without any games, the table is empty. `InputError` if a game has several values,
    because rows are duplicated, or because there are several opponents and none is given.
    """
    values = _learned_measure if quantity.measure in LEARNED else _run_measure
    return _by_seed(values(results, quantity))


def sizes(results: Results, quantity: Quantity) -> pd.DataFrame:
    """Return the number of robots in the swarms of a quantity, by seed and N."""
    return _by_seed(_sum_swarms(results, quantity)["size"])


def difference(tables: Sequence[pd.DataFrame]) -> Values:
    """Return the first table − the second, or the only table; shape (seeds, densities)."""
    left, *right = (table.to_numpy(dtype=np.float64) for table in tables)
    return left - right[0] if right else left


def format_densities(densities: Iterable[int]) -> str:
    """Format densities for a note."""
    return f"N = {', '.join(map(str, densities))}"


def _by_seed(values: pd.Series) -> pd.DataFrame:
    """Return a series over (n, seed) as a table of seeds (rows) and densities (columns)."""
    return values.unstack("n").sort_index().sort_index(axis=1).astype(np.float64)


def _select_curve(rows: pd.DataFrame, quantity: Quantity, columns: Sequence[str]) -> pd.DataFrame:
    require_columns(rows, "results", ["scenario", "condition", *_GAME, *columns])
    mask = (rows["scenario"] == quantity.scenario) & (rows["condition"] == quantity.condition)
    if quantity.swarm is not None:
        mask &= rows["swarm"] == quantity.swarm
    selected = rows[mask]
    game = check_frame(selected[_GAME], "runs", _GAME)
    for name in columns:
        values = pd.to_numeric(selected[name], errors="coerce")
        if not np.isfinite(values.to_numpy(np.float64, na_value=np.nan)).all():
            raise InputError(f"results column {name}", quantity.scenario, "must have finite numbers only")
    return selected.assign(**{name: game[name] for name in _GAME})


def _sum_swarms(results: Results, quantity: Quantity) -> pd.DataFrame:
    """Return the sums over the swarms of a quantity, by (n, seed)."""
    summed = [*_TIMES, *_COUNTS, "sud", "duration"]
    rows = _select_curve(results.runs, quantity, summed)
    if rows.duplicated(["n", "seed", "swarm"]).any():
        raise InputError("runs", quantity.scenario, "must have one row for each condition, N, seed and swarm")
    return rows.groupby(["n", "seed"])[summed].sum()


def _run_measure(results: Results, quantity: Quantity) -> pd.Series:
    summed = _sum_swarms(results, quantity)
    if not quantity.measure.startswith("time_"):
        return summed[quantity.measure]
    in_conflict = summed["t_a_intra"] + summed["t_a_inter"]
    parts = {
        "time_in_conflict": in_conflict,
        "time_inter": summed["t_a_inter"],
        "time_intra": summed["t_a_intra"],
    }
    return 100 * share_of_time(parts[quantity.measure], in_conflict, summed["t_p"])


def _learned_measure(results: Results, quantity: Quantity) -> pd.Series:
    if results.policies is None:
        return pd.Series(dtype=np.float64, index=pd.MultiIndex.from_arrays([[], []], names=["n", "seed"]))
    # `attack_share` is repeated in the row of each action.
    rows = _select_curve(results.policies, quantity, ["opponent", "attack_share"])
    rows = rows.drop_duplicates(["n", "seed", "opponent"])
    within = quantity.measure == "learned_flight_within"
    rows = rows[(rows["opponent"] == rows["swarm"]) == within]
    if quantity.opponent is not None:
        rows = rows[rows["opponent"] == quantity.opponent]
    if rows.duplicated(["n", "seed"]).any():
        opponents = ", ".join(map(str, sorted(set(rows["opponent"]))))
        raise InputError("opponent", quantity.opponent, f"must be one of {opponents} in {quantity.scenario}")
    share = rows.set_index(["n", "seed"])["attack_share"]
    return 100 * (1 - share if within else share)
