"""Shell completion of ``kswarms``."""

import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from kswarms.scenarios.catalogue import CATALOGUE, TABLES
from kswarms.scenarios.cli import invoke

Complete = Callable[..., list[str]]


@pytest.fixture
def complete(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Complete:
    """Return a function that returns the completions of the last word."""

    def complete(words: str, shell: str = "bash") -> list[str]:
        monkeypatch.setenv("_KSWARMS_COMPLETE", f"complete_{shell}")
        monkeypatch.setenv("COMP_WORDS", words)
        monkeypatch.setenv("COMP_CWORD", str(len(words.split(" ")) - 1))
        monkeypatch.setenv("_TYPER_COMPLETE_ARGS", words)
        monkeypatch.setenv("_TYPER_COMPLETE_FISH_ACTION", "get-args")
        with pytest.raises(SystemExit):
            invoke([])
        return [line for line in capsys.readouterr().out.splitlines() if line]

    return complete


@pytest.mark.parametrize("command", ["run", "show", "film", "explore", "conflicts", "contribution"])
def test_ids_of_scenarios_and_tables_are_completed(command: str, complete: Complete) -> None:
    tables = [] if command == "contribution" else list(TABLES)  # it takes one scenario
    assert complete(f"kswarms {command} ") == [*CATALOGUE, *tables]
    assert complete(f"kswarms {command} fig-6.4") == ["fig-6.4a", "fig-6.4b"]
    assert complete(f"kswarms {command} table-7") == [name for name in tables if "table-7" in name]
    assert complete(f"kswarms {command} my.to") == []  # the shell looks for files


def test_commands_and_further_ids_are_completed(complete: Complete) -> None:
    assert complete("kswarms con") == ["conflicts", "contribution"]
    assert complete("kswarms run fig-6.1a fig-7.16") == ["fig-7.16a", "fig-7.16b"]
    assert complete("kswarms film --sh") == ["--sheet"]


def test_shells_that_show_help_get_the_title(complete: Complete) -> None:
    title = CATALOGUE["fig-6.4b"].title
    assert complete("kswarms film fig-6.4b", "fish") == [f"fig-6.4b\t{title}"]
    assert f'"fig-6.4b":"{title}"' in complete("kswarms film fig-6.4b", "zsh")[0]


@pytest.mark.skipif(not shutil.which("bash"), reason="needs bash")
def test_bash_completes_with_the_script_of_the_documentation(tmp_path: Path) -> None:
    kswarms = tmp_path / "kswarms"
    kswarms.write_text(f'#!/bin/sh\nexec {sys.executable} -m kswarms.scenarios.cli "$@"\n')
    kswarms.chmod(0o755)
    script = """
        source <(_KSWARMS_COMPLETE=source_bash kswarms)
        COMP_WORDS=(kswarms film fig-6.4) COMP_CWORD=2
        _kswarms_completion kswarms
        echo "${COMPREPLY[@]}"
        complete -p kswarms
    """
    python_path = os.pathsep.join(path or str(Path.cwd()) for path in sys.path)
    environment = os.environ | {"PATH": f"{tmp_path}:{os.environ['PATH']}", "PYTHONPATH": python_path}
    done = subprocess.run(
        ["bash", "--norc", "-c", script], capture_output=True, text=True, env=environment, check=True
    )
    completed, registered = done.stdout.splitlines()
    assert completed == "fig-6.4a fig-6.4b"
    assert registered == "complete -o default -F _kswarms_completion kswarms"
