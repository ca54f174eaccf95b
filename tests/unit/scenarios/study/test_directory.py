"""JSON files of a results directory."""

from pathlib import Path

import pytest

from kswarms.scenarios.study.directory import write_json


def test_a_json_file_that_cannot_be_written_stays_unchanged(tmp_path: Path) -> None:
    path = tmp_path / "content.json"
    write_json(path, {"a": 1})
    with pytest.raises(TypeError):
        write_json(path, {"a": object()})
    assert path.read_text() == '{\n "a": 1\n}\n'
    assert list(tmp_path.iterdir()) == [path]
