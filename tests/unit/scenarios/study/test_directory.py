"""Results directories and JSON files in them."""

from pathlib import Path

import pytest

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.study.directory import make_directory, write_json


def test_a_file_is_no_directory_for_results(tmp_path: Path) -> None:
    make_directory(tmp_path / "new" / "results")
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="must be a writable directory"):
        make_directory(tmp_path / "file")


def test_a_json_file_that_cannot_be_written_stays_unchanged(tmp_path: Path) -> None:
    path = tmp_path / "content.json"
    write_json(path, {"a": 1})
    with pytest.raises(TypeError):
        write_json(path, {"a": object()})
    assert path.read_text() == '{\n "a": 1\n}\n'
    assert list(tmp_path.iterdir()) == [path]
