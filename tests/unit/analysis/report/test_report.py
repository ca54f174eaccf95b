"""Parts of a report: coverage, page, findings, recorded games, provenance."""

import json
import os
from functools import partial
from pathlib import Path
from urllib.parse import unquote

import pandas as pd
import pytest
from matplotlib.figure import Figure

from kswarms.agents.common.errors import InputError
from kswarms.analysis.findings import Verdict
from kswarms.analysis.report.coverage import PlannedScenario, coverage, coverage_table
from kswarms.analysis.report.page import Chapter, Part, Report
from kswarms.analysis.report.provenance import directory_parts, libraries_part
from kswarms.analysis.report.record_parts import conflict_parts, recorded_conditions
from kswarms.analysis.report.scenario_parts import argos_parts, verdicts_part
from kswarms.analysis.text_tables import TextTable
from kswarms.model.description.arena import Arena, build_arena
from tests.helpers.html_page import Page
from tests.helpers.result_rows import MET, runs_of

PLAN = {
    "fig-x": PlannedScenario("x", ("",), (6, 16), 4),
    "fig-y": PlannedScenario("y", ("a", "b"), (6, 16, 26), 4),
    "fig-z": PlannedScenario("z", ("",), (6,), 20),
}


def test_coverage_counts_planned_games_and_describes_missing_ones() -> None:
    part = runs_of("fig-y", conditions=("a",), densities=(6, 16), seeds=3)
    rows = coverage(pd.concat([runs_of("fig-x"), part]), PLAN).to_dict("records")
    assert rows == [
        {"scenario": "fig-x", "games": 8, "planned": 8, "missing": ""},  # N = 26 is not planned
        {"scenario": "fig-y", "games": 6, "planned": 24, "missing": "conditions b; N = 26; seeds (3 of 4)"},
        {"scenario": "fig-z", "games": 0, "planned": 20, "missing": "everything"},
    ]


def test_coverage_describes_irregular_gaps() -> None:
    runs = runs_of("fig-y", conditions=("a", "b"), densities=(6, 16, 26))
    first = runs["condition"] == "a"
    for some, missing in (
        (runs[first | (runs["n"] == 6) | (runs["seed"] < 2)], "seeds (2 to 4 of 4)"),
        (runs[first | (runs["n"] > 6)], "some conditions at some N"),
    ):
        assert coverage(some, {"fig-y": PLAN["fig-y"]})["missing"].tolist() == [missing]


def test_the_table_of_missing_games_has_incomplete_scenarios_and_a_caption() -> None:
    table = coverage_table(coverage(pd.concat([runs_of("fig-x"), runs_of("fig-y", conditions=("a",))]), PLAN))
    assert table.rows == [["fig-y", "12", "24", "conditions b"]]
    assert table.caption == "1 of 3 scenarios are complete, 1 in part; not played: fig-z."
    whole = coverage_table(coverage(runs_of("fig-x"), {"fig-x": PLAN["fig-x"]}))
    assert (whole.rows, whole.caption) == ([], "1 of 1 scenarios are complete, 0 in part.")


def a_report() -> Report:
    part = Part("one", "One & only", ["text <b>"], preformatted="a = 1\nb = 2")
    drawing = Figure(figsize=(9, 2))
    drawing.subplots()
    part.add_figure("curve", drawing, 'alt "quoted"', "caption")
    table = TextTable(["N", "x"], [["6", "1.0"]], "below")
    part.add_table("numbers", "Numbers", table, pd.DataFrame({"N": [6], "x": [1.25]}))
    chapters = [Chapter("first", "First", [part]), Chapter("second", "Second", [Part("second", "Second")])]
    return Report("A title", ["summary"], chapters)


