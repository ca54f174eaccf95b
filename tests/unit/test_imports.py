"""Imports go one way: scenarios → model → agents; analysis reads files and simulates nothing."""

import ast
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import pytest

ROOT: Final = Path(__file__).parents[2]

MAY_IMPORT: Final = {
    "agents": {"agents"},
    "model": {"model", "agents"},
    "analysis": {"analysis", "agents"},
    "scenarios": {"scenarios", "model", "agents"},
    # What people see is made of everything.
    "scenarios/cli": {"scenarios", "model", "agents", "analysis"},
    "scenarios/explore": {"scenarios", "model", "agents", "analysis"},
}
"""Packages of the project that each folder may import; the longest folder that fits counts."""

OF_ANALYSIS_ALONE: Final = {"pandas", "matplotlib", "seaborn", "statsmodels"}

WITHOUT_ROBOTS: Final = {"errors", "validation", "calls", "theory", "files"}
"""Modules of `agents` that `analysis` may import: they hold no robot that could play."""


def imported(source: str) -> Iterator[str]:
    """Yield the modules that a source imports, wherever in it; what is imported from one as part of it."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "imports are absolute"
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def faults(path: str, source: str) -> list[str]:
    """Return what a file, by its path from the root, imports against the rules."""
    folder = max((each for each in MAY_IMPORT if path.startswith(f"{each}/")), key=len)
    packages = {each.partition("/")[0] for each in MAY_IMPORT}
    found = []
    for name in imported(source):
        package, _, rest = name.partition(".")
        last = name.rpartition(".")[2]
        if (
            (package in packages and package not in MAY_IMPORT[folder])
            or (package in OF_ANALYSIS_ALONE and folder != "analysis")
            or (package == "agents" and folder == "analysis" and rest.partition(".")[0] not in WITHOUT_ROBOTS)
            or (package in packages and last.startswith("_"))
        ):
            found.append(name)
    return found


def modules() -> list[str]:
    folders = {each.partition("/")[0] for each in MAY_IMPORT}
    return sorted(p.relative_to(ROOT).as_posix() for folder in folders for p in (ROOT / folder).rglob("*.py"))


@pytest.mark.parametrize("path", modules())
def test_a_module_imports_only_what_its_place_allows(path: str) -> None:
    assert faults(path, (ROOT / path).read_text(encoding="utf-8")) == []


@pytest.mark.parametrize(
    ("path", "source"),
    [
        ("agents/x.py", "from model.game import Game"),
        ("agents/x.py", "def f() -> None:\n    import analysis.tables"),
        ("model/x.py", "from scenarios.runs import Run"),
        ("model/x.py", "import pandas as pd"),
        ("scenarios/x.py", "from analysis import figures"),
        ("scenarios/cli/x.py", "from matplotlib.figure import Figure"),
        ("analysis/report/x.py", "from scenarios.catalogue import CATALOGUE"),
        ("analysis/x.py", "from agents.krembot import Krembot"),
        ("analysis/x.py", "from agents.calls import _read"),
    ],
)
def test_an_import_against_the_rules_is_found(path: str, source: str) -> None:
    assert faults(path, source)


def test_the_project_was_found() -> None:
    some = {"agents/errors.py", "model/game.py", "analysis/figures.py", "scenarios/cli/app.py"}
    assert some < set(modules())
