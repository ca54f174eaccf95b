"""The files of a published study, and the page that is made of them."""

import re
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from benchmarks.report import write_study
from kswarms.analysis.measures.learned import learned_shares, mean_absolute_error
from kswarms.analysis.report.published_files import Published, publish
from kswarms.analysis.report.published_page import error_rows, study_page
from kswarms.analysis.results.runs import Results, read_results
from kswarms.scenarios.catalogue import CATALOGUE, TABLES
from tests.helpers.result_rows import runs_of

PLAYED = ("fig-6.4a", "fig-6.4b", "fig-6.9", "fig-7.4", "argos-avoid-avoid")
TITLES = {name: CATALOGUE[name].title for name in CATALOGUE}
ABOUT: dict[str, Any] = {
    "runs": 1234,
    "first_seed": 0,
    "cpu_seconds": 5400,
    "wall_seconds": None,
    "started": "2026-01-02T03:04:05+00:00",
    "cpus": 2,
    "code": ["0.2.0 abc"],
    "environments": ["Python 3.11"],
    "commands": ["kswarms run --all"],
}


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Results:
    directory = tmp_path_factory.mktemp("results")
    write_study(directory, [CATALOGUE[name] for name in PLAYED], densities=2, seeds=6)
    return read_results(directory)


@pytest.fixture(scope="module")
def folder(results: Results, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("study")
    for old in ("fig-old.png", "old.csv", "notes.md"):
        (folder / old).write_text("")
    publish(results, folder, TITLES, TABLES, ABOUT)
    return folder


def test_the_folder_has_tables_and_small_figures_and_none_of_an_earlier_study(folder: Path) -> None:
    tables = {"about.json", "scores.csv", "learned.csv", "findings.csv", "argos.csv", "notes.md"}
    figures = {f"{name}.png" for name in (*PLAYED, "table-6.1", "table-7.1")}
    assert {path.name for path in folder.iterdir()} == tables | figures
    assert max(path.stat().st_size for path in folder.iterdir()) < 40_000


def test_the_numbers_are_those_of_the_results(folder: Path, results: Results) -> None:
    assert results.policies is not None
    study = Published.read(folder)
    assert study.about["scenarios"] == {name: TITLES[name] for name in PLAYED}
    cells = learned_shares(results.policies, ["fig-6.4a", "fig-6.4b"])
    read = study.learned_in(["fig-6.4a", "fig-6.4b"]).reset_index(drop=True)
    pd.testing.assert_frame_equal(read, cells, rtol=1e-5)
    rows = error_rows(study)
    assert [row[:3] for row in rows] == [("table-6.1", name, 2) for name in ("fig-6.4a", "fig-6.4b")] + [
        ("table-6.1", "all", 4)
    ]
    assert rows[-1][3] == pytest.approx(mean_absolute_error(cells), rel=1e-5)


def test_the_page_has_a_section_for_each_figure_and_table(folder: Path) -> None:
    page = study_page(folder, "study")
    sections = re.findall(r"^#+ (.*)$", page, re.MULTILINE)
    assert sections == [
        "How it was played",
        "Findings",
        "Published tables",
        "Comparison with ARGoS",
        "Symmetric swarms (chapter 6)",
        *(f"{name}: {TITLES[name]}" for name in ("fig-6.4a", "fig-6.4b", "fig-6.9")),
        f"table-6.1: {TABLES['table-6.1'].title}",
        "Disadvantaged learner (chapter 7)",
        f"fig-7.4: {TITLES['fig-7.4']}",
        f"table-7.1: {TABLES['table-7.1'].title}",
    ]
    for figure in ("fig-6.4a", "fig-7.4", "table-6.1"):
        assert f"](study/{figure}.png)" in page
    assert "| CPU time | 1.50 hours |" in page
    assert "| seeds | 6 in 5 scenarios, from 0 on |" in page
    assert "| time by the clock | – |" in page
    assert '??? note "What robots learned in fig-6.9"' in page
    assert '??? note "What robots learned in fig-6.4a"' not in page  # Table 6.1 has these numbers
    assert "| N | published | measured | difference |" in page


def test_a_study_without_learners_has_no_tables_of_them(tmp_path: Path) -> None:
    publish(Results(runs_of("fig-6.1a")), tmp_path, TITLES, TABLES, ABOUT)
    page = study_page(tmp_path, "study")
    assert "The study has no games for the tables of the thesis." in page
    assert "ARGoS" not in page
    assert "chapter 7" not in page
    (tmp_path / "fig-6.1a.png").unlink()
    assert "study/fig-6.1a.png" in page
    assert "study/fig-6.1a.png" not in study_page(tmp_path, "study")