def test_a_page_is_self_contained_and_its_links_are_valid() -> None:
    html = a_report().to_html()
    page = Page(html)
    assert len(page.ids) == len(set(page.ids))
    assert {"content", "first", "one", "second"} <= set(page.ids)
    inner = [link for link in page.links if link.startswith("#")]
    assert set(inner) == {"#content", "#first", "#one", "#second"}
    assert all(address.startswith(("#", "data:")) for address in page.addresses)
    (image,) = page.images
    assert image["alt"] == 'alt "quoted"'
    assert "text &lt;b&gt;" in html
    assert "One &amp; only" in html
    assert "<script" not in html
    assert 'class="wide"' in html
    downloads = [unquote(link.partition(",")[2]) for link in page.links if link.startswith("data:")]
    assert downloads == ['"N","x"\n6,1.25\n', "| N | x |\n|--:|--:|\n| 6 | 1.0 |\n\nbelow\n"]


def test_page_and_files_are_written_or_an_error_is_raised(tmp_path: Path) -> None:
    report = a_report()
    report.write_page(tmp_path / "page.html")
    assert (tmp_path / "page.html").read_text() == report.to_html()
    assert report.write_files(tmp_path / "a" / "b") == 5
    names = {path.name for path in (tmp_path / "a" / "b").iterdir()}
    assert names == {".kswarms-report", "curve.png", "curve.svg", "numbers.csv", "numbers.md", "numbers.html"}
    with pytest.raises(InputError, match=r"out=.*must be a file, not a directory"):
        report.write_page(tmp_path)
    with pytest.raises(InputError, match=r"files=.*must be a writable directory"):
        report.write_files(tmp_path / "page.html")


def test_files_of_others_are_not_replaced(tmp_path: Path) -> None:
    mine = tmp_path / "thesis" / "numbers.csv"
    mine.parent.mkdir()
    mine.write_text("my numbers")
    with pytest.raises(InputError, match="or one that kswarms wrote; it has 'numbers"):
        a_report().write_files(mine.parent)
    assert [path.read_text() for path in mine.parent.iterdir()] == ["my numbers"]
    mine.unlink()
    (mine.parent / ".DS_Store").touch()  # hidden files of a file manager do not count
    assert a_report().write_files(mine.parent) == 5
    assert a_report().write_files(mine.parent) == 5, "files of an earlier report are replaced"


def test_verdicts_are_counted_and_marked() -> None:
    verdicts = [
        Verdict("a", "A holds.", "holds", 1.234, 0.5, 2.0, "pucks", 20, ""),
        Verdict("b", "B fails.", "fails", -1.0, None, -0.25, "pucks", 20, "at N = 6"),
        Verdict("c", "C is unknown.", "undecided", 1.0, None, None, "pucks", 3, "too few"),
        Verdict("d", "D was not played.", "no data", note="no runs"),
    ]
    part = verdicts_part(verdicts)
    assert part.text[0] == "4 findings: 1 holds, 1 fails, 1 undecided, 1 no data."
    (table,) = part.tables
    assert [row[3] for row in table.table.rows] == ["1.23 (0.5 … 2)", "-1 (… … -0.25)", "1", "–"]
    html = table.table.to_html()
    assert '<td class="holds">holds</td>' in html
    assert '<td class="fails">fails</td>' in html
    assert list(table.frame["finding"]) == ["a", "b", "c", "d"]


def test_argos_is_compared_at_common_densities() -> None:
    assert list(argos_parts(runs_of("fig-x"))) == []
    assert list(argos_parts(runs_of("argos-avoid-avoid", densities=[50]))) == []  # not played in ARGoS
    ((chapter, part),) = argos_parts(runs_of("argos-avoid-avoid", densities=[16]))
    assert chapter == "argos-"
    assert part.text[1].startswith("Scores agree in ")
    assert len(part.tables[0].table.rows) == 2


def test_a_shared_game_belongs_to_the_first_condition(tmp_path: Path) -> None:
    first = runs_of("fig-b", conditions=("x", "y"))
    runs = pd.concat([first, first[first["condition"] == "x"].assign(scenario="fig-a")])
    wanted = runs[runs["n"] == 16]["run"].unique()
    pd.DataFrame({"run": wanted}).to_parquet(tmp_path / "conflicts.parquet")
    conflicts = recorded_conditions(tmp_path, "conflicts", runs)
    assert [(each.scenario, each.condition) for each in conflicts] == [("fig-b", "x"), ("fig-b", "y")]
    assert [each.id for each in conflicts] == ["fig-b--x", "fig-b--y"]
    assert conflicts[0].densest["seed"].tolist() == [0, 1, 2, 3]
    assert recorded_conditions(tmp_path, "robots", runs) == []


