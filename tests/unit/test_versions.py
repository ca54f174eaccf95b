"""Time limits of the tests with other versions of Python and of the libraries."""

import sys
import time
from pathlib import Path
from types import ModuleType

import pytest

from tests.helpers.scripts import load_script

CI = Path(__file__).parents[2] / ".ci"


@pytest.fixture
def versions(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(CI)
    return load_script(CI / "versions.py")


@pytest.mark.parametrize(("status", "outcome"), [(0, "passed"), (1, "FAILED")])
def test_a_command_passes_or_fails_by_its_status(versions: ModuleType, status: int, outcome: str) -> None:
    assert versions.run([sys.executable, "-c", f"raise SystemExit({status})"], 60.0) == outcome


def test_a_command_is_stopped_at_its_limit_with_its_children(versions: ModuleType, tmp_path: Path) -> None:
    code = """
import subprocess, sys, time
subprocess.Popen([sys.executable, "-c", "import time; time.sleep(2); open('late', 'w')"], cwd=sys.argv[1])
time.sleep(60)
"""
    started = time.monotonic()
    assert versions.run([sys.executable, "-c", code, str(tmp_path)], 1.0) == "not finished in time"
    assert time.monotonic() - started < 30
    time.sleep(2.5)
    assert not list(tmp_path.iterdir())


def test_an_environment_starts_only_if_it_would_end_in_time(versions: ModuleType) -> None:
    assert versions.Budget(None, 1e9).allows_one()
    budget = versions.Budget(100.0, 50.0)
    assert budget.allows_one()
    budget.spent(150.0)
    assert not budget.allows_one()
    assert 0.0 < budget.left() <= 100.0
