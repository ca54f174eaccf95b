"""Output on terminals with few characters, and on outputs that are closed or full."""

import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest


def run(words: Sequence[str | bytes], redirection: str = "", **environment: str) -> tuple[int, str, str]:
    """Run the command line in a shell; return its status, output and errors."""
    done = subprocess.run(
        ["sh", "-c", f'"$@" {redirection}', "sh", sys.executable, "-m", "kswarms.scenarios.cli", *words],
        env={**os.environ, **environment},
        capture_output=True,
        timeout=60,
    )
    return done.returncode, done.stdout.decode("latin-1"), done.stderr.decode("latin-1")


@pytest.mark.parametrize("encoding", ["latin-1", "cp1252:strict", "iso8859-15:strict"])
def test_characters_that_a_terminal_cannot_show_are_escaped(encoding: str) -> None:
    status, output, errors = run(["list"], PYTHONIOENCODING=encoding)
    assert (status, errors) == (0, "")
    assert "\\u0394" in output  # Δ


@pytest.mark.parametrize(
    "word", [b"\xff/x.toml", b"a\xe4\x1b[31m", b"n" * 5000], ids=["path", "escape", "long"]
)
def test_names_that_are_no_text_are_refused_in_one_line(word: bytes) -> None:
    status, output, errors = run(["show", word], PYTHONIOENCODING="utf-8")
    assert (status, output) == (2, "")
    assert errors.startswith("kswarms: id='")
    assert errors.count("\n") == 1
    assert errors[:-1].isprintable()


@pytest.mark.parametrize("command", ["list", "show fig-7.5", "run --help"])
def test_output_that_nobody_reads_is_no_error(command: str) -> None:
    read, write = os.pipe()
    os.close(read)
    words = [sys.executable, "-m", "kswarms.scenarios.cli", *command.split()]
    done = subprocess.run(words, stdout=write, stderr=subprocess.PIPE, text=True, timeout=60)
    os.close(write)
    assert (done.returncode, done.stderr) == (1, "")


def test_a_full_disk_is_one_line() -> None:
    if not Path("/dev/full").exists():
        pytest.skip("needs /dev/full")
    assert run(["list"], ">/dev/full") == (1, "", "kswarms: [Errno 28] No space left on device\n")


@pytest.mark.parametrize(("redirection", "status"), [(">&-", 0), ("2>&-", 0), (">&- 2>&-", 0)])
def test_streams_may_be_closed(redirection: str, status: int) -> None:
    assert run(["list"], redirection)[0] == status
    assert run(["xyz"], redirection)[0] == 2
