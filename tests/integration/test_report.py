"""The command `report`: content, errors, and display in a browser."""

from collections.abc import Iterator
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

import mesa
import pytest

from benchmarks import report as study
from kswarms.analysis.figures.over_n import write_figures
from kswarms.analysis.report import build_report
from kswarms.model.foraging import ForagingModel
from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.cli import invoke
from kswarms.scenarios.study.study import Study
from tests.helpers.browser import needs_browser, open_browser
from tests.helpers.html_page import Page
from tests.helpers.result_rows import MET, robots, runs_of

# Two swarms, panels, a table of the source, three swarms, the comparison with ARGoS.
SHUSER_FINDING = ("fig-6.1c", "fig-6.3", "fig-6.4a", "fig-7.10", "argos-avoid-attack")
USER_FINDING = """
[[findings]]
id = "mine"
statement = "Attackers score more."
[findings.claim]
kind = "compare"
left = { scenario = "fig-6.1c", swarm = 2 }
relation = ">"
right = { scenario = "fig-6.1c", swarm = 1 }
over = "mean over N"
"""


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a directory with random outcomes of some scenarios."""
    directory = tmp_path_factory.mktemp("my <results>")
    study.write_study(directory, [CATALOGUE[name] for name in SHUSER_FINDING], densities=3, seeds=7)
    return directory


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a directory with two short games of a learner, with conflicts and robots recorded."""
    scenario = CATALOGUE["fig-6.4b"]
    condition = scenario.conditions[0].replace(learning=30, duration=30)
    short = scenario.replace(conditions=(condition,), densities=(10,), seeds=2)
    directory = tmp_path_factory.mktemp("recorded")
    with Study(directory) as played:
        assert len(list(played.play(played.plan([short]), records=["conflicts", "robots"]))) == 2
    return directory


@pytest.fixture(scope="module")
def page_of_results(results: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """Return the report on the random outcomes and a user's finding, and what the command prints.

    Its tables and figures are in the directory ``files`` beside it.
    """
    directory = tmp_path_factory.mktemp("pages")
    findings, out = directory / "own.toml", directory / "page.html"
    findings.write_text(USER_FINDING)
    words = ["report", results, "--out", out, "--findings", findings, "--files", directory / "files"]
    with redirect_stdout(StringIO()) as printed:
        assert invoke(list(map(str, words))) == 0
    return out, printed.getvalue()


@pytest.fixture(scope="module")
def page_of_records(recorded: Path) -> Path:
    """Return the report on the recorded games."""
    assert invoke(["report", str(recorded)]) == 0
    return recorded / "report.html"


@pytest.fixture
def pages(page_of_results: tuple[Path, str], page_of_records: Path) -> dict[str, Path]:
    """Return both reports."""
    return {"results": page_of_results[0], "recorded": page_of_records}


def test_a_report_shows_all_results(page_of_results: tuple[Path, str]) -> None:
    out, printed = page_of_results
    assert [line.split()[:2] for line in printed.splitlines()] == [
        ["files:", str(out.parent / "files")],
        ["report:", str(out)],
    ]
    html = out.read_text()
    page = Page(html)
    assert set(SHUSER_FINDING) <= set(page.ids)
    assert {"table-6.1", "argos", "findings", "missing-games", "provenance"} <= set(page.ids)
    assert "fig-6.2" not in page.ids
    assert "not played: fig-6.1a, fig-6.1b, fig-6.2," in html
    assert "N = 20, 26, 30, 36, 40, 46, 50; seeds (7 of 20)" in html
    assert "Report on my &lt;results&gt;" in html
    assert len(page.ids) == len(set(page.ids))
    assert all(link[1:] in page.ids for link in page.links if link.startswith("#"))
    assert all(address.startswith(("#", "data:")) for address in page.addresses)
    assert all(image["alt"] for image in page.images)
    # Two figures of each scenario and one more of each learner.
    assert len(page.images) == 2 * len(SHUSER_FINDING) + 2
    assert "Attackers score more." in html
    assert "published" in html
    files = {path.name for path in (out.parent / "files").iterdir()}
    assert {"fig-6.1c.svg", "fig-6.1c-source.png", "fig-6.4a-learned.svg"} <= files
    assert {"table-6.1.md", "argos.csv"} <= files


def test_the_same_results_give_the_same_report(recorded: Path, page_of_records: Path, tmp_path: Path) -> None:
    assert invoke(["report", str(recorded), "--out", str(tmp_path / "again.html")]) == 0
    assert (tmp_path / "again.html").read_bytes() == page_of_records.read_bytes()


def test_recorded_games_have_their_chapters(page_of_records: Path) -> None:
    page = Page(page_of_records.read_text())
    assert {f"{part}-fig-6-4b" for part in ("network", "emergence", "robots", "map")} <= set(page.ids)
    assert len(page.images) == 3 + 2 + 2 + 1 + 1


def test_user_defined_scenarios_have_their_own_chapter(tmp_path: Path) -> None:
    runs = runs_of("hunt", densities=[16], seeds=1)
    runs.to_parquet(tmp_path / "runs.parquet")
    MET.assign(run=runs["run"].iloc[0]).to_parquet(tmp_path / "conflicts.parquet")
    robots()[:1].assign(run=runs["run"].iloc[0]).to_parquet(tmp_path / "robots.parquet")  # not a learner
    assert invoke(["report", str(tmp_path)]) == 0
    page = Page((tmp_path / "report.html").read_text())
    assert {"other-scenarios", "hunt", "network-hunt", "map-hunt"} <= set(page.ids)
    assert len(page.images) == 2 + 2 + 1


def test_rows_of_a_batch_run_can_be_drawn_and_reported(tmp_path: Path) -> None:
    games = {"n": [4, 8], "policies": ["avoid,attack", "avoid,avoid"], "seed": range(2), "duration": 10.0}
    rows = mesa.batch_run(ForagingModel, games, number_processes=1, display_progress=False)
    assert write_figures(rows, tmp_path) == [tmp_path / "sweep.png"]
    report = build_report(rows)
    assert [chapter.title for chapter in report.chapters] == ["Other scenarios", "Provenance"]
    assert len(Page(report.to_html()).images) == 2


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ("nowhere", "results='nowhere': must be a directory that `kswarms run` wrote"),
        ("empty", "results='empty': must be a directory that holds runs.parquet"),
        ("broken", "results='broken/runs.parquet': must be a readable Parquet file"),
        ("corrupt", "results='corrupt/conflicts.parquet': must be a readable Parquet file"),
        ("good --out nowhere/a.html", "out='nowhere/a.html': must be a writable file (No such file"),
        ("good --out empty", "out='empty': must be a file, not a directory"),
        ("good --findings none.toml", "findings='none.toml': must be a readable file (No such file"),
        ("good --findings taken.toml", "findings.id='6.1a-alike': must differ from those of the thesis"),
        ("good --files good/runs.parquet", "files='good/runs.parquet': must be a writable directory"),
    ],
)
def test_errors_are_one_line_and_write_nothing(
    words: str, line: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("empty", "broken", "corrupt", "good"):
        Path(name).mkdir()
    Path("broken/runs.parquet").write_bytes(b"PAR1")
    Path("taken.toml").write_text(USER_FINDING.replace('id = "', 'id = "6.1a-alike" # "'))
    for name in ("corrupt", "good"):
        study.write_study(Path(name), [CATALOGUE["fig-6.1a"]], densities=2, seeds=1)
    Path("corrupt/conflicts.parquet").write_bytes(b"PAR1")
    before = sorted(tmp_path.rglob("*"))
    assert invoke(["report", *words.split()]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.splitlines()[-1].startswith(f"kswarms: {line}")
    assert sorted(tmp_path.rglob("*")) == before


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """Start a headless Chromium that logs the messages of pages."""
    with open_browser() as driver:
        yield driver


def open_at(browser: Any, path: Path, width: int, dark: bool = False) -> None:
    size = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 500}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [scheme]})
    browser.get(path.resolve().as_uri())


