"""Files of learned policies that others may have made."""

import os
from pathlib import Path

import pytest

from kswarms.agents.common.errors import InputError
from kswarms.agents.common.limits import MAX_JSON_FILE
from kswarms.agents.policies.saved import load_learned
from kswarms.model.description.game import Game, Swarm


@pytest.mark.parametrize("depth", [150, 950, 2000, 99_999])
@pytest.mark.parametrize("text", ["[NESTED]", '{"format": NESTED}', '{"swarm": 1, "robots": NESTED}'])
def test_nested_brackets_are_refused_in_one_line(text: str, depth: int, tmp_path: Path) -> None:
    file = tmp_path / "learned.json"
    file.write_text(text.replace("NESTED", "[" * depth + "]" * depth))
    with pytest.raises(InputError, match="must be a file of learned policies") as error:
        load_learned(file)
    assert len(str(error.value)) < 2000
    assert len(str(error.value).splitlines()) == 1


@pytest.mark.parametrize("name", ["/dev/zero", "/dev/tty", "pipe", ".", "large", "linked"])
def test_only_a_regular_file_of_limited_size_is_read(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    os.mkfifo("pipe")
    Path("linked").symlink_to("/dev/zero")
    with Path("large").open("wb") as file:
        file.truncate(MAX_JSON_FILE + 1)  # sparse: it takes no room on the disk
    with pytest.raises(InputError, match=r"file='.*': must be a (regular |readable )?file"):
        Game(swarms=(Swarm(policy=f"learned(file={name!r})", size=2),))


@pytest.mark.parametrize("content", [b"", b"\xff\xfe", b"null", b"[]", b'{"swarm": NaN}', b"{} {}", b'{"a":'])
def test_other_content_is_refused(content: bytes, tmp_path: Path) -> None:
    file = tmp_path / "learned.json"
    file.write_bytes(content)
    with pytest.raises(InputError, match="must be a file of learned policies"):
        load_learned(file)
