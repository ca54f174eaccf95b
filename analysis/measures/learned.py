"""Shares of robots that learned an action, with published numbers, from the rows of `policies.parquet`.

A cell is the percentage of a swarm's robots that learned to attack another swarm, or to flee within their own
swarm. It is a mean over the seeds, with its 95 % interval.
"""

from collections.abc import Sequence

import pandas as pd

from kswarms.agents.common.errors import InputError
from kswarms.analysis.results.published import learned_percentages
from kswarms.analysis.results.tables import rows_where
from kswarms.analysis.statistics.means import mean_by_group

_CURVE = ["scenario", "condition", "swarm", "opponent"]
_CELL = [*_CURVE, "n"]


def learned_shares(policies: pd.DataFrame, scenarios: Sequence[str]) -> pd.DataFrame:
    """Return the percentage of robots that learned to attack, or to flee within their swarm.

    `policies` are rows of `policies.parquet`. Scenarios without learners are skipped; `InputError` if
    no scenario has learners.

    Returns
    -------
    pandas.DataFrame
        One row for each `scenario`, `condition` (str), `swarm`, `opponent`, `n` (int64). Rows are in the
        order of `scenarios`, then sorted by the other columns. Further columns:

        * `learned` (str): ``attack`` (another swarm) or ``flight within`` (the own swarm);
        * `seeds` (int64): number of games;
        * `measured` (float64, %): mean over the seeds;
        * `low`, `high` (float64, %): its 95 % interval, NaN for fewer than six seeds;
        * `published` (float64, %): published number, NaN if there is none;
        * `error` (float64, percentage points): measured − published.
    """
    rows = rows_where(policies, "policies", "scenario", scenarios)
    if rows.empty:
        known = ", ".join(sorted(set(policies["scenario"])))
        raise InputError("scenarios", list(scenarios), f"must include one with learners: {known}")
    # `attack_share` is repeated in the row of each action.
    rows = rows.drop_duplicates([*_CELL, "seed"])
    within = rows["opponent"] == rows["swarm"]
    rows = rows.assign(
        learned=within.map({True: "flight within", False: "attack"}),
        percent=100 * rows["attack_share"].where(~within, 1 - rows["attack_share"]),
    )
    cells = mean_by_group(rows, [*_CELL, "learned"], "percent").rename(columns={"mean": "measured"})
    cells = cells.merge(learned_percentages(), how="left", on=["scenario", "condition", "learned", "n"])
    cells["error"] = cells["measured"] - cells["published"]
    cells["order"] = cells["scenario"].map(list(scenarios).index)
    cells = cells.sort_values(["order", *_CELL], ignore_index=True)
    return cells[[*_CELL, "learned", "seeds", "measured", "low", "high", "published", "error"]]


def mean_absolute_error(cells: pd.DataFrame) -> float:
    """Return the mean of |measured − published| over the published cells; NaN without such cells."""
    return float(cells["error"].abs().mean())


def named_curves(cells: pd.DataFrame) -> list[tuple[str, pd.DataFrame]]:
    """Return (name, curve) pairs; a name consists of scenario, condition and action, where these differ."""
    differing = [part for part in ("scenario", "condition", "learned") if cells[part].nunique() > 1]
    opponents = cells.groupby(["scenario", "condition", "swarm", "learned"])["opponent"].nunique()
    curves = []
    for _, curve in cells.groupby(_CURVE, sort=False):
        first = curve.iloc[0]
        parts = [str(first[part]) for part in differing or ["learned"]]
        if opponents.max() > 1:
            parts.append(f"S{first['opponent']}")
        curves.append((", ".join(parts), curve))
    return curves
