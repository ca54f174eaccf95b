"""The documentation page about findings, followed step by step: its file, test and command."""

import re
from pathlib import Path
from typing import Any

import pytest

from kswarms.scenarios.cli.app import invoke

PAGE = Path(__file__).parents[2] / "docs" / "findings.md"


def block(name: str) -> str:
    """Return the block of code on the page that begins with the comment ``# name``."""
    (found,) = re.findall(
        rf"```\w+\n(# {re.escape(name)}\n.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL
    )
    return str(found)


@pytest.mark.slow
def test_a_test_of_three_lines_asserts_a_finding(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    command = re.search(r"^kswarms (run .* --out results/fighters)$", PAGE.read_text(encoding="utf-8"), re.M)
    assert command
    assert invoke([*command[1].split(), "--no-figures", "--jobs", "1"]) == 0
    names: dict[str, Any] = {}
    exec(block("test_fighters.py"), names)  # like pytest: execute the file, then call its tests

    (tmp_path / "fighters.toml").write_text(block("fighters.toml"), encoding="utf-8")
    names["test_fighters_gather_less"]()
    (tmp_path / "fighters.toml").write_text(block("fighters.toml").replace('"<"', '">"'), encoding="utf-8")
    with pytest.raises(AssertionError, match="fighters-gather-less fails: -"):
        names["test_fighters_gather_less"]()
