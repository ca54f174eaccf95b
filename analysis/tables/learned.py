"""Tables of learned policies, with the published numbers, from the rows of `policies.parquet`.

A cell is the percentage of a swarm's robots that learned to attack another swarm, or to flee within their
own: the mean over the seeds, with its 95 % interval.
"""

from collections.abc import Sequence

import pandas as pd

from kswarms.agents.common.errors import InputError
from kswarms.analysis.results.published import learned_percentages
from kswarms.analysis.statistics.means import describe_seeds, with_intervals
from kswarms.analysis.text_tables import TextTable, number, with_interval

_COLUMN = ["scenario", "condition", "swarm", "opponent"]
_CELL = [*_COLUMN, "n"]


def learned_shares(policies: pd.DataFrame, scenarios: Sequence[str]) -> pd.DataFrame:
    """Return the percentage of robots that learned to attack others or to flee within, by curve and density.

    `policies` are rows of `policies.parquet`. Scenarios without learners are left out; one must have some.

    Returns
    -------
    pandas.DataFrame
        One row for each `scenario`, `condition` (str), `swarm`, `opponent`, `n` (int64), in the order of
        `scenarios`, then sorted, with

        * `learned` (str): ``attack`` (another swarm) or ``flight within`` (the own swarm);
        * `seeds` (int64): number of games;
        * `measured` (float64, %): mean over the seeds;
        * `low`, `high` (float64, %): its 95 % interval, NaN for fewer than six seeds;
        * `published` (float64, %): the source's number, NaN if there is none;
        * `error` (float64, percentage points): measured − published.
    """
    rows = policies[policies["scenario"].isin(scenarios)]
    if rows.empty:
        known = ", ".join(sorted(set(policies["scenario"])))
        raise InputError("scenarios", list(scenarios), f"must include one with learners: {known}")
    # The row of each action has the share of attack.
    rows = rows.drop_duplicates([*_CELL, "seed"])
    within = rows["opponent"] == rows["swarm"]
    rows = rows.assign(
        learned=within.map({True: "flight within", False: "attack"}),
        percent=100 * rows["attack_share"].where(~within, 1 - rows["attack_share"]),
    )
    cells = with_intervals(rows, [*_CELL, "learned"], "percent").rename(columns={"mean": "measured"})
    cells = cells.merge(learned_percentages(), how="left", on=["scenario", "learned", "n"])
    cells["error"] = cells["measured"] - cells["published"]
    order = {scenario: index for index, scenario in enumerate(scenarios)}
    cells = cells.sort_values(
        _CELL, key=lambda values: values.map(order) if values.name == "scenario" else values
    ).reset_index(drop=True)
    return cells[[*_CELL, "learned", "seeds", "measured", "low", "high", "published", "error"]]


def mean_absolute_error(cells: pd.DataFrame) -> float:
    """Return the mean of |measured − published| over the published cells, NaN if there is none."""
    return float(cells["error"].abs().mean())


def learned_table(cells: pd.DataFrame) -> TextTable:
    """Return the cells of `learned_shares` in the form of the source's tables: a row for each N.

    Each curve has a column of measured percentages, after its published ones if there are any. Columns are
    named as in `named_columns`. The caption has the mean absolute errors.
    """
    densities = sorted(set(cells["n"]))
    header, columns, errors = ["N"], [[str(n) for n in densities]], []
    for name, column in named_columns(cells):
        by_density = column.set_index("n").reindex(densities)
        if column["published"].notna().any():
            header.append(f"{name}\npublished")
            columns.append([number(value, ".1f") for value in by_density["published"]])
            errors.append(f"{name} {mean_absolute_error(column):.1f}")
        header.append(f"{name}\nmeasured")
        measured = zip(by_density["measured"], by_density["low"], by_density["high"], strict=True)
        columns.append([with_interval(*cell, ".1f") for cell in measured])
    return TextTable(header, [list(row) for row in zip(*columns, strict=True)], _caption(cells, errors))


def named_columns(cells: pd.DataFrame) -> list[tuple[str, pd.DataFrame]]:
    """Return each column of a table with its name: scenario, condition and action, as far as these differ."""
    differing = [part for part in ("scenario", "condition", "learned") if cells[part].nunique() > 1]
    opponents = cells.groupby(["scenario", "condition", "swarm", "learned"])["opponent"].nunique()
    columns = []
    for _, column in cells.groupby(_COLUMN, sort=False):
        first = column.iloc[0]
        words = [str(first[part]) for part in differing or ["learned"]]
        if opponents.max() > 1:
            words.append(f"S{first['opponent']}")
        columns.append((", ".join(words), column))
    return columns


def _caption(cells: pd.DataFrame, errors: Sequence[str]) -> str:
    seeds = describe_seeds(cells["seeds"].min(), cells["seeds"].max())
    caption = f"percent of the learning swarm's robots; {seeds}"
    compared = cells["error"].notna().sum()
    if compared:
        caption += f"\nmean absolute error, percentage points: {', '.join(errors)}"
    if len(errors) > 1:
        caption += f", all {compared} cells {mean_absolute_error(cells):.1f}"
    return caption
