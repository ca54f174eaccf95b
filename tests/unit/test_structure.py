"""Layout: small files, small folders, one import package. `make lint` checks the direction of imports."""

import ast
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


def test_only_compiled_functions_call_inner_compiled_functions() -> None:
    folders = (*PACKAGES, "tests", "benchmarks")
    files = [path.relative_to(ROOT) for folder in folders for path in (ROOT / folder).rglob("*.py")]
    modules = {path: ast.parse((ROOT / path).read_text(encoding="utf-8")).body for path in files}
    inner = {
        f"kswarms.{'.'.join(path.with_suffix('').parts)}.{node.name}"
        for path, module in modules.items()
        for node in module
        if isinstance(node, ast.FunctionDef) and "compiled_inner" in decorators(node)
    }
    assert "kswarms.model.kernel.percepts.perceive" in inner
    for path, module in modules.items():
        own = f"kswarms.{'.'.join(path.with_suffix('').parts)}"
        imports = [node for node in module if isinstance(node, ast.ImportFrom)]
        places = {name.name: node.module for node in imports for name in node.names}
        for node in module:
            if not decorators(node) & {"compiled", "compiled_inner"}:
                called = {ast.unparse(each.func) for each in ast.walk(node) if isinstance(each, ast.Call)}
                assert {f"{places.get(name, own)}.{name}" for name in called} & inner == set()


def decorators(node: ast.stmt) -> set[str]:
    return {ast.unparse(each) for each in getattr(node, "decorator_list", ())}
