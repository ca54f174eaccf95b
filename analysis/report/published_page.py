"""The page of a published study, in Markdown, from the files that `publish` wrote."""

from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from textwrap import indent
from typing import Final

import pandas as pd

from kswarms.agents.common.quoting import for_markdown
from kswarms.analysis.measures.learned import mean_absolute_error, named_curves
from kswarms.analysis.report.published_files import Published
from kswarms.analysis.tables.fidelity import argos_table
from kswarms.analysis.tables.findings import count_verdicts, findings_markdown
from kswarms.analysis.tables.learned import learned_table
from kswarms.analysis.tables.scores import scores_table
from kswarms.analysis.text_tables import MISSING, TextTable

_CHAPTERS: Final = {
    "6": ("Symmetric swarms (chapter 6)", "No swarm has an advantage over another."),
    "7": (
        "Disadvantaged learner (chapter 7)",
        "One swarm has an advantage: faster robots, more robots, or a nearer station.",
    ),
}
"""Title and first sentence of each chapter, by its number."""
_UNBROKEN: Final = "\N{NO-BREAK SPACE}…\N{NO-BREAK SPACE}"
"""What is between the bounds of an interval."""


def study_page(folder: Path, images: str) -> str:
    """Return the sections of the page: how it was played, findings, published numbers, chapters.

    `images` is the path of the folder from the page. Figures that the folder lacks are omitted.
    """
    study = Published.read(folder)
    sections = [_played(study), _findings(study), _errors(study), *_argos(study)]
    for number, (title, text) in _CHAPTERS.items():
        parts = list(_chapter(study, number, folder, images))
        if parts:
            sections.append("\n\n".join([f"## {title}", text, *parts]))
    return "\n\n".join(sections) + "\n"


def error_rows(study: Published) -> list[tuple[str, str, int, float]]:
    """Return table id, curve, number of cells and mean absolute error of each published curve.

    After several curves of a table, a row with the curve ``all`` has all its cells.
    """
    rows = []
    for table, entry in study.about["tables"].items():
        cells = study.learned_in(entry["scenarios"])
        curves = [(name, curve) for name, curve in named_curves(cells) if curve["error"].notna().any()]
        if len(curves) > 1:
            curves.append(("all", cells))
        for name, curve in curves:
            rows.append((table, name, int(curve["error"].notna().sum()), mean_absolute_error(curve)))
    return rows


def _played(study: Published) -> str:
    about = study.about
    seconds = about["wall_seconds"]
    seeds = study.scores.groupby("scenario")["seeds"].max().value_counts()
    counts = ", ".join(f"{number} in {count} scenarios" for number, count in seeds.items())
    rows = [
        ["scenarios", str(study.scores["scenario"].nunique())],
        ["runs", f"{about['runs']:,}"],
        ["seeds", f"{counts}, from {about['first_seed']} on"],
        ["CPU time", f"{about['cpu_seconds'] / 3600:.2f} hours"],
        ["time by the clock", MISSING if seconds is None else f"{seconds / 3600:.2f} hours"],
        ["machine", f"{about['cpus']} CPUs; {'; '.join(about['environments'])}"],
        ["begun", about["started"][:10]],
        ["code", ", ".join(f"kswarms {code}" for code in about["code"])],
        ["command", "; ".join(about["commands"])],
    ]
    return f"## How it was played\n\n{_markdown(TextTable(['what', 'value'], rows, ''))}"


def _findings(study: Published) -> str:
    columns = ("verdict", "statement", "number")  # few, for narrow screens
    return "\n\n".join(
        [
            "## Findings",
            f"{count_verdicts(study.findings)}. A statement about chapter 6 *holds* or *fails* if the 95 % "
            "interval of its number is on one side of a bound. Otherwise it is *undecided*. "
            "[Findings](findings.md#the-findings-of-the-thesis) says more about them.",
            findings_markdown(study.findings, columns).replace(" … ", _UNBROKEN),
        ]
    )


