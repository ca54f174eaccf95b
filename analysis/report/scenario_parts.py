"""Parts of the report about scenarios, tables of the source, ARGoS and findings."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Final

import pandas as pd

from kswarms.agents.common.errors import InputError
from kswarms.analysis.figures import over_n
from kswarms.analysis.figures.style import heading
from kswarms.analysis.findings import Verdict
from kswarms.analysis.measures.learned import learned_shares
from kswarms.analysis.measures.quantities import TIME_SHARES, shown_quantities
from kswarms.analysis.report.page import Part
from kswarms.analysis.results.runs import Results
from kswarms.analysis.tables import fidelity, scores
from kswarms.analysis.tables.findings import verdict_rows
from kswarms.analysis.tables.learned import learned_table
from kswarms.analysis.text_tables import MISSING, TextTable

ARGOS: Final = "argos-"
"""Prefix of the ids of scenarios that were also played in ARGoS."""

_DESCRIPTIONS: Final = {
    ("pucks",): "pucks deposited by each swarm",
    ("sud",): "Swarm Utility Difference of S2",
    TIME_SHARES: "shares of time in conflict",
}


def scenario_part(results: Results, scenario: str, title: str, missing: str, table: str) -> Part:
    """Return the part of a scenario: figures without and with intervals, numbers, and learned policies.

    `missing` describes the missing games, and `table` is the id of the source's table of the learned
    policies; either may be empty.
    """
    part = Part(scenario, heading(scenario, title))
    if missing:
        part.text.append(f"Missing: {missing}.")
    shown = _DESCRIPTIONS[shown_quantities(scenario)]
    frame = scores.scores(results.runs, scenario)
    curves = ", ".join(dict.fromkeys(frame["curve"]))
    chart = f"Line chart of the {shown} over the number of robots in all, for {curves}"
    for detail, content in ((False, "means only"), (True, "means, 95 % intervals and single seeds")):
        name = scenario if detail else f"{scenario}-source"
        figure = over_n.figure_of(results.runs, scenario, title, detail)
        alt = f"{chart}, {content}; the table of {scenario} has its numbers."
        part.add_figure(name, figure, alt, f"{shown[0].upper()}{shown[1:]}: {content}.")
    part.add_table(scenario, f"Numbers of {scenario}", scores.scores_table(frame), frame)
    if results.policies is not None and scenario in set(results.policies["scenario"]):
        _add_learned(part, scenario, results.runs, learned_shares(results.policies, [scenario]), title, table)
    return part


def _add_learned(
    part: Part, scenario: str, runs: pd.DataFrame, cells: pd.DataFrame, title: str, table: str
) -> None:
    """Add the figure of the learned policies, and their table unless the source has one."""
    name = table or f"{scenario}-learned"
    conditions = list(dict.fromkeys(runs.loc[runs["scenario"] == scenario, "condition"]))
    published = "; crosses: published" if cells["published"].notna().any() else ""
    part.add_figure(
        f"{scenario}-learned",
        over_n.learned_over_n(cells, heading(scenario, title), conditions),
        "Line chart of the share of robots that learned to attack others, or to flee within their swarm, "
        f"over the number of robots in all; {name} has its numbers.",
        f"Learned policies{published}; {name} has the numbers.",
    )
    if not table:
        part.add_table(name, f"Learned in {scenario}", learned_table(cells), cells)


def table_part(policies: pd.DataFrame, table: str, title: str, scenarios: Sequence[str]) -> Part:
    """Return the part of a table of the source: measured numbers, and published numbers if available."""
    cells = learned_shares(policies, scenarios)
    part = Part(table, f"{table}: {title}")
    absent = [name for name in scenarios if name not in set(cells["scenario"])]
    if absent:
        present = ", ".join(dict.fromkeys(cells["scenario"]))
        part.text.append(f"Missing: {', '.join(absent)}; the table shows {present}.")
    part.add_table(table, title, learned_table(cells), cells)
    return part


def argos_parts(runs: pd.DataFrame) -> Iterator[tuple[str, Part]]:
    """Yield the comparison with ARGoS and its chapter, if there are comparable runs."""
    try:
        frame = fidelity.compare_with_argos(runs)
    except InputError:
        return
    text = [
        f"A mean score agrees within {fidelity.SCORE_TOLERANCE:.0%}, within {fidelity.PUCK_TOLERANCE} pucks, "
        "or if the 95 % Welch interval of the difference contains 0; a mean share of time in conflict agrees "
        f"within {fidelity.SHARE_TOLERANCE}.",
        f"Scores agree in {frame['score_fits'].sum()} of {len(frame)} rows, shares of time in "
        f"{frame['share_fits'].sum()}.",
    ]
    part = Part("argos", "Agreement with ARGoS 3", text)
    table = replace(fidelity.argos_table(frame), marks={"yes": "holds", "no": "fails"})
    part.add_table("argos", "The same games here and in ARGoS 3", table, frame)
    yield ARGOS, part


def verdicts_part(verdicts: Sequence[Verdict]) -> Part:
    """Return the part of the findings: the verdict of each, and the number of findings per verdict."""
    frame = verdict_rows(verdicts)
    counts = frame["verdict"].value_counts()
    header = ["finding", "verdict", "statement", "effect (interval)", "unit", "seeds", "note"]
    rows = frame.assign(effect=[_effect(verdict) for verdict in verdicts])
    cells = rows[["finding", "verdict", "statement", "effect", "unit", "seeds", "note"]]
    marks = {name: name.replace(" ", "-") for name in counts.index}
    marks |= {verdict.statement: "statement" for verdict in verdicts}
    marks |= {verdict.note: "note" for verdict in verdicts if verdict.note}
    text = [
        f"{len(verdicts)} findings: {', '.join(f'{k} {name}' for name, k in counts.items())}.",
        "A finding holds or fails if the interval of its effect lies on one side of the bound; it is "
        "undecided if the interval contains the bound, or if seeds or densities are missing.",
    ]
    part = Part("verdicts", "Findings", text)
    table = TextTable(header, cells.astype(str).to_numpy().tolist(), "", marks)
    part.add_table("findings", "Findings and their verdicts", table, frame)
    return part


def _effect(verdict: Verdict) -> str:
    if verdict.effect is None:
        return MISSING
    low, high = ("…" if end is None else f"{end:.3g}" for end in (verdict.low, verdict.high))
    interval = "" if verdict.low is None and verdict.high is None else f" ({low} … {high})"
    return f"{verdict.effect:.3g}{interval}"
