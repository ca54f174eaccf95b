"""Doctests of a page run in a directory that holds the files shown on the pages, as the reader has them."""

import sys
from collections.abc import Iterator
from pathlib import Path
from shutil import copy

import pytest

EXAMPLES = sorted((Path(__file__).parent / "examples").glob("*.py"))


@pytest.fixture(autouse=True)
def _in_a_directory_with_the_examples(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    for example in EXAMPLES:
        copy(example, tmp_path)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    yield
    for example in EXAMPLES:
        sys.modules.pop(example.stem, None)