def test_random_stations_are_not_drawn_into_the_common_map(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    runs = runs_of("fig-x", densities=[16], seeds=2)
    games = [MET.assign(run=run) for run in runs["run"].unique()]
    pd.concat(games).to_parquet(tmp_path / "conflicts.parquet")
    (condition,) = recorded_conditions(tmp_path, "conflicts", runs)
    shown: list[bool] = []

    def heat_map_figure(conflicts: pd.DataFrame, title: str, arena: Arena | None) -> Figure:
        shown.append(arena is not None)
        return Figure()

    monkeypatch.setattr("kswarms.analysis.figures.heat_maps.heat_map_figure", heat_map_figure)
    for layout in ("symmetric", "random-stations"):
        arena = partial(build_arena, layout, 2, 2.0, 0.16, 0.17)
        chapters = conflict_parts(tmp_path, condition, lambda *key, arena=arena: arena(key[-1]))
        assert [chapter for chapter, _ in chapters] == ["networks", "maps"]
    assert shown == [True, False]


def test_provenance_without_a_manifest(tmp_path: Path) -> None:
    runs_of("fig-x").to_parquet(tmp_path / "runs.parquet")
    files, manifest = directory_parts(tmp_path)
    assert files.tables[0].table.rows[0][:2] == ["runs.parquet", "24"]
    assert "matplotlib 3." in libraries_part().text[0]
    assert "no manifest.json" in manifest.text[0]


def test_provenance_shows_the_manifest(tmp_path: Path) -> None:
    runs_of("fig-x").to_parquet(tmp_path / "runs.parquet")
    content = {
        "kswarms": "0.1.0",
        "code": "abc",
        "scenarios": {"fig-x": 'id = "fig-x"\nseeds = 4\n'},
        "libraries": {"numpy": "2.4"},
        "sessions": [{"command": "kswarms run fig-x"}],
        "empty": [],
    }
    (tmp_path / "manifest.json").write_text(json.dumps(content))
    _, manifest, *others = directory_parts(tmp_path)
    assert manifest.preformatted.splitlines() == ["kswarms: 0.1.0", "code: abc", "empty: []"]
    assert [part.id for part in others] == ["manifest-scenarios", "manifest-libraries", "manifest-sessions"]
    assert others[0].preformatted == '# fig-x\nid = "fig-x"\nseeds = 4'
    assert others[1].preformatted == "numpy: 2.4"
    assert json.loads(others[2].preformatted) == content["sessions"]


@pytest.mark.parametrize(
    ("text", "allowed"),
    [("{", "a JSON file"), ("[" * 100_000, "a JSON file"), ("[1]", "a JSON object")],
    ids=["truncated", "nested", "list"],
)
def test_an_invalid_manifest_is_an_error(tmp_path: Path, text: str, allowed: str) -> None:
    (tmp_path / "manifest.json").write_text(text)
    with pytest.raises(InputError, match=f"manifest.json': must be {allowed}"):
        directory_parts(tmp_path)


def test_pipes_and_lone_surrogates_in_a_results_directory(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.parquet")  # reading it would block
    (tmp_path / "manifest.json").write_text('{"command": "kswarms run caf\\udce9", "all": {"a": "\\ud800"}}')
    files, *manifest = directory_parts(tmp_path)
    assert files.tables[0].table.rows == []
    Report("r", [], [Chapter("c", "C", manifest)]).write_page(tmp_path / "page.html")
    assert "caf\\udce9" in (tmp_path / "page.html").read_text()
    (tmp_path / "manifest.json").unlink()
    os.mkfifo(tmp_path / "manifest.json")
    with pytest.raises(InputError, match=r"manifest.json': must be a regular file"):
        directory_parts(tmp_path)
