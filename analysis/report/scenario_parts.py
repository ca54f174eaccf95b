"""The parts of the report about scenarios, their tables, and what findings became of them."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Final

import pandas as pd

from kswarms.agents.common.errors import InputError
from kswarms.analysis.figures import over_n as figures
from kswarms.analysis.figures.style import heading
from kswarms.analysis.findings import Verdict
from kswarms.analysis.report.page import Part, Tabled
from kswarms.analysis.results.runs import Results
from kswarms.analysis.tables import fidelity, scores
from kswarms.analysis.tables import learned as tables
from kswarms.analysis.text_tables import PrintedTable

ARGOS: Final = "argos-"
"""How the ids of scenarios begin that were also played in ARGoS."""

_SHOWN: Final = {
    ("pucks",): "pucks deposited by each swarm",
    ("sud",): "Swarm Utility Difference of S2",
    figures.TIME_SHARES: "shares of time in conflict",
}


def scenario_part(results: Results, scenario: str, title: str, missing: str, table: str) -> Part:
    """Show a scenario: its figure in the source's form and in detail, its numbers, what its learners learned.

    Parameters
    ----------
    results : Results
        Some of their runs are of the scenario.
    scenario, title : str
        Its id and what it is; the title may be empty.
    missing : str
        What the runs lack of the plan; empty for nothing.
    table : str
        The source's table of what it learned; empty for none.
    """
    part = Part(scenario, heading(scenario, title))
    if missing:
        part.text.append(f"Missing: {missing}.")
    shown = _SHOWN[figures.quantities(scenario)]
    frame = scores.scores(results.runs, scenario)
    curves = ", ".join(dict.fromkeys(frame["curve"]))
    alt = f"Line chart of the {shown} over the number of robots in all, for {curves}"
    for name, detail, form in (
        (f"{scenario}-source", False, "in the form of the source"),
        (scenario, True, "with intervals and single seeds"),
    ):
        part.show(
            name,
            figures.figure_of(results.runs, scenario, title, detail),
            f"{alt}, {form}; the table of {scenario} has its numbers.",
            f"{shown[0].upper()}{shown[1:]}, {form}.",
        )
    part.tables.append(Tabled(scenario, f"Numbers of {scenario}", scores.printed(frame), frame))
    if results.policies is not None and scenario in set(results.policies["scenario"]):
        _add_learned(part, results, scenario, title, table)
    return part


def _add_learned(part: Part, results: Results, scenario: str, title: str, table: str) -> None:
    assert results.policies is not None
    cells = tables.learned(results.policies, [scenario])
    name = table or f"{scenario}-learned"
    of_scenario = results.runs[results.runs["scenario"] == scenario]
    conditions = list(dict.fromkeys(of_scenario["condition"]))
    published = "; crosses: published" if cells["published"].notna().any() else ""
    part.show(
        f"{scenario}-learned",
        figures.learned_over_n(cells, heading(scenario, title), conditions),
        "Line chart of the share of robots that learned to attack others, or to flee within their swarm, "
        f"over the number of robots in all; {name} has its numbers.",
        f"What robots learned{published}; {name} has the numbers.",
    )
    if not table:
        part.tables.append(Tabled(name, f"Learned in {scenario}", tables.printed(cells), cells))


def table_part(policies: pd.DataFrame, table: str, title: str, scenarios: Sequence[str]) -> Part:
    """Show a table of the source, published beside measured where numbers are at hand."""
    cells = tables.learned(policies, scenarios)
    absent = [name for name in scenarios if name not in set(cells["scenario"])]
    text = (
        [f"Missing: {', '.join(absent)}; the numbers are of {cells['scenario'].iloc[0]}."] if absent else []
    )
    shown = Tabled(table, title, tables.printed(cells), cells)
    return Part(table, f"{table}: {title}", text, tables=[shown])


def argos_parts(runs: pd.DataFrame) -> Iterator[tuple[str, Part]]:
    """Yield the comparison with ARGoS, for the chapter of these scenarios, if any run can be compared."""
    try:
        frame = fidelity.against_argos(runs)
    except InputError:
        return
    text = [
        f"A mean score agrees within {fidelity.SCORE_TOLERANCE:.0%}, within {fidelity.PUCK_TOLERANCE} pucks, "
        "or when the 95 % Welch interval of the difference holds 0; a mean share of time in conflict agrees "
        f"within {fidelity.SHARE_TOLERANCE}.",
        f"Scores agree in {frame['score_fits'].sum()} of {len(frame)} rows, shares of time in "
        f"{frame['share_fits'].sum()}.",
    ]
    table = replace(fidelity.printed(frame), marks={"yes": "holds", "no": "fails"})
    yield (
        ARGOS,
        Part(
            "argos",
            "Measured beside ARGoS",
            text,
            tables=[Tabled("argos", "The same games here and in ARGoS 3", table, frame)],
        ),
    )


def verdicts_part(verdicts: Sequence[Verdict]) -> Part:
    """Show what became of each finding, and how many there are of each verdict."""
    frame = pd.DataFrame([vars(verdict) for verdict in verdicts])
    counts = frame["verdict"].value_counts()
    told = ", ".join(f"{count} {verdict}" for verdict, count in counts.items())
    header = ["finding", "verdict", "statement", "effect (interval)", "unit", "seeds", "note"]
    rows = [
        [
            verdict.finding,
            verdict.verdict,
            verdict.statement,
            _effect(verdict),
            verdict.unit,
            str(verdict.seeds),
            verdict.note,
        ]
        for verdict in verdicts
    ]
    marks = {name: name.replace(" ", "-") for name in counts.index}
    marks |= {verdict.statement: "statement" for verdict in verdicts}
    marks |= {verdict.note: "note" for verdict in verdicts if verdict.note}
    table = PrintedTable(header, rows, "", marks)
    return Part(
        "verdicts",
        "Findings",
        [
            f"{len(verdicts)} findings at the seeds given: {told}.",
            "A finding holds or fails where the interval of its effect lies on one side; it is undecided "
            "where it does not, or where seeds or densities are missing.",
        ],
        tables=[Tabled("findings", "Findings and their verdicts", table, frame)],
    )


def _effect(verdict: Verdict) -> str:
    if verdict.effect is None:
        return "–"
    ends = ["…" if end is None else f"{end:.3g}" for end in (verdict.low, verdict.high)]
    interval = "" if verdict.low is None and verdict.high is None else f" ({ends[0]} … {ends[1]})"
    return f"{verdict.effect:.3g}{interval}"
