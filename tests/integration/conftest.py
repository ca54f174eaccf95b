"""Fixtures of several test files: an empty directory, a tiny study, games that fail, a page."""

import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from kswarms.model.game_model import GameModel
from tests.helpers.tiny_study import TINY, Fault


@pytest.fixture
def empty_directory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Change to an empty directory, in which child processes still import this package."""
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(path or str(Path.cwd()) for path in sys.path))
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def tiny_file(empty_directory: Path) -> None:
    """Write the tiny scenario to ``tiny.toml`` in an empty directory."""
    (empty_directory / "tiny.toml").write_text(TINY.to_toml())


@pytest.fixture
def before_games(monkeypatch: pytest.MonkeyPatch) -> Callable[[Fault], None]:
    """Return a function that installs a fault, which is called before each game."""
    real = GameModel.play

    def install(fault: Fault) -> None:
        def play(model: GameModel) -> None:
            fault(model)
            real(model)

        monkeypatch.setattr(GameModel, "play", play)

    return install


@pytest.fixture
def show(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., Any]]:
    """Return a function that shows a page; close the pages afterwards."""
    from tests.helpers.rendered_page import render_pages  # here, since it needs the extra `explore`

    yield from render_pages(monkeypatch)
