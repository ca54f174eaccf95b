"""Doctests of a page run in a directory that holds the files shown on the pages, as the reader has them."""

from pathlib import Path
from shutil import copy

import pytest

EXAMPLES = Path(__file__).parent / "examples"


@pytest.fixture(autouse=True)
def _in_a_directory_with_the_examples(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for example in EXAMPLES.glob("*.py"):
        copy(example, tmp_path)
    monkeypatch.chdir(tmp_path)