def _errors(study: Published) -> str:
    rows = [
        [table.removeprefix("table-"), curve, str(cells), f"{error:.1f}"]
        for table, curve, cells, error in error_rows(study)
    ]
    if not rows:
        return "## Published tables\n\nThe study has no games for the tables of the thesis."
    return "\n\n".join(
        [
            "## Published tables",
            "The thesis gives numbers for Tables 6.1, 6.2 and 6.3: the percentage of robots that learned an "
            "action. The error is the mean of the absolute differences between measured and published "
            "percentages. The tables with all numbers are at the end of chapter 6 on this page.",
            _markdown(TextTable(["table", "curve", "cells", "error (points)"], rows, "")),
        ]
    )


def _argos(study: Published) -> Iterator[str]:
    """Yield the section of the comparison with ARGoS, if there is one."""
    frame = study.argos
    if frame.empty:
        return
    short = frame.assign(scenario=frame["scenario"].str.removeprefix("argos-"))
    score, share = (frame[f"{name}_difference"].abs() for name in ("score", "share"))
    yield "\n\n".join(
        [
            "## Comparison with ARGoS",
            "The same games were played in the simulator ARGoS 3. [Fidelity](fidelity.md) says when two "
            "numbers agree.",
            f"- Scores: {frame['score_fits'].sum()} of {len(frame)} agree. They differ by {score.mean():.1f} "
            f"pucks on average, and by {score.max():.1f} at most.\n"
            f"- Shares of time in conflict: {frame['share_fits'].sum()} of {len(frame)} agree. They differ "
            f"by {share.mean():.3f} on average, and by {share.max():.3f} at most.",
            _folded("Numbers of the comparison with ARGoS", argos_table(short)),
        ]
    )


def _chapter(study: Published, number: str, folder: Path, images: str) -> Iterator[str]:
    """Yield the parts of a chapter: its figures, then its tables."""
    tables = study.about["tables"]
    in_table = {scenario for entry in tables.values() for scenario in entry["scenarios"]}
    for name, title in study.about["scenarios"].items():
        if name.startswith(f"fig-{number}."):
            yield f"### {name}: {for_markdown(title)}"
            yield from _image(folder, images, name, "Means over N; the numbers are below.")
            frame = study.scores[study.scores["scenario"] == name]
            yield _folded(f"Numbers of {name}", scores_table(frame))
            cells = study.learned_in([name])
            if len(cells) and name not in in_table:
                yield _folded(f"What robots learned in {name}", learned_table(cells))
    for name, entry in tables.items():
        if name.startswith(f"table-{number}."):
            yield f"### {name}: {for_markdown(entry['title'])}"
            yield from _image(folder, images, name, "Shares of robots that learned an action, over N.")
            yield from _tables(study.learned_in(entry["scenarios"]))


def _tables(cells: pd.DataFrame) -> Iterable[str]:
    """Return a table for each curve: N, published and measured percentage, and their difference."""
    texts = []
    for name, curve in named_curves(cells):
        published = curve["published"].notna().any()
        table = learned_table(curve)
        texts.append(f"**{for_markdown(name)}**")
        if published:
            header = ["N", "published", "measured", "difference"]
            errors = curve.sort_values("n")["error"]
            rows = [
                [*row, MISSING if pd.isna(error) else f"{error:+.1f}"]
                for row, error in zip(table.rows, errors, strict=True)
            ]
            table = TextTable(header, rows, table.caption)
        else:
            table = TextTable(["N", "measured"], table.rows, table.caption)
        texts.append(_markdown(table))
    return texts


def _image(folder: Path, images: str, name: str, alt: str) -> Iterator[str]:
    """Yield the figure `name`, with a link to its file, if the folder has it."""
    if (folder / f"{name}.png").exists():
        file = f"{images}/{name}.png"
        yield f"[![{name}. {alt}]({file}){{ loading=lazy }}]({file})"


def _folded(title: str, table: TextTable) -> str:
    """Return a table that a reader unfolds by its title."""
    return f'??? note "{title}"\n\n{indent(_markdown(table), "    ")}'


def _markdown(table: TextTable) -> str:
    """Return a table in Markdown. Narrow screens do not break intervals, and the caption is one line."""
    one_line = replace(table, caption=table.caption.replace("\n", "; "))
    return one_line.to_markdown().rstrip().replace(" … ", _UNBROKEN)
