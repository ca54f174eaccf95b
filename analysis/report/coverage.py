"""What a results directory covers of what could be played, and what is missing."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import pandas as pd

from kswarms.analysis.text_tables import PrintedTable, span


@dataclass(frozen=True)
class Planned:
    """A scenario as it is meant to be played.

    Attributes
    ----------
    title : str
        What it is, in a line.
    conditions : tuple of str
        Names of its curves.
    densities : tuple of int
        Numbers of robots in all.
    seeds : int
        Games at each density.
    """

    title: str
    conditions: tuple[str, ...]
    densities: tuple[int, ...]
    seeds: int


def coverage(runs: pd.DataFrame, plan: Mapping[str, Planned]) -> pd.DataFrame:
    """Compare the games that there are with those that a plan asks for.

    Parameters
    ----------
    runs : pandas.DataFrame
        Rows of `runs.parquet`.
    plan : mapping of str to Planned
        Scenarios by id.

    Returns
    -------
    pandas.DataFrame
        One row for each scenario of the plan, in its order: `scenario` (str), `games`, `planned` (int64):
        games that there are and that it asks for, counted once for each curve; `missing` (str): what is not
        there, empty for nothing. Games beside the plan, at other densities or seeds, do not count.
    """
    points = runs[["scenario", "condition", "n", "seed"]].drop_duplicates()
    rows = []
    for scenario, planned in plan.items():
        of_plan = points[
            (points["scenario"] == scenario)
            & points["condition"].isin(planned.conditions)
            & points["n"].isin(planned.densities)
            & (points["seed"] < planned.seeds)
        ]
        wanted = len(planned.conditions) * len(planned.densities) * planned.seeds
        missing = _missing(of_plan, planned) if len(of_plan) < wanted else ""
        rows.append({"scenario": scenario, "games": len(of_plan), "planned": wanted, "missing": missing})
    return pd.DataFrame(rows, columns=["scenario", "games", "planned", "missing"])


def _missing(points: pd.DataFrame, planned: Planned) -> str:
    if points.empty:
        return "everything"
    parts = []
    conditions = _absent(planned.conditions, points["condition"])
    if conditions:
        parts.append(f"conditions {conditions}")
    densities = _absent(planned.densities, points["n"])
    if densities:
        parts.append(f"N = {densities}")
    seeds = points.groupby(["condition", "n"])["seed"].nunique()
    if seeds.min() < planned.seeds:
        few, many = seeds.min(), seeds.max()
        parts.append(f"seeds ({span(few, many)} of {planned.seeds})")
    return "; ".join(parts) or "some conditions at some N"


def _absent(wanted: Iterable[object], present: pd.Series) -> str:
    there = set(present)
    return ", ".join(str(value) for value in wanted if value not in there)


def printed(frame: pd.DataFrame) -> PrintedTable:
    """Print what `coverage` returns; scenarios of which there is nothing go to the caption."""
    absent = frame[frame["games"] == 0]["scenario"]
    partial = frame[(frame["games"] > 0) & (frame["missing"] != "")]
    rows = [
        [row["scenario"], str(row["games"]), str(row["planned"]), row["missing"]]
        for row in partial.to_dict("records")
    ]
    complete = int((frame["missing"] == "").sum())
    caption = f"{complete} of {len(frame)} scenarios are complete, {len(partial)} in part"
    if len(absent):
        caption += f"; not played: {', '.join(absent)}"
    return PrintedTable(["scenario", "games", "of", "missing"], rows, f"{caption}.")