def problems(browser: Any) -> dict[str, Any]:
    """Return the problems of the current page."""
    found: dict[str, Any] = browser.execute_script("""
        const page = document.documentElement;
        return {
            broken: [...document.images].filter(i => !(i.complete && i.naturalWidth > 0)).map(i => i.alt),
            overflow: page.scrollWidth - page.clientWidth,  // innerWidth grows with the overflow
            unlabelled: [...document.querySelectorAll("table")].filter(
                t => !t.querySelector("thead th[scope=col]")).length,
        };
    """)
    return found | {"console": browser.get_log("browser")}


@needs_browser
@pytest.mark.parametrize("width", [1280, 390])
@pytest.mark.parametrize("source", ["results", "recorded"])
def test_a_browser_shows_the_report_without_problems(
    browser: Any, source: str, width: int, pages: dict[str, Path]
) -> None:
    open_at(browser, pages[source], width)
    assert problems(browser) == {"broken": [], "overflow": 0, "unlabelled": 0, "console": []}
    assert browser.execute_script("return document.images.length") > 5


@needs_browser
def test_the_page_has_a_dark_colour_scheme(browser: Any, page_of_records: Path) -> None:
    colours = []
    for dark in (False, True):
        open_at(browser, page_of_records, 1280, dark)
        colours.append(browser.execute_script("return getComputedStyle(document.body).backgroundColor"))
    assert colours == ["rgb(255, 255, 255)", "rgb(22, 24, 27)"]


@needs_browser
def test_problems_of_a_broken_page_are_found(browser: Any, tmp_path: Path) -> None:
    path = tmp_path / "broken.html"
    path.write_text(
        "<!doctype html><meta name=viewport content='width=device-width, initial-scale=1'>"
        "<link rel=icon href=data:,><img alt=gone src='data:image/png;base64,AAAA'>"
        "<div style='width: 900px'>wide</div><table><tr><td>1</td></tr></table>"
        "<script>console.error('oh')</script>"
    )
    open_at(browser, path, 390)
    found = problems(browser)
    assert found["broken"] == ["gone"]
    assert found["overflow"] > 400
    assert found["unlabelled"] == 1
    assert "oh" in found["console"][-1]["message"]
