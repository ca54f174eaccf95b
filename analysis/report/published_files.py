"""A published study: small files with the numbers and figures of results, for documentation.

The tables are CSV files, the figures PNG files with a palette. `published_page` makes a page of them without
the results. An incomplete study gives fewer rows and figures.
"""

import json
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Self

import pandas as pd

from kswarms.agents.common.errors import InputError
from kswarms.analysis.figures.files import encode_small, write_file
from kswarms.analysis.figures.over_n import figure_of, learned_over_n
from kswarms.analysis.figures.style import heading
from kswarms.analysis.findings import FINDINGS, Finding, judge_all
from kswarms.analysis.measures.learned import learned_shares
from kswarms.analysis.results.runs import Results
from kswarms.analysis.tables.fidelity import compare_with_argos
from kswarms.analysis.tables.findings import verdict_rows
from kswarms.analysis.tables.scores import scores

ABOUT_FILE: Final = "about.json"
TABLES: Final = ("scores", "learned", "findings", "argos")
"""Names of the CSV files, in the order of the attributes of `Published`."""
SourceTables = Mapping[str, tuple[str, Sequence[str]]]
"""Title and scenarios of each table of the source, by table id."""


@dataclass(frozen=True)
class Published:
    """The files of a published study.

    Attributes
    ----------
    about : dict
        ``scenarios``: titles by scenario id; ``tables``: title and scenarios of each table of the source, by
        table id; and the entries that the caller of `publish` gave.
    scores : pandas.DataFrame
        `kswarms.analysis.tables.scores.scores` of each scenario, with the column `scenario`.
    learned : pandas.DataFrame
        Result of `kswarms.analysis.measures.learned.learned_shares`, empty if no swarm learned.
    findings : pandas.DataFrame
        Result of `kswarms.analysis.tables.findings.verdict_rows`.
    argos : pandas.DataFrame
        Result of `kswarms.analysis.tables.fidelity.compare_with_argos`, empty without comparable games.
    """

    about: dict[str, Any]
    scores: pd.DataFrame
    learned: pd.DataFrame
    findings: pd.DataFrame
    argos: pd.DataFrame

    @classmethod
    def read(cls, folder: Path) -> Self:
        """Read the files in a folder that `publish` wrote."""
        about = json.loads((folder / ABOUT_FILE).read_text(encoding="utf-8"))
        texts = dict.fromkeys(("scenario", "condition", "curve", "unit", "note"), str)
        frames = []
        for table in TABLES:
            path = folder / f"{table}.csv"
            frame = pd.read_csv(path, dtype=texts) if path.exists() else pd.DataFrame()
            frames.append(frame.fillna({name: "" for name in texts if name in frame}))
        return cls(about, *frames)

    def learned_in(self, scenarios: Sequence[str]) -> pd.DataFrame:
        """Return the rows of `learned` of some scenarios; it may be empty."""
        return self.learned[self.learned["scenario"].isin(scenarios)] if len(self.learned) else self.learned


def publish(
    results: Results,
    folder: Path,
    titles: Mapping[str, str],
    tables: SourceTables,
    about: Mapping[str, Any],
    findings: Sequence[Finding] = FINDINGS,
) -> None:
    """Write the files of a published study. CSV and PNG files of an earlier one in the folder are removed.

    Parameters
    ----------
    results : Results
        Outcomes of the study.
    folder : Path
        Folder of the files; it is created if it does not exist.
    titles : mapping of str to str
        Title of each scenario to publish, by id, in the order of the page. Scenarios without runs are
        skipped.
    tables : mapping of str to (str, sequence of str)
        Title and scenarios of each table of the source, by table id.
    about : mapping of str to object
        Further entries of ``about.json``: where, when and how the study was played.
    findings : sequence of Finding
        Findings to judge.

    Raises
    ------
    InputError
        A file cannot be written.
    """
    for old in (*folder.glob("*.csv"), *folder.glob("*.png")):
        old.unlink()
    present = set(results.runs["scenario"])
    played = {name: title for name, title in titles.items() if name in present}
    parts = [scores(results.runs, name).assign(scenario=name) for name in played]
    _write_csv(folder / "scores.csv", pd.concat(parts, ignore_index=True))
    _write_csv(folder / "findings.csv", verdict_rows(judge_all(results, findings)))
    with suppress(InputError):  # no comparable games
        _write_csv(folder / "argos.csv", compare_with_argos(results.runs))
    for name, title in played.items():
        write_file(folder / f"{name}.png", encode_small(figure_of(results.runs, name, title)), "folder")
    complete: dict[str, dict[str, Any]] = {}
    if results.policies is not None:
        learners = set(results.policies["scenario"])
        learned = [name for name in played if name in learners]
        _write_csv(folder / "learned.csv", learned_shares(results.policies, learned))
        for name, (title, scenarios) in tables.items():
            if learners.issuperset(scenarios):
                complete[name] = {"title": title, "scenarios": list(scenarios)}
                cells = learned_shares(results.policies, scenarios)
                figure = learned_over_n(cells, heading(name, title))
                write_file(folder / f"{name}.png", encode_small(figure), "folder")
    content = {**about, "scenarios": played, "tables": complete}
    text = json.dumps(content, indent=1, ensure_ascii=False) + "\n"
    write_file(folder / ABOUT_FILE, text.encode(), "folder")


def _write_csv(path: Path, frame: pd.DataFrame) -> None:
    write_file(path, frame.to_csv(index=False, float_format="%.6g").encode(), "folder")
