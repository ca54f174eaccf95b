"""The report on a results directory: one HTML file with all that it covers, beside what was published."""

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Final

import pandas as pd

from kswarms.analysis.findings import FINDINGS, Finding, judge_all
from kswarms.analysis.report.coverage import Planned, coverage
from kswarms.analysis.report.coverage import printed as printed_coverage
from kswarms.analysis.report.page import Chapter, Part, Report, Tabled
from kswarms.analysis.report.provenance import provenance_parts
from kswarms.analysis.report.record_parts import PlacesOf, conflict_parts, recorded_curves, robots_parts
from kswarms.analysis.report.scenario_parts import (
    ARGOS,
    argos_parts,
    scenario_part,
    table_part,
    verdicts_part,
)
from kswarms.analysis.results.runs import Results, read_results
from kswarms.analysis.text_tables import span

__all__ = ["Planned", "Report", "report"]

_OF_SCENARIOS: Final = {
    "fig-6.": "Symmetric swarms (chapter 6)",
    "fig-7.": "Disadvantaged learner (chapter 7)",
    ARGOS: "The physics beside ARGoS",
    "": "Other scenarios",
}
"""Chapters by how the ids of their scenarios begin; the last is for all others."""

_OF_TABLES: Final = {"table-6.": "fig-6.", "table-7.": "fig-7."}
"""Chapters of the source's tables by how their ids begin."""

_OF_RECORDS: Final = {
    "networks": "Interaction networks and jams",
    "emergence": "How policies emerge",
    "maps": "Where conflicts happen",
}

Step = Callable[[], Iterable[tuple[str, Part]]]
"""Makes parts, each for a chapter."""

Progress = Callable[[Sequence[Step]], Iterable[Step]]
"""Passes steps on one by one, and tells somebody how many are done."""


def report(
    directory: Path,
    plan: Mapping[str, Planned],
    source_tables: Mapping[str, tuple[str, Sequence[str]]],
    findings: Sequence[Finding] = FINDINGS,
    places_of: PlacesOf = lambda *_: None,
    progress: Progress = iter,
) -> Report:
    """Report on a results directory.

    Parameters
    ----------
    directory : Path
        A directory that `kswarms run --out` wrote.
    plan : mapping of str to Planned
        Scenarios by id, in the order in which they are shown; others that the directory has follow them.
    source_tables : mapping of str to (str, sequence of str)
        Title of each table of the source, and the scenarios that it tabulates.
    findings : sequence of Finding
        What is judged.
    places_of : callable
        Where stations and bases are, for the heat maps.
    progress : callable
        Passes the steps on, as a progress bar does.

    Returns
    -------
    Report
        The same for the same results.

    Raises
    ------
    InputError
        The results cannot be read.
    """
    results = read_results(directory)
    covered = coverage(results.runs, plan)
    provenance = provenance_parts(directory)
    conflicts, robots = recorded_curves(directory, results.runs)
    steps: list[Step] = [
        partial(_verdicts, results, findings),
        *_scenarios(results, plan, source_tables, covered),
        *_tables(results, source_tables),
        partial(argos_parts, results.runs),
        *(partial(conflict_parts, directory, curve, places_of) for curve in conflicts),
        *(partial(robots_parts, directory, curve) for curve in robots),
    ]
    parts: dict[str, list[Part]] = defaultdict(list)
    for step in progress(steps):
        for chapter, part in step():
            parts[chapter].append(part)
    parts["missing"].append(_missing(covered))
    parts["provenance"] += provenance
    titles = {
        "verdicts": "Findings",
        **_OF_SCENARIOS,
        **_OF_RECORDS,
        "missing": "What is missing",
        "provenance": "Provenance",
    }
    chapters = [Chapter(_anchor(title), title, parts[key]) for key, title in titles.items() if parts[key]]
    return Report(f"Report on {directory.resolve().name}", _summary(results, covered), chapters)


def _verdicts(results: Results, findings: Sequence[Finding]) -> Iterator[tuple[str, Part]]:
    yield "verdicts", verdicts_part(judge_all(results, findings))


def _scenarios(
    results: Results,
    plan: Mapping[str, Planned],
    tables: Mapping[str, tuple[str, Sequence[str]]],
    covered: pd.DataFrame,
) -> Iterator[Step]:
    """Yield a step for each scenario that there are runs of, in the order of the plan."""
    missing = dict(zip(covered["scenario"], covered["missing"], strict=True))
    tabulated = {scenario: table for table, (_, scenarios) in tables.items() for scenario in scenarios}
    present = dict.fromkeys(results.runs["scenario"])
    for scenario in [name for name in plan if name in present] + [
        name for name in present if name not in plan
    ]:
        title = plan[scenario].title if scenario in plan else ""
        table = tabulated.get(scenario, "")
        yield partial(_scenario, results, scenario, title, missing.get(scenario, ""), table)


def _scenario(
    results: Results, scenario: str, title: str, missing: str, table: str
) -> Iterator[tuple[str, Part]]:
    chapter = next(start for start in _OF_SCENARIOS if scenario.startswith(start))
    yield chapter, scenario_part(results, scenario, title, missing, table)


def _tables(results: Results, tables: Mapping[str, tuple[str, Sequence[str]]]) -> Iterator[Step]:
    """Yield a step for each table of the source of whose scenarios there is at least one."""
    learned = set() if results.policies is None else set(results.policies["scenario"])
    for table, (title, scenarios) in tables.items():
        if learned.intersection(scenarios):
            yield partial(_table, results, table, title, scenarios)


def _table(results: Results, table: str, title: str, scenarios: Sequence[str]) -> Iterator[tuple[str, Part]]:
    assert results.policies is not None  # or there would be no step
    chapter = next((chapter for start, chapter in _OF_TABLES.items() if table.startswith(start)), "")
    yield chapter, table_part(results.policies, table, title, scenarios)


def _missing(covered: pd.DataFrame) -> Part:
    table = printed_coverage(covered)
    return Part(
        "missing", "What is missing", tables=[Tabled("coverage", "Games of each scenario", table, covered)]
    )


def _summary(results: Results, covered: pd.DataFrame) -> list[str]:
    runs = results.runs
    seeds = runs.groupby(["scenario", "condition", "n"])["seed"].nunique()
    few, many = seeds.min(), seeds.max()
    complete = int((covered["missing"] == "").sum())
    some = int((covered["games"] > 0).sum())
    return [
        f"{runs['run'].nunique():,} games with {span(few, many)} seeds at each "
        f"density. Of {len(covered)} scenarios {complete} are here as planned and {some - complete} in part.",
        "Each figure is shown in the form of the source, then with the 95 % interval of each mean and the "
        "single seeds; its numbers stand below it, and published ones beside them where they are at hand.",
    ]


def _anchor(title: str) -> str:
    return "-".join("".join(sign if sign.isalnum() else " " for sign in title.lower()).split())
