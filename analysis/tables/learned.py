"""Tables of learned policies, with published numbers."""

from collections.abc import Sequence

import pandas as pd

from kswarms.analysis.measures.learned import mean_absolute_error, named_curves
from kswarms.analysis.statistics.means import describe_seeds
from kswarms.analysis.text_tables import TextTable, number, with_interval


def learned_table(cells: pd.DataFrame) -> TextTable:
    """Return the cells of `learned_shares` as a text table with a row for each N, like the source's tables.

    Each curve has a column of measured percentages, and before it a column of published percentages if there
    are any. The caption has the mean absolute errors.
    """
    densities = sorted(set(cells["n"]))
    header, columns, errors = ["N"], [[str(n) for n in densities]], []
    for name, column in named_curves(cells):
        by_density = column.set_index("n").reindex(densities)
        if column["published"].notna().any():
            header.append(f"{name}\npublished")
            columns.append([number(value, ".1f") for value in by_density["published"]])
            errors.append(f"{name} {mean_absolute_error(column):.1f}")
        header.append(f"{name}\nmeasured")
        measured = zip(by_density["measured"], by_density["low"], by_density["high"], strict=True)
        columns.append([with_interval(*cell, ".1f") for cell in measured])
    return TextTable(header, [list(row) for row in zip(*columns, strict=True)], _caption(cells, errors))


def _caption(cells: pd.DataFrame, errors: Sequence[str]) -> str:
    seeds = describe_seeds(cells["seeds"].min(), cells["seeds"].max())
    caption = f"percent of the learning swarm's robots; {seeds}"
    compared = cells["error"].notna().sum()
    if compared:
        caption += f"\nmean absolute error, percentage points: {', '.join(errors)}"
    if len(errors) > 1:
        caption += f", all {compared} cells {mean_absolute_error(cells):.1f}"
    return caption
