"""Names that would leave a folder, control a terminal, or run in a spreadsheet or page."""

import csv
import sqlite3
from pathlib import Path

import pandas as pd
import pytest

from kswarms.agents.common.quoting import for_file_name
from kswarms.analysis.figures.files import EncodedFigure
from kswarms.analysis.figures.over_n import write_figures
from kswarms.analysis.results.runs import Results
from kswarms.scenarios.cli import invoke
from kswarms.scenarios.cli.printing import print_table
from tests.helpers.html_page import Page
from tests.helpers.result_rows import MET, runs_of
from tests.helpers.tiny_study import PLAIN_RUN, TINY

NAMES = (
    "../../escaped",
    "/escaped",
    ".escaped",
    "=HYPERLINK(1)",
    "@x;=1+1",
    "<img src=x onerror=alert(1)>|[a](b)`c`",
    '" onload="alert(1)',
    "x" * 5000,
    "x" * 5000 + "y",
    "provenance",  # the anchor of a chapter
    "findings",
    "coverage",  # the name of another table
    "a b",
    "a-b",
)


@pytest.fixture
def _no_drawing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Replace the content of figures, which takes long to draw."""
    empty = EncodedFigure({"png": b"", "svg": b""}, 1, 1)
    monkeypatch.setattr("kswarms.analysis.report.page.encode_all", lambda _figure: empty)


@pytest.mark.usefixtures("empty_directory", "_no_drawing")
def test_a_report_stays_in_its_folder_and_quotes_names() -> None:
    here = Path("a/b/results")
    here.mkdir(parents=True)
    runs = [
        runs_of(name, swarms=(2,), conditions=[name, "b"], densities=[6], seeds=1).assign(run=f"r{k}")
        for k, name in enumerate(NAMES)
    ]
    pd.concat(runs).to_parquet(here / "runs.parquet")
    conflicts = [MET.assign(run=f"r{k}", action=name) for k, name in enumerate(NAMES)]
    pd.concat(conflicts).to_parquet(here / "conflicts.parquet")
    before = set(Path.cwd().rglob("*"))
    assert invoke(["report", str(here), "--files", "a/b/files"]) == 0
    written = set(Path.cwd().rglob("*")) - before
    files = {path for path in written if path.parent == Path.cwd() / "a/b/files"}
    assert written - files == {Path.cwd() / "a/b/files", Path.cwd() / "a/b/results/report.html"}
    assert {f"{for_file_name(name)}.png" for name in NAMES} <= {path.name for path in files}
    assert len([path for path in files if path.name.startswith("jams-")]) == 2 * len(NAMES)

    page = Page((here / "report.html").read_text(encoding="utf-8"))
    assert len(page.ids) == len(set(page.ids))
    assert not any(len(anchor.split()) != 1 for anchor in page.ids)
    assert {link[1:] for link in page.links if link.startswith("#")} <= set(page.ids)
    assert not {attribute for attribute in page.attributes if attribute.startswith("on")}

    cells = [cell for path in files if path.suffix == ".csv" for row in _rows(path) for cell in row]
    formulas = [cell for cell in cells if cell[:1] in set("=+-@")]
    assert "'=HYPERLINK(1)" in cells
    assert "'@x;=1+1" in cells
    assert [cell for cell in formulas if not cell[1:].replace(".", "").isdigit()] == []
    markdown = [path.read_text(encoding="utf-8") for path in files if path.suffix == ".md"]
    assert not any("<img" in text.replace("\\<", "") for text in markdown)


def _rows(path: Path) -> list[list[str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.reader(file))


def test_figures_are_named_after_hostile_scenarios_in_their_folder(tmp_path: Path) -> None:
    names = [r"../$\frac$ [red]", "$$ {", "\\alpha" * 1000]
    runs = pd.concat([runs_of(name, densities=[6], seeds=1, conditions=[name, "b"]) for name in names])
    paths = write_figures(Results(runs), tmp_path / "figures")
    assert sorted(paths) == sorted(tmp_path.rglob("*.png"))
    assert {path.parent for path in paths} == {tmp_path / "figures"}


@pytest.mark.usefixtures("tiny_file")
def test_status_escapes_control_characters_of_a_ledger(capsys: pytest.CaptureFixture[str]) -> None:
    directory = "two\nlines $(x)"
    tiny = TINY.replace(seeds=1, densities=(4,), conditions=TINY.conditions[:1])
    Path("tiny.toml").write_text(tiny.to_toml())
    assert invoke([*PLAIN_RUN, "--out", directory]) == 0
    with sqlite3.connect(Path(directory, "ledger.sqlite")) as ledger:
        ledger.execute("UPDATE points SET scenario = ?, condition = ?", ("\x1b[31m\ngone", "\u202e\x9b"))
        trace = '  File "x\x1b[0m", line 1\n    \x07'
        ledger.execute("UPDATE runs SET error = ?, traceback = ?, code = ?", ("\x1b]0;x\x07", trace, "\x1b"))
    assert invoke(["status", directory]) == 0
    printed = capsys.readouterr().out
    assert all(line.isprintable() for line in printed.splitlines())
    assert "\\x1b[31m\\ngone" in printed
    assert "again: kswarms replay $'two\\x0alines $(x)' " in printed


def test_names_are_not_markup_of_the_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    print_table("[red]title[/red]", ["[b]", "two\nlines"], [["[/]", ":boom: \x1b[2J"]], "[bold]below")
    printed = capsys.readouterr().out
    for text in ("[red]title[/red]", "[b]", "[/]", ":boom: \\x1b[2J", "[bold]below"):
        assert text in printed
