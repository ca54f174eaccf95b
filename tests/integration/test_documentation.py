"""The files, commands and code of the documentation run in the order of the text."""

import doctest
import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from contextlib import redirect_stdout
from importlib import import_module
from io import StringIO
from pathlib import Path
from pkgutil import resolve_name
from typing import Any

import pyarrow.parquet as pq
import pytest

from kswarms.analysis.findings import FINDINGS
from kswarms.scenarios.cli import invoke

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted(DOCS.glob("*.md"))]


def blocks(page: Path, *languages: str) -> Iterator[str]:
    """Yield the blocks of code of a page in their order."""
    for language, code in BLOCK.findall(page.read_text(encoding="utf-8")):
        if language in languages:
            yield code


def named_files(page: Path) -> dict[str, str]:
    """Return the blocks whose first line is the name of a file, by that name."""
    matches = (re.match(r"# (\w+\.\w+)\n", code) for code in blocks(page, "python", "toml"))
    return {match[1]: match.string for match in matches if match}


def follow(page: Path) -> list[str]:
    """Follow a page in its order: write files, run console commands and doctests. Return the commands."""
    commands: list[str] = []
    variables: dict[str, Any] = {}
    runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS)
    for code in blocks(page, "python", "toml", "console"):
        if match := re.match(r"# (append to )?(\w+\.\w+)\n", code):
            with Path(match[2]).open("a" if match[1] else "w") as file:
                file.write(code)
        elif code.startswith("$ "):
            for line in code.splitlines():
                program, *arguments = shlex.split(line.removeprefix("$ "))
                assert program == "kswarms"
                assert invoke([*arguments, "--jobs", "1"] if "run" in arguments else arguments) == 0
                commands.append(line)
        elif code.startswith(">>> "):
            examples = doctest.DocTestParser().get_doctest(code, variables, page.name, str(page), 0)
            runner.run(examples, clear_globs=False)
            variables = examples.globs
    assert runner.summarize().failed == 0
    return commands


@pytest.fixture(autouse=True)
def _in_an_empty_directory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(path or str(Path.cwd()) for path in sys.path))
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("example", sorted((DOCS / "examples").glob("*.py")), ids=lambda path: path.name)
def test_the_pages_show_the_examples_unchanged(example: Path) -> None:
    shown = [named_files(page)[example.name] for page in PAGES if example.name in named_files(page)]
    assert shown == [example.read_text(encoding="utf-8")]


@pytest.mark.slow
def test_the_tutorial_works_from_an_empty_directory() -> None:
    assert len(follow(DOCS / "tutorial.md")) == 3
    runs = pq.read_table("results/crowd/runs.parquet")
    assert set(runs["condition"].to_pylist()) == {"flee", "fight back", "cautious"}
    assert len(runs) == 3 * 2 * 2 * 2  # conditions, densities, seeds, swarms
    assert Path("results/crowd/figures/crowd.png").stat().st_size > 0


@pytest.mark.slow
def test_the_pages_on_scenarios_and_extending_work_after_the_tutorial() -> None:
    Path("cautious.py").write_text(named_files(DOCS / "tutorial.md")["cautious.py"])
    assert len(follow(DOCS / "scenarios.md")) == 2
    follow(DOCS / "extending.md")


@pytest.mark.slow
def test_the_scripts_and_tests_of_the_guides_run() -> None:
    readme, howto = named_files(ROOT / "README.md"), named_files(DOCS / "howto.md")
    assert readme["test_crowd.py"] == howto["test_crowd.py"]
    files = named_files(DOCS / "tutorial.md") | named_files(DOCS / "extending.md") | howto
    for name, code in (files | {"readme_sweep.py": readme["sweep.py"]}).items():
        Path(name).write_text(code)
    with redirect_stdout(StringIO()) as printed:  # one process; the sweep of the readme has two
        exec(howto["sweep.py"].replace("number_processes=2", "number_processes=1"), {"__name__": "__main__"})
    assert "pucks_2" in printed.getvalue()
    # As in a user's project: pytest runs outside this repository.
    tests = "-m pytest -q test_my_classes.py test_crowd.py"
    for arguments, expected in ((tests, "passed"), ("readme_sweep.py", "pucks_2")):
        command = [sys.executable, "-W", "error", *arguments.split()]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
        assert expected in done.stdout


def test_the_readme_and_the_page_of_findings_have_the_same_verdicts() -> None:
    page = (DOCS / "findings.md").read_text(encoding="utf-8")
    given = re.findall(r"\| \**(holds|fails|undecided)\** \|", page)
    holds, fails, undecided = map(given.count, ("holds", "fails", "undecided"))
    expected = f"of {len(given)} statements, {holds} hold, {fails} fail and {undecided} are undecided"
    assert len(given) == len(FINDINGS)
    assert expected in (ROOT / "README.md").read_text(encoding="utf-8")


def test_every_command_of_the_documentation_exists() -> None:
    commands = {
        match[1]
        for page in PAGES
        for code in blocks(page, "bash", "console")
        for match in re.finditer(r"^(?:\$ )?kswarms ([a-z]+)", code, re.MULTILINE)
    }
    assert {"list", "show", "run", "calibrate"} <= commands
    for command in sorted(commands):
        assert invoke([command, "--help"]) == 0


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_the_imports_shown_on_a_page_work(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    for module, names in re.findall(r"^(?:>>> )?from (kswarms[\w.]*) import ([\w, ]+)$", text, re.MULTILINE):
        for name in names.split(", "):
            assert hasattr(import_module(module), name) or import_module(f"{module}.{name}")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_the_code_that_a_page_names_exists(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    linked = re.findall(r"\(reference/\w+\.md#(kswarms\.[\w.]+)\)", text)
    quoted = re.findall(r"`(kswarms\.\w+\.[\w.]+)", BLOCK.sub("", text))
    for name in [*linked, *quoted]:
        assert resolve_name(name) is not None


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_no_page_is_longer_than_300_lines(page: Path) -> None:
    assert len(page.read_text(encoding="utf-8").splitlines()) <= 300


@pytest.mark.parametrize("page", PAGES[:2], ids=lambda page: page.name)
def test_the_paths_that_a_page_names_exist(page: Path) -> None:
    text = BLOCK.sub("", page.read_text(encoding="utf-8"))
    links = re.findall(r"\]\((?!https?:)([^)#]+)", text)
    quoted = re.findall(r"`((?:agents|model|scenarios|analysis|tests|docs|kswarms)/[\w./-]+)`", text)
    missing = [name for name in [*links, *quoted] if not (ROOT / name).exists()]
    assert missing == []


def test_the_picture_of_the_packages_shows_every_folder() -> None:
    picture = (DOCS / "images" / "rooms.svg").read_text(encoding="utf-8")
    drawn = re.findall(r'class="room"[^>]*>(\w+)<', picture)
    folders = [
        path.parent.name
        for package in ("agents", "model", "scenarios", "analysis")
        for path in (ROOT / package).glob("*/__init__.py")
    ]
    assert sorted(drawn) == sorted(folders)
