"""Verdicts on findings in several worlds: in how many a finding holds, and on which parameter it depends."""

import math
from collections.abc import Iterable, Mapping, Sequence

import numpy as np
import pandas as pd

from kswarms.analysis.findings.claims import Agreement, Claim
from kswarms.analysis.findings.data import NoDataError
from kswarms.analysis.findings.finding import Finding
from kswarms.analysis.findings.judging import judge
from kswarms.analysis.findings.worlds.discrepancy import discrepancy
from kswarms.analysis.results.runs import Results
from kswarms.analysis.statistics.curves import spearman
from kswarms.analysis.text_tables import MISSING, TextTable

World = tuple[Mapping[str, float], Results]
"""The parameters of a world and the results of its games."""


def judge_over_worlds(
    findings: Iterable[Finding], default: Results, worlds: Sequence[World]
) -> pd.DataFrame:
    """Judge findings in a default world by their intervals, and in other worlds by the means over the seeds.

    Few seeds in each world have no interval, so a world counts if the means meet the claim.

    Returns
    -------
    pandas.DataFrame
        One row for each finding: `finding`, `statement`; `verdict` (str), in the default world; `holds`,
        `worlds` (int64): the number of worlds in which it holds, and of those that have the games; `depends`
        (bool): whether it holds in some and fails in others; `parameter` (str), the parameter whose rank
        correlation with the effect is the strongest, and `correlation` (float64); empty and NaN if the
        finding does not depend on the world.
    """
    rows = []
    for finding in findings:
        played = [
            (parameters, met, judge(finding, results).effect)
            for parameters, results in worlds
            if (met := holds_on_average(finding.claim, results)) is not None
        ]
        holds = sum(met for _, met, _ in played)
        depends = 0 < holds < len(played)
        effects = [(parameters, effect) for parameters, _, effect in played] if depends else []
        name, correlation = _strongest(effects)
        rows.append(
            {
                "finding": finding.id,
                "statement": finding.statement,
                "verdict": judge(finding, default).verdict,
                "holds": holds,
                "worlds": len(played),
                "depends": depends,
                "parameter": name,
                "correlation": correlation,
            }
        )
    return pd.DataFrame(rows)


def holds_on_average(claim: Claim, results: Results) -> bool | None:
    """Return whether the means over the seeds meet a claim; None without the games."""
    try:
        off = discrepancy(claim, results)
    except NoDataError:
        return None
    return off <= (claim.margin if isinstance(claim, Agreement) else 0.0)


def _strongest(worlds: Sequence[tuple[Mapping[str, float], float | None]]) -> tuple[str, float]:
    """Return the parameter with the strongest rank correlation with the effect, and the correlation."""
    known = [(parameters, effect) for parameters, effect in worlds if effect is not None]
    if len(known) < 3:
        return "", math.nan
    effects = np.array([effect for _, effect in known])
    correlations = {
        name: float(spearman(np.array([parameters[name] for parameters, _ in known]), effects))
        for name in known[0][0]
    }
    defined = {name: value for name, value in correlations.items() if math.isfinite(value)}
    if not defined:
        return "", math.nan
    name = max(defined, key=lambda each: abs(defined[each]))
    return name, defined[name]


def worlds_table(frame: pd.DataFrame) -> TextTable:
    """Return `judge_over_worlds` as a text table."""
    header = ["finding", "statement", "default world", "holds in", "depends on"]
    rows = []
    for row in frame.to_dict("records"):
        depends = f"{row['parameter']} ({row['correlation']:+.2f})" if row["parameter"] else MISSING
        if row["depends"] and not row["parameter"]:
            depends = "the world"
        counted = f"{row['holds']} of {row['worlds']} worlds"
        rows.append([row["finding"], row["statement"], row["verdict"], counted, depends])
    return TextTable(header, rows, "In brackets: Spearman's correlation of the parameter with the effect.")
