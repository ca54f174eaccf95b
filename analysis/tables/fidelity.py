"""The scenarios `argos-*` beside the same games in ARGoS 3: pucks, time in conflict, and whether they agree.

A mean score agrees within 20 %, or within 1.5 pucks, or when the 95 % Welch interval of the difference holds
0; a mean share of time in conflict, T(a) / (T(a) + T(p)), agrees within 0.06.
"""

import math
from typing import Any

import pandas as pd

from kswarms.agents.common.errors import InputError
from kswarms.agents.theory.times import share_of_time
from kswarms.analysis.results.published import argos_fixed_policies
from kswarms.analysis.statistics.comparisons import compare_independent
from kswarms.analysis.text_tables import NONE, TextTable, with_interval

SHARE_TOLERANCE = 0.06
SCORE_TOLERANCE = 0.2
PUCK_TOLERANCE = 1.5

_ROW = ["scenario", "n", "swarm"]
# Means of counts over 10 and 20 seeds fall on the tolerances exactly: rounding must not decide.
_ROUNDING = 1e-9


def against_argos(runs: pd.DataFrame) -> pd.DataFrame:
    """Compare runs with the ARGoS games of the same policies and density.

    Parameters
    ----------
    runs : pandas.DataFrame
        Rows of `runs.parquet`; other scenarios, and densities that ARGoS was not run at, are left out.

    Returns
    -------
    pandas.DataFrame
        One row for each `scenario` (str), `n`, `swarm` (int64) that both have, sorted by these, with

        * `seeds_ours`, `seeds_theirs` (int64): games;
        * `score_ours`, `score_theirs`, `score_difference` (float64, pucks): means, and ours - theirs;
        * `score_low`, `score_high` (float64, pucks): the 95 % Welch interval of the difference, NaN where
          one of the two has a single game;
        * `score_relative` (float64): difference / theirs, NaN where theirs is 0;
        * `share_ours`, `share_theirs`, `share_difference` (float64): mean shares of time in conflict;
        * `score_fits`, `share_fits` (bool): whether they agree by the rule above.

    Raises
    ------
    InputError
        No run can be compared.
    """
    theirs = _argos_games()
    by_swarm = dict(list(theirs.groupby(_ROW)))
    rows = [
        dict(zip(_ROW, key, strict=True)) | _compare(games, by_swarm[key])
        for key, games in _own_games(runs).groupby(_ROW)
        if key in by_swarm
    ]
    if not rows:
        allowed = ", ".join(sorted(set(theirs["scenario"])))
        densities = ", ".join(str(n) for n in sorted(set(theirs["n"])))
        raise InputError(
            "scenarios", sorted(set(runs["scenario"])), f"must include {allowed} at one of N = {densities}"
        )
    return pd.DataFrame(rows)


def _compare(ours: pd.DataFrame, theirs: pd.DataFrame) -> dict[str, Any]:
    """Return a row of `against_argos` for the games of one swarm."""
    score = compare_independent(ours["score"], theirs["score"])
    theirs_score, theirs_share = theirs["score"].mean(), theirs["share"].mean()
    share_difference = ours["share"].mean() - theirs_share
    tolerance = max(SCORE_TOLERANCE * theirs_score, PUCK_TOLERANCE) + _ROUNDING
    return {
        "seeds_ours": len(ours),
        "seeds_theirs": len(theirs),
        "score_ours": ours["score"].mean(),
        "score_theirs": theirs_score,
        "score_difference": score.estimate,
        "score_low": score.low,
        "score_high": score.high,
        "score_relative": score.estimate / theirs_score if theirs_score > 0 else math.nan,
        "score_fits": abs(score.estimate) <= tolerance or score.low <= 0 <= score.high,
        "share_ours": ours["share"].mean(),
        "share_theirs": theirs_share,
        "share_difference": share_difference,
        "share_fits": abs(share_difference) <= SHARE_TOLERANCE + _ROUNDING,
    }


def argos_table(frame: pd.DataFrame) -> TextTable:
    """Print what `against_argos` returns, a line for each row."""
    header = [
        *("scenario", "N", "swarm", "pucks", "ARGoS", "difference (95 % interval)", "relative", "fits"),
        *("time in conflict", "ARGoS", "difference", "fits"),
    ]
    rows = []
    for row in frame.to_dict("records"):
        relative = NONE if pd.isna(row["score_relative"]) else f"{100 * row['score_relative']:+.0f} %"
        difference = with_interval(row["score_difference"], row["score_low"], row["score_high"], "+.1f")
        rows.append(
            [
                str(row["scenario"]),
                str(row["n"]),
                f"S{row['swarm']}",
                f"{row['score_ours']:.1f}",
                f"{row['score_theirs']:.1f}",
                difference,
                relative,
                _verdict(row["score_fits"]),
                f"{row['share_ours']:.3f}",
                f"{row['share_theirs']:.3f}",
                f"{row['share_difference']:+.3f}",
                _verdict(row["share_fits"]),
            ]
        )
    return TextTable(header, rows, "")


def markdown_table(frame: pd.DataFrame) -> str:
    """Write what `against_argos` returns as a Markdown table, a line for each row; misfits are bold."""
    return argos_table(frame).to_markdown().replace("| no |", "| **no** |")


def _verdict(fits: bool) -> str:
    return "yes" if fits else "no"


def _own_games(runs: pd.DataFrame) -> pd.DataFrame:
    in_conflict = runs["t_a_intra"] + runs["t_a_inter"]
    return runs[_ROW].assign(score=runs["pucks"], share=share_of_time(in_conflict, in_conflict, runs["t_p"]))


def _argos_games() -> pd.DataFrame:
    """Bring the ARGoS games into the form of ours: one row for each game and swarm."""
    games = argos_fixed_policies()
    swarms = []
    for swarm in (1, 2):
        in_conflict = games[f"ta_intra{swarm}"] + games[f"ta_inter{swarm}"]
        swarms.append(
            pd.DataFrame(
                {
                    "scenario": "argos-" + games["s1_policy"] + "-" + games["s2_policy"],
                    "n": games["n"],
                    "swarm": swarm,
                    "score": games[f"score{swarm}"],
                    "share": in_conflict / (in_conflict + games[f"tp{swarm}"]),
                }
            )
        )
    return pd.concat(swarms)
