"""The public interface: `kswarms.__all__`, its documentation, and lazy loading."""

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

import kswarms

ROOT = Path(__file__).parents[2]


def test_the_documentation_lists_exactly_the_public_names() -> None:
    rows = re.findall(r"^\| (`.*?`) \|", (ROOT / "docs" / "api.md").read_text(encoding="utf-8"), re.MULTILINE)
    documented = [name for row in rows for name in re.findall(r"`(\w+)`", row)]
    assert sorted(documented) == sorted(kswarms.__all__)
    assert 25 <= len(documented) <= 40


@pytest.mark.parametrize("name", kswarms.__all__)
def test_each_public_name_loads(name: str) -> None:
    assert getattr(kswarms, name) is not None
    assert name in dir(kswarms)


def test_type_checkers_see_the_public_names() -> None:
    tree = ast.parse(Path(kswarms.__file__).read_text(encoding="utf-8"))
    (block,) = (node for node in tree.body if isinstance(node, ast.If))
    imported = [alias.name for node in block.body if isinstance(node, ast.ImportFrom) for alias in node.names]
    assert sorted(imported) == sorted(kswarms.__all__)


def test_unknown_names_raise_attribute_error() -> None:
    with pytest.raises(AttributeError, match="'kswarms' has no attribute 'Gmae'"):
        getattr(kswarms, "Gmae")  # noqa: B009 (mypy rejects the attribute)


def test_import_kswarms_loads_no_heavy_library() -> None:
    heavy = "{'numpy', 'mesa', 'numba', 'pandas', 'pydantic', 'simpy', 'scipy', 'matplotlib'}"
    code = f"import sys, kswarms; dir(kswarms); print(sorted({heavy} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


def test_the_version_stands_in_one_place() -> None:
    assert re.fullmatch(r"\d+\.\d+\.\d+", kswarms.__version__)
    project = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    assert 'dynamic = ["version"]' in project
    assert f"version: {kswarms.__version__}" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")
