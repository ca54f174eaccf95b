"""Assembly of the report from its parts."""

import re
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Final

import pandas as pd

from kswarms.analysis.findings import FINDINGS, NO_DATA, Finding, judge_all
from kswarms.analysis.report.coverage import PlannedScenario, coverage, coverage_table
from kswarms.analysis.report.page import Chapter, Part, Report, unused_name
from kswarms.analysis.report.provenance import directory_parts, libraries_part
from kswarms.analysis.report.record_parts import ArenaOf, conflict_parts, recorded_conditions, robots_parts
from kswarms.analysis.report.scenario_parts import (
    ARGOS,
    argos_parts,
    scenario_part,
    table_part,
    verdicts_part,
)
from kswarms.analysis.results.runs import Results, read_results
from kswarms.analysis.results.sweeps import Sweep
from kswarms.analysis.text_tables import span

_TITLES: Final = {
    "verdicts": "Findings",
    "fig-6.": "Symmetric swarms (chapter 6)",
    "fig-7.": "Disadvantaged learner (chapter 7)",
    ARGOS: "Comparison with ARGoS",
    "other": "Other scenarios",
    "networks": "Interaction networks and jams",
    "emergence": "Emerging policies",
    "maps": "Places of conflicts",
    "missing": "Missing games",
    "provenance": "Provenance",
}
"""Titles of the chapters, in their order."""

_PREFIXES: Final = ("fig-6.", "fig-7.", ARGOS)
"""Prefixes of scenario ids, which are keys of `_TITLES`; other scenarios are in the chapter `other`."""

SourceTables = Mapping[str, tuple[str, Sequence[str]]]
"""Title and scenarios of each table of the source, by table id."""

Step = Callable[[], Iterable[tuple[str, Part]]]
"""Returns pairs of a chapter (key of `_TITLES`) and a part."""

Progress = Callable[[Sequence[Step]], Iterable[Step]]
"""Iterates over the steps and may show progress."""


def build_report(
    source: str | Path | Sweep | Results,
    plan: Mapping[str, PlannedScenario] | None = None,
    source_tables: SourceTables | None = None,
    findings: Sequence[Finding] = FINDINGS,
    arena_of: ArenaOf = lambda *_: None,
    progress: Progress = iter,
) -> Report:
    """Build the report on results.

    Parameters
    ----------
    source : Results, or a source for `read_results`
        Results directory of `kswarms run --out`, or a sweep, which has no recorded tables.
    plan : mapping of str to PlannedScenario, optional
        Scenarios by id, in their order in the report; other scenarios of the results follow.
    source_tables : mapping of str to (str, sequence of str), optional
        Title and scenarios of each table of the source, by table id.
    findings : sequence of Finding
        Findings to judge.
    arena_of : callable
        Returns the arena of a game, which the heat maps show (see `ArenaOf`); by default None.
    progress : callable
        Wraps the iteration over the steps, such as a progress bar.

    Returns
    -------
    Report
        The same results always give the same report.

    Raises
    ------
    InputError
        The results cannot be read.
    """
    results = source if isinstance(source, Results) else read_results(source)
    plan, tables = plan or {}, source_tables or {}
    covered = coverage(results.runs, plan)
    parts: dict[str, list[Part]] = defaultdict(list)
    steps: list[Step] = [
        partial(_verdicts, results, findings, bool(plan)),
        *_scenario_steps(results, plan, tables, covered),
        *_table_steps(results, tables),
        partial(argos_parts, results.runs),
    ]
    name = "a sweep"
    parts["provenance"].append(libraries_part())
    if isinstance(source, str | Path):
        directory = Path(source)
        name = directory.resolve().name
        parts["provenance"] += directory_parts(directory)
        with_conflicts = recorded_conditions(directory, "conflicts", results.runs)
        with_robots = recorded_conditions(directory, "robots", results.runs)
        steps += [partial(conflict_parts, directory, condition, arena_of) for condition in with_conflicts]
        steps += [partial(robots_parts, directory, condition) for condition in with_robots]
    for step in progress(steps):
        for chapter, part in step():
            parts[chapter].append(part)
    if plan:
        missing = Part("missing", _TITLES["missing"])
        missing.add_table("coverage", "Games of each scenario", coverage_table(covered), covered)
        parts["missing"] = [missing]
    chapters = [Chapter(_anchor(title), title, parts[key]) for key, title in _TITLES.items() if parts[key]]
    used = {"content", *(chapter.id for chapter in chapters)}
    for part in (part for chapter in chapters for part in chapter.parts):
        part.id = unused_name(part.id, used)
        used.add(part.id)
    return Report(f"Report on {name}", _summary(results, covered), chapters)


def _verdicts(results: Results, findings: Sequence[Finding], planned: bool) -> Iterator[tuple[str, Part]]:
    """Yield the verdicts; without a plan, only if a finding has results."""
    verdicts = judge_all(results, findings)
    if planned or any(verdict.verdict != NO_DATA for verdict in verdicts):
        yield "verdicts", verdicts_part(verdicts)


def _scenario_steps(
    results: Results, plan: Mapping[str, PlannedScenario], tables: SourceTables, covered: pd.DataFrame
) -> Iterator[Step]:
    """Yield a step for each scenario with runs, in the order of the plan."""
    missing = dict(zip(covered["scenario"], covered["missing"], strict=True))
    table_of = {scenario: table for table, (_, scenarios) in tables.items() for scenario in scenarios}
    present = set(results.runs["scenario"])
    for scenario in dict.fromkeys([*plan, *results.runs["scenario"]]):
        if scenario in present:
            title = plan[scenario].title if scenario in plan else ""
            arguments = (scenario, title, missing.get(scenario, ""), table_of.get(scenario, ""))
            yield partial(_in_chapter, scenario, scenario_part, results, *arguments)


def _table_steps(results: Results, tables: SourceTables) -> Iterator[Step]:
    """Yield a step for each table of the source with results of at least one of its scenarios."""
    if results.policies is not None:
        learned = set(results.policies["scenario"])
        for table, (title, scenarios) in tables.items():
            if learned.intersection(scenarios):
                name = table.replace("table-", "fig-")  # belongs to the chapter of these figures
                yield partial(_in_chapter, name, table_part, results.policies, table, title, scenarios)


def _in_chapter(name: str, make: Callable[..., Part], *arguments: object) -> list[tuple[str, Part]]:
    """Call `make` for a scenario or table, and return the part with its chapter."""
    chapter = next((prefix for prefix in _PREFIXES if name.startswith(prefix)), "other")
    return [(chapter, make(*arguments))]


def _summary(results: Results, covered: pd.DataFrame) -> list[str]:
    runs = results.runs
    seeds = runs.groupby(["scenario", "condition", "n"])["seed"].nunique()
    complete = int((covered["missing"] == "").sum())
    incomplete = int((covered["games"] > 0).sum()) - complete
    planned = f" Of {len(covered)} scenarios, {complete} are complete and {incomplete} in part."
    return [
        f"{runs['run'].nunique():,} games with {span(seeds.min(), seeds.max())} seeds at each density."
        + (planned if len(covered) else ""),
        "Each figure is shown twice: with means only, as in the source, and with 95 % intervals and single "
        "seeds. The table below it has its numbers, and published numbers if available.",
    ]


def _anchor(title: str) -> str:
    return re.sub(r"\W+", "-", title.lower()).strip("-")
