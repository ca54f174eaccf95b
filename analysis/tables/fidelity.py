"""Comparison of the scenarios `argos-*` with the same games in ARGoS 3: pucks and time in conflict.

A mean score agrees within 20 %, within 1.5 pucks, or if the 95 % Welch interval of the difference contains 0.
A mean share of time in conflict, T(a) / (T(a) + T(p)), agrees within 0.06.
"""

import math
from typing import Any

import pandas as pd

from kswarms.agents.common.errors import InputError
from kswarms.agents.theory.times import share_of_time
from kswarms.analysis.results.published import argos_fixed_policies
from kswarms.analysis.results.tables import require_columns
from kswarms.analysis.statistics.comparisons import compare_independent
from kswarms.analysis.text_tables import MISSING, TextTable, with_interval

SHARE_TOLERANCE = 0.06
SCORE_TOLERANCE = 0.2
PUCK_TOLERANCE = 1.5

_ROW = ["scenario", "n", "swarm"]
# Absorbs rounding errors: a difference of two means can equal a tolerance.
_ROUNDING = 1e-9


def compare_with_argos(runs: pd.DataFrame) -> pd.DataFrame:
    """Compare runs with the ARGoS games of the same policies and density.

    Rows of `runs.parquet` without such ARGoS games are skipped; `InputError` if no row remains.

    Returns
    -------
    pandas.DataFrame
        One row for each common `scenario` (str), `n`, `swarm` (int64), sorted by these. Further columns:

        * `seeds_ours`, `seeds_theirs` (int64): numbers of games;
        * `score_ours`, `score_theirs`, `score_difference` (float64, pucks): means, and ours − theirs, with
          the 95 % Welch interval `score_low`, `score_high`, NaN for a single game on either side;
        * `score_relative` (float64): difference / theirs, NaN if theirs is 0;
        * `share_ours`, `share_theirs`, `share_difference` (float64): mean shares of time in conflict;
        * `score_fits`, `share_fits` (bool): whether scores and shares agree.
    """
    theirs = _argos_games()
    require_columns(runs, "runs", [*_ROW, "pucks", "t_a_intra", "t_a_inter", "t_p"])
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
    """Return a row of `compare_with_argos` for the games of one swarm."""
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
    """Return `compare_with_argos` as a text table."""
    header = ["scenario", "N", "swarm", "pucks", "ARGoS", "difference (95 % interval)", "relative", "fits"]
    header += ["time in conflict", "ARGoS", "difference", "fits"]
    rows = []
    for row in frame.to_dict("records"):
        relative = MISSING if pd.isna(row["score_relative"]) else f"{100 * row['score_relative']:+.0f} %"
        difference = with_interval(row["score_difference"], row["score_low"], row["score_high"], "+.1f")
        scores = [f"{row[name]:.1f}" for name in ("score_ours", "score_theirs")]
        shares = [f"{row['share_ours']:.3f}", f"{row['share_theirs']:.3f}", f"{row['share_difference']:+.3f}"]
        fits = ["yes" if row[name] else "no" for name in ("score_fits", "share_fits")]
        point = [row["scenario"], str(row["n"]), f"S{row['swarm']}"]
        rows.append([*point, *scores, difference, relative, fits[0], *shares, fits[1]])
    return TextTable(header, rows, "")


def markdown_table(frame: pd.DataFrame) -> str:
    """Return `compare_with_argos` in Markdown, with disagreements in bold."""
    return argos_table(frame).to_markdown().replace("| no |", "| **no** |")


def _own_games(runs: pd.DataFrame) -> pd.DataFrame:
    in_conflict = runs["t_a_intra"] + runs["t_a_inter"]
    return runs[_ROW].assign(score=runs["pucks"], share=share_of_time(in_conflict, in_conflict, runs["t_p"]))


def _argos_games() -> pd.DataFrame:
    """Return the ARGoS games in the form of `_own_games`: one row for each game and swarm."""
    games = argos_fixed_policies()
    scenario = "argos-" + games["s1_policy"] + "-" + games["s2_policy"]
    swarms = []
    for swarm in (1, 2):
        in_conflict = games[f"ta_intra{swarm}"] + games[f"ta_inter{swarm}"]
        share = share_of_time(in_conflict, in_conflict, games[f"tp{swarm}"])
        swarms.append(
            games[["n"]].assign(scenario=scenario, swarm=swarm, score=games[f"score{swarm}"], share=share)
        )
    return pd.concat(swarms)
