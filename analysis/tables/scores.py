"""Tables of the means that the figure of a scenario shows."""

import pandas as pd

from kswarms.analysis.measures.quantities import (
    TIME_SHARES,
    add_time_shares,
    scenario_rows,
    shown_quantities,
    split_curves,
)
from kswarms.analysis.statistics.means import describe_seeds, mean_by_group
from kswarms.analysis.text_tables import TextTable, with_interval

_QUANTITY_LABELS = {"pucks": "pucks deposited by the swarm", "sud": "SUD of S2 (pucks)"}


def scores(runs: pd.DataFrame, scenario: str) -> pd.DataFrame:
    """Return the numbers of the figure of a scenario (`kswarms.analysis.figures.over_n.figure_of`).

    The result has one row for each `quantity` (str: ``pucks``, ``sud`` or a kind of time share), `curve`
    (str: name in the legend) and `n`, with `seeds`, `mean`, `low` and `high` as in `mean_by_group`.
    """
    rows = scenario_rows(runs, scenario)
    shown = shown_quantities(scenario)
    if shown == ("sud",):
        rows = rows[rows["swarm"] == 2]
    elif shown == TIME_SHARES:
        rows = add_time_shares(rows)
    parts = [
        mean_by_group(curve.rows, ["n"], quantity).assign(quantity=quantity, curve=curve.label)
        for quantity in shown
        for curve in split_curves(rows)
    ]
    return pd.concat(parts, ignore_index=True)[["quantity", "curve", "n", "seeds", "mean", "low", "high"]]


def scores_table(frame: pd.DataFrame) -> TextTable:
    """Return `scores` as a text table: a row for each N, a column for each curve and quantity."""
    densities = sorted(set(frame["n"]))
    several = frame["quantity"].nunique() > 1
    header, columns = ["N"], [[str(n) for n in densities]]
    for (quantity, curve), column in frame.groupby(["quantity", "curve"], sort=False):
        header.append(f"{curve}\n{quantity}" if several else str(curve))
        by_density = column.set_index("n").reindex(densities)
        form = ".1f" if quantity in _QUANTITY_LABELS else ".3f"
        cells = zip(by_density["mean"], by_density["low"], by_density["high"], strict=True)
        columns.append([with_interval(*cell, form) for cell in cells])
    label = "share of time in conflict" if several else _QUANTITY_LABELS[frame["quantity"].iloc[0]]
    seeds = describe_seeds(frame["seeds"].min(), frame["seeds"].max())
    return TextTable(header, [list(row) for row in zip(*columns, strict=True)], f"{label}; {seeds}")
