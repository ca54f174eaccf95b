"""Fixtures of several files: an empty directory, a tiny study, broken games, a page."""

import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from kswarms.model.game_model import GameModel
from tests.helpers.tiny_study import TINY, Fault


@pytest.fixture
def empty_directory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run a test in an empty directory; other processes still find the package."""
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(path or str(Path.cwd()) for path in sys.path))
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def with_a_file_of_scenarios(empty_directory: None) -> None:
    """Run a test in a directory that has a file of scenarios only."""
    Path("tiny.toml").write_text(TINY.to_toml())


@pytest.fixture
def break_games(monkeypatch: pytest.MonkeyPatch) -> Callable[[Fault], None]:
    """Return a function that installs a fault before each game."""
    real = GameModel.play

    def install(fault: Fault) -> None:
        def broken(model: GameModel) -> None:
            fault(model)
            real(model)

        monkeypatch.setattr(GameModel, "play", broken)

    return install


@pytest.fixture
def show(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., Any]]:
    """Return a function that shows a page; close the pages afterwards."""
    from tests.helpers.shown_page import showing  # here, since it needs the extra `explore`

    yield from showing(monkeypatch)
