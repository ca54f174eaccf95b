"""Runs of different environments (Python, numpy, numba, machine) are not mixed without permission."""

import dataclasses
import json
import platform
import sqlite3
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future
from contextlib import closing
from importlib import metadata
from pathlib import Path
from typing import Any

import pytest

from kswarms.scenarios.cli import invoke
from kswarms.scenarios.runs.errors import RunError
from kswarms.scenarios.runs.outcome import environment
from kswarms.scenarios.study.database import LEDGER_FILE
from kswarms.scenarios.study.study import Study
from tests.helpers.tiny_study import PLAIN_RUN, RUN, TINY, read_tables

pytestmark = pytest.mark.usefixtures("tiny_file")

OTHERS = ["Python 3.99", "numpy 9.9.9", "numba 9.9.9", "riscv64"]


def other_environment(part: str) -> str:
    """Return the environment of this process with another version of one part."""
    parts = environment().split(", ")
    k = next((k for k, each in enumerate(parts) if each.split()[0] == part.split()[0]), 3)
    return ", ".join([*parts[:k], part, *parts[k + 1 :]])


def change_environment_of_runs(directory: str, new: str) -> None:
    with closing(sqlite3.connect(Path(directory, LEDGER_FILE))) as db, db:
        db.execute("UPDATE runs SET environment = ?", (new,))


@pytest.fixture
def fresh_environment() -> Iterator[None]:
    """Determine the environment again in a test that changes versions, and after it."""
    environment.cache_clear()
    yield
    environment.cache_clear()


@pytest.mark.parametrize("part", OTHERS)
def test_runs_of_another_environment_are_refused(part: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke([*RUN, "--seeds", "1"]) == 0
    before = read_tables("results")
    other = other_environment(part)
    assert other != environment()
    change_environment_of_runs("results", other)
    assert invoke(RUN) == 2
    reason = f"has runs of {other}, this is {environment()}; use another directory, or --allow-mixed"
    assert capsys.readouterr().err == f"kswarms: out='results': {reason}\n"
    assert read_tables("results") == before


def test_mixed_runs_are_allowed_on_request_and_shown(capsys: pytest.CaptureFixture[str]) -> None:
    other = other_environment("numpy 9.9.9")
    assert invoke([*PLAIN_RUN, "--seeds", "1"]) == 0
    assert invoke(["status", "results"]) == 0
    shown = capsys.readouterr().out
    assert f"played with: {environment()}, 4 runs\n" in shown
    assert "mixed:" not in shown
    change_environment_of_runs("results", other)
    assert invoke([*PLAIN_RUN, "--seeds", "2", "--allow-mixed"]) == 0
    assert f"has runs of other code, {other}" in capsys.readouterr().err
    assert invoke(["status", "results"]) == 0
    shown = capsys.readouterr().out
    assert f"played with: {other}, 4 runs\n" in shown
    assert f"played with: {environment()}, 4 runs\n" in shown
    assert "mixed:" in shown
    manifest = json.loads(Path("results/manifest.json").read_text())
    assert manifest["environments"] == {other: 4, environment(): 4}
    assert invoke(["report", "results"]) == 0
    assert "were played by different versions" in Path("results/report.html").read_text()


@pytest.mark.usefixtures("fresh_environment")
@pytest.mark.parametrize(
    ("function", "replacement", "equal"),
    [
        ("python_version_tuple", lambda: (*map(str, sys.version_info[:2]), "99"), True),
        ("python_version_tuple", lambda: ("3", "99", "0"), False),
        ("machine", lambda: "riscv64", False),
    ],
)
def test_an_environment_has_the_minor_version_of_python_and_the_machine(
    function: str, replacement: Callable[[], Any], equal: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = environment()
    environment.cache_clear()
    monkeypatch.setattr(platform, function, replacement)
    assert (environment() == before) == equal


@pytest.mark.usefixtures("fresh_environment")
@pytest.mark.parametrize("library", ["numpy", "numba"])
def test_an_environment_has_the_exact_versions_of_libraries(
    library: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = environment()
    environment.cache_clear()
    real = metadata.version
    monkeypatch.setattr(metadata, "version", lambda name: real(name) + ".1" * (name == library))
    assert environment() != before


class Elsewhere(Executor):
    """Executor whose worker has another environment."""

    def __init__(self, other: str) -> None:
        self._other = other

    def submit(self, function: Callable[..., Any], /, *arguments: Any, **options: Any) -> Future[Any]:
        result, seconds = function(*arguments, **options)
        future: Future[Any] = Future()
        future.set_result((dataclasses.replace(result, environment=self._other), seconds))
        return future


def test_results_of_a_worker_with_another_environment_are_refused() -> None:
    other = other_environment("numba 9.9.9")
    worker = Elsewhere(other)
    scenario = TINY.replace(seeds=1)
    refusal = "a worker has Python.*, this process has .*--allow-mixed"
    with pytest.raises(RunError, match=refusal), Study(Path("results")) as study:
        list(study.play(study.plan([scenario]), executor=worker))
    assert not Path("results/runs.parquet").exists()
    with Study(Path("results"), allow_mixed=True) as study:
        list(study.play(study.plan([scenario]), executor=worker))
    assert json.loads(Path("results/manifest.json").read_text())["environments"] == {other: 4}
