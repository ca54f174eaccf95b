"""Layout: small files, small folders, one import package. `make lint` checks the direction of imports."""

import subprocess
import sys
from pathlib import Path
from typing import Final

import pytest

ROOT: Final = Path(__file__).parents[2]
PACKAGES: Final = ("agents", "model", "scenarios", "analysis")
MOST_LINES: Final = 300
MOST_ENTRIES: Final = 10
NOT_COUNTED: Final = {"__init__.py", "__pycache__", "cli"}


def python_files() -> list[Path]:
    folders = (*PACKAGES, "tests", "benchmarks", "docs")
    return sorted(path for folder in folders for path in (ROOT / folder).rglob("*.py"))


def folders() -> list[Path]:
    found = {path.parent for package in PACKAGES for path in (ROOT / package).rglob("*.py")}
    return sorted(folder for folder in found if folder.name != "cli")


def test_no_python_file_is_too_long() -> None:
    lines = {path: len(path.read_text(encoding="utf-8").splitlines()) for path in python_files()}
    assert {str(path): count for path, count in lines.items() if count > MOST_LINES} == {}


@pytest.mark.parametrize("folder", folders(), ids=lambda folder: folder.relative_to(ROOT).as_posix())
def test_a_folder_holds_few_entries(folder: Path) -> None:
    modules = [path for path in folder.iterdir() if path.suffix == ".py" or any(path.glob("*.py"))]
    assert len({path.name for path in modules} - NOT_COUNTED) <= MOST_ENTRIES


def test_the_import_package_links_to_the_four_packages() -> None:
    links = {path.name: path.readlink() for path in (ROOT / "kswarms").iterdir() if path.is_symlink()}
    assert links == {name: Path("..", name) for name in PACKAGES}


@pytest.mark.parametrize("line", ["from model.game_model import GameModel", "import agents.robot"])
def test_lint_refuses_bare_package_names(line: str) -> None:
    pytest.importorskip("ruff", reason="needs the extra `test`")
    command = [sys.executable, "-m", "ruff", "check", "--select", "TID251", "-"]
    found = subprocess.run(command, input=f"{line}\n", cwd=ROOT, capture_output=True, text=True)
    assert found.returncode == 1
    assert "TID251" in found.stdout
