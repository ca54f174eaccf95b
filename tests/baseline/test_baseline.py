"""The same seeds give the same games as before, byte for byte."""

import json
from pathlib import Path

import pytest

from tests.baseline.games import FILE, catalogue_games, digests, other_games

KNOWN = json.loads(FILE.read_text())


@pytest.mark.full
def test_all_games_are_unchanged(tmp_path: Path) -> None:
    assert dict(digests([*catalogue_games(), *other_games(tmp_path)])) == KNOWN


@pytest.mark.slow
def test_games_of_every_kind_are_unchanged(tmp_path: Path) -> None:
    few = [each for each in catalogue_games() if each[0].endswith("n=6/seed=0") and not each[1].puck_limit]
    found = dict(digests([*few, *other_games(tmp_path)]))
    assert found == {name: KNOWN[name] for name in found}
