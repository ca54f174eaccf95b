"""What several files of these tests begin with: a study to play in, games to break, a page to look at."""

import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from kswarms.model.game_model import GameModel
from tests.helpers.tiny_study import TINY, Fault


@pytest.fixture
def with_a_file_of_scenarios(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let relative paths lead into a directory of the test's own, which workers can leave for the package."""
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(path or str(Path.cwd()) for path in sys.path))
    monkeypatch.chdir(tmp_path)
    Path("tiny.toml").write_text(TINY.to_toml())


@pytest.fixture
def break_games(monkeypatch: pytest.MonkeyPatch) -> Callable[[Fault], None]:
    """Let something happen before each game."""
    real = GameModel.play

    def install(fault: Fault) -> None:
        def broken(model: GameModel) -> None:
            fault(model)
            real(model)

        monkeypatch.setattr(GameModel, "play", broken)

    return install


@pytest.fixture
def show(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., Any]]:
    """Show pages, and close them."""
    from tests.helpers.shown_page import showing  # here, for the other tests do without the extra `explore`

    yield from showing(monkeypatch)
