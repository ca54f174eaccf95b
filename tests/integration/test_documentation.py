"""The documentation does what it says: its files and commands are tried in the order of the text."""

import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from kswarms.analysis.findings import FINDINGS
from kswarms.scenarios.cli import invoke

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
PAGES = [ROOT / "README.md", *sorted(DOCS.glob("*.md"))]


def blocks(page: Path, *languages: str) -> Iterator[str]:
    """Return the blocks of code of a page in their order."""
    for language, code in BLOCK.findall(page.read_text(encoding="utf-8")):
        if language in languages:
            yield code


def named(page: Path) -> dict[str, str]:
    """Return the blocks whose first line is the name of a file, by that name."""
    codes = (re.match(r"# (\w+\.\w+)\n", code) for code in blocks(page, "python", "toml"))
    return {match[1]: match.string for match in codes if match}


@pytest.fixture(autouse=True)
def _in_an_empty_directory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(path or str(Path.cwd()) for path in sys.path))
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("example", sorted((DOCS / "examples").glob("*.py")), ids=lambda path: path.name)
def test_the_examples_are_shown_as_they_are(example: Path) -> None:
    shown = [named(page)[example.name] for page in PAGES if example.name in named(page)]
    assert shown == [example.read_text(encoding="utf-8")]


@pytest.mark.slow
def test_the_tutorial_works_from_an_empty_directory() -> None:
    for name, code in named(DOCS / "tutorial.md").items():
        Path(name).write_text(code)
    commands = [line[2:] for code in blocks(DOCS / "tutorial.md", "console") for line in code.splitlines()]
    assert len(commands) == 3
    for k, command in enumerate(commands):
        if k == 2:
            (added,) = (code for code in blocks(DOCS / "tutorial.md", "toml") if ", added\n" in code)
            Path("crowd.toml").write_text(Path("crowd.toml").read_text() + added)
        program, *arguments = shlex.split(command)
        assert program == "kswarms"
        assert invoke([*arguments, "--jobs", "1"] if "run" in arguments else arguments) == 0
    runs = pq.read_table("results/crowd/runs.parquet")
    assert set(runs["condition"].to_pylist()) == {"flee", "fight back", "cautious"}
    assert len(runs) == 3 * 2 * 2 * 2  # conditions, densities, seeds, swarms
    assert Path("results/crowd/figures/crowd.png").stat().st_size > 0


@pytest.mark.slow
def test_the_scripts_and_tests_of_the_guides_run() -> None:
    files = named(DOCS / "extending.md") | named(DOCS / "howto.md") | named(DOCS / "tutorial.md")
    for name, code in files.items():
        Path(name).write_text(code)
    # As a user's pytest, whose directory is not this repository.
    pytest_alone = "-m pytest -q test_my_classes.py test_crowd.py"
    for arguments, expected in ((pytest_alone, "passed"), ("sweep.py", "pucks_2")):
        command = [sys.executable, "-W", "error", *arguments.split()]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
        assert expected in done.stdout


def test_the_readme_counts_the_verdicts_that_the_page_of_findings_gives() -> None:
    page = (DOCS / "findings.md").read_text(encoding="utf-8")
    given = re.findall(r"\| \**(holds|fails|undecided)\** \|", page)
    holds, fails, undecided = map(given.count, ("holds", "fails", "undecided"))
    told = f"of {len(given)} statements, {holds} hold, {fails} fail and {undecided} are undecided"
    assert len(given) == len(FINDINGS)
    assert told in (ROOT / "README.md").read_text(encoding="utf-8")


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
