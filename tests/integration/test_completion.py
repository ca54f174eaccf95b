"""Shell completion of ``kswarms``."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from kswarms.scenarios.catalogue import CATALOGUE, TABLES
from kswarms.scenarios.cli import invoke


def completed(
    words: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], shell: str = "bash"
) -> list[str]:
    """Return the completions of the last word."""
    monkeypatch.setenv("_KSWARMS_COMPLETE", f"complete_{shell}")
    monkeypatch.setenv("COMP_WORDS", words)
    monkeypatch.setenv("COMP_CWORD", str(len(words.split(" ")) - 1))
    monkeypatch.setenv("_TYPER_COMPLETE_ARGS", words)
    monkeypatch.setenv("_TYPER_COMPLETE_FISH_ACTION", "get-args")
    with pytest.raises(SystemExit):
        invoke([])
    return [line for line in capsys.readouterr().out.splitlines() if line]


@pytest.mark.parametrize("command", ["run", "show", "film", "explore", "conflicts", "contribution"])
def test_ids_of_scenarios_and_tables_are_completed(
    command: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    tables = [] if command == "contribution" else list(TABLES)  # it takes one scenario
    assert completed(f"kswarms {command} ", monkeypatch, capsys) == [*CATALOGUE, *tables]
    assert completed(f"kswarms {command} fig-6.4", monkeypatch, capsys) == ["fig-6.4a", "fig-6.4b"]
    assert completed(f"kswarms {command} table-7", monkeypatch, capsys) == [
        name for name in tables if name.startswith("table-7")
    ]
    assert completed(f"kswarms {command} my.to", monkeypatch, capsys) == []  # the shell looks for files


def test_commands_and_further_ids_are_completed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert completed("kswarms con", monkeypatch, capsys) == ["conflicts", "contribution"]
    assert completed("kswarms run fig-6.1a fig-7.16", monkeypatch, capsys) == ["fig-7.16a", "fig-7.16b"]
    assert completed("kswarms film --sh", monkeypatch, capsys) == ["--sheet"]


def test_shells_that_show_help_get_the_title(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    title = CATALOGUE["fig-6.4b"].title
    assert completed("kswarms film fig-6.4b", monkeypatch, capsys, "fish") == [f"fig-6.4b\t{title}"]
    assert f'"fig-6.4b":"{title}"' in completed("kswarms film fig-6.4b", monkeypatch, capsys, "zsh")[0]


@pytest.mark.skipif(not shutil.which("bash"), reason="needs bash")
def test_bash_completes_with_the_script_of_the_documentation(tmp_path: Path) -> None:
    kswarms = tmp_path / "kswarms"
    kswarms.write_text(
        f"#!/bin/sh\nexec {sys.executable} -c 'from kswarms.scenarios.cli import main; main()' \"$@\"\n"
    )
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
    assert done.stdout.splitlines() == [
        "fig-6.4a fig-6.4b",
        "complete -o default -F _kswarms_completion kswarms",
    ]
