"""The script that publishes a study; the README and the documentation give the numbers in ``docs/study``."""

import json
from pathlib import Path

import pytest

from kswarms.analysis.report.published_files import Published
from kswarms.analysis.report.published_page import study_page
from kswarms.analysis.results.runs import read_results
from kswarms.scenarios.cli import invoke
from tests.helpers.scripts import load_script
from tests.helpers.tiny_study import PLAIN_RUN, TINY

ROOT = Path(__file__).parents[2]
script = load_script(ROOT / "docs" / "study.py")


@pytest.mark.parametrize("name", script.TEXTS)
def test_a_text_gives_the_numbers_of_the_published_study(name: str) -> None:
    mark, make = script.TEXTS[name]
    text = (ROOT / name).read_text(encoding="utf-8")
    assert script.update(text, mark, make(Published.read(script.FOLDER))) == text


def test_the_page_is_built_from_the_files_of_the_published_study() -> None:
    pytest.importorskip("mkdocs", reason="needs the extra `docs`")
    from tests.unit.test_build_pages import pages

    page = type("Page", (), {"file": type("File", (), {"src_uri": "what_came_out.md"})})
    built = pages.on_page_markdown("# What came out\n", page=page)
    assert built == f"# What came out\n\n{study_page(script.FOLDER, 'study')}"
    study = Published.read(script.FOLDER)
    for name, title in study.about["scenarios"].items():
        assert f"### {name}: {title}" in built or name.startswith("argos-")
    assert all(statement in built for statement in study.findings["statement"])
    page.file.src_uri = "index.md"
    assert pages.on_page_markdown("# Start\n", page=page) == "# Start\n"


def test_the_marks_must_be_there_once() -> None:
    text = "a\n<!-- m -->\nold\n<!-- end -->\nb"
    assert script.update(text, "m", "new") == text.replace("old", "new")
    with pytest.raises(ValueError, match="'other' must be there once"):
        script.update(text, "other", "new")


def test_the_published_files_are_small_and_have_no_absolute_path() -> None:
    files = list(script.FOLDER.iterdir())
    assert sum(path.stat().st_size for path in files) < 1_500_000
    assert "/" not in "".join(json.loads((script.FOLDER / "about.json").read_text())["commands"])


@pytest.mark.slow
def test_a_study_is_described_by_its_ledger_and_manifest(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("tiny.toml").write_text(TINY.to_toml())
    assert invoke([*PLAIN_RUN, "--out", str(tmp_path / "played")]) == 0
    about = script.describe(tmp_path / "played")
    assert about["runs"] == read_results(tmp_path / "played").runs["run"].nunique() == 40
    assert about["first_seed"] == 0
    assert about["cpu_seconds"] >= 0
    assert about["wall_seconds"] >= 0
    assert about["commands"][0].endswith("--out played")
