"""Comparison of the games in the results with the planned games of the scenarios."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import pandas as pd

from kswarms.analysis.text_tables import TextTable, span


@dataclass(frozen=True)
class PlannedScenario:
    """Planned games of a scenario: `seeds` games for each condition and density (number of robots in all)."""

    title: str
    conditions: tuple[str, ...]
    densities: tuple[int, ...]
    seeds: int


def coverage(runs: pd.DataFrame, plan: Mapping[str, PlannedScenario]) -> pd.DataFrame:
    """Compare the games in the results with a plan by scenario id.

    Returns
    -------
    pandas.DataFrame
        One row for each `scenario`, in the order of the plan: `games` (int64), the number of planned games
        in the results; `planned` (int64), the number of planned games; `missing` (str), a description of
        the missing games, empty if there are none. A game that two conditions share counts twice.
    """
    points = runs[["scenario", "condition", "n", "seed"]].drop_duplicates()
    rows = []
    for scenario, planned in plan.items():
        found = points[
            (points["scenario"] == scenario)
            & points["condition"].isin(planned.conditions)
            & points["n"].isin(planned.densities)
            & (points["seed"] < planned.seeds)
        ]
        total = len(planned.conditions) * len(planned.densities) * planned.seeds
        missing = _missing(found, planned) if len(found) < total else ""
        rows.append({"scenario": scenario, "games": len(found), "planned": total, "missing": missing})
    return pd.DataFrame(rows, columns=["scenario", "games", "planned", "missing"])


def _missing(found: pd.DataFrame, planned: PlannedScenario) -> str:
    if found.empty:
        return "everything"
    parts = []
    if conditions := _absent(planned.conditions, found["condition"]):
        parts.append(f"conditions {conditions}")
    if densities := _absent(planned.densities, found["n"]):
        parts.append(f"N = {densities}")
    seeds = found.groupby(["condition", "n"])["seed"].nunique()
    if seeds.min() < planned.seeds:
        parts.append(f"seeds ({span(seeds.min(), seeds.max())} of {planned.seeds})")
    return "; ".join(parts) or "some conditions at some N"


def _absent(planned: Iterable[object], found: pd.Series) -> str:
    present = set(found)
    return ", ".join(str(value) for value in planned if value not in present)


def coverage_table(frame: pd.DataFrame) -> TextTable:
    """Return the incomplete scenarios of `coverage` as a table.

    The caption has the number of complete scenarios and the ids of scenarios without games.
    """
    absent = frame[frame["games"] == 0]["scenario"]
    partial = frame[(frame["games"] > 0) & (frame["missing"] != "")]
    complete = int((frame["missing"] == "").sum())
    caption = f"{complete} of {len(frame)} scenarios are complete, {len(partial)} in part"
    if len(absent):
        caption += f"; not played: {', '.join(absent)}"
    rows = partial[["scenario", "games", "planned", "missing"]].astype(str).to_numpy().tolist()
    return TextTable(["scenario", "games", "of", "missing"], rows, f"{caption}.")
