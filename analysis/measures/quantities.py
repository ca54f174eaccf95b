"""Quantities and curves of a scenario, from the rows of `runs.parquet`."""

from dataclasses import dataclass
from typing import Final

import pandas as pd

from kswarms.agents.common.errors import InputError
from kswarms.agents.theory.times import share_of_time
from kswarms.agents.user_code.syntax import split_outside
from kswarms.analysis.results.tables import rows_where

TIME_SHARES: Final = ("total", "inter-swarm", "intra-swarm")
"""Kinds of conflict, as columns with the share of time of a swarm."""

# Scenarios for which the source shows other quantities than pucks.
_SUD_CHAPTER_6: Final = {"fig-6.10a", "fig-6.10b", "fig-6.12", "fig-6.14"}
_SUD_CHAPTER_7: Final = {"fig-7.4", "fig-7.6", "fig-7.8", "fig-7.10", "fig-7.11", "fig-7.19"}
_TIME_SHARE_SCENARIOS: Final = {"fig-6.3"}


@dataclass(frozen=True)
class Curve:
    """One curve of a scenario: its label in legends and tables, and its rows of `runs.parquet`.

    `condition` is the index of the condition, None if the scenario has a single condition. `swarm` is the
    number of the swarm, None if only conditions differ.
    """

    label: str
    rows: pd.DataFrame
    condition: int | None
    swarm: int | None


def scenario_rows(runs: pd.DataFrame, scenario: str) -> pd.DataFrame:
    """Return the rows of a scenario, checked by `check_frame`; `InputError` if `runs` has none."""
    rows = rows_where(runs, "runs", "scenario", [scenario])
    if rows.empty:
        raise InputError("scenario", scenario, f"must be one of {', '.join(sorted(set(runs['scenario'])))}")
    return rows


def split_curves(rows: pd.DataFrame) -> list[Curve]:
    """Split the rows of a scenario into one curve for each condition and swarm."""
    conditions = list(dict.fromkeys(rows["condition"]))
    several_swarms = rows["swarm"].nunique() > 1
    curves = []
    for index, condition in enumerate(conditions):
        for swarm, of_curve in rows[rows["condition"] == condition].groupby("swarm"):
            label = f"S{swarm}: {', '.join(dict.fromkeys(map(short_policy, of_curve['policy'])))}"
            if len(conditions) == 1:
                curves.append(Curve(label, of_curve, None, int(swarm)))
            elif several_swarms:
                curves.append(Curve(f"{condition or '–'}, {label}", of_curve, index, int(swarm)))
            else:
                curves.append(Curve(condition or label, of_curve, index, None))
    return curves


def short_policy(policy: str) -> str:
    """Return a policy without arguments and paths, for legends."""
    return "+".join(part.partition("(")[0].rpartition(":")[2] for part in split_outside(policy, "+"))


def shown_quantities(scenario: str) -> tuple[str, ...]:
    """Return the quantities in the figure of a scenario: `TIME_SHARES`, ``sud`` (of S2) or ``pucks``."""
    if scenario in _SUD_CHAPTER_6 | _SUD_CHAPTER_7:
        return ("sud",)
    return TIME_SHARES if scenario in _TIME_SHARE_SCENARIOS else ("pucks",)


def add_time_shares(rows: pd.DataFrame) -> pd.DataFrame:
    """Add the shares of time in conflict, T(a) / (T(a) + T(p)): a column for each of `TIME_SHARES`."""
    in_conflict = rows["t_a_intra"] + rows["t_a_inter"]
    times = (in_conflict, rows["t_a_inter"], rows["t_a_intra"])
    shares = (share_of_time(time, in_conflict, rows["t_p"]) for time in times)
    return rows.assign(**dict(zip(TIME_SHARES, shares, strict=True)))
