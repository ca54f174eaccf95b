"""The command `explore` as a process of its own."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

PATIENCE = 40.0
"""Timeout of every wait (s), generous for a busy machine."""


@contextmanager
def serve(*arguments: str) -> Iterator[str]:
    """Start the command and yield the address that it prints."""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(path or str(Path.cwd()) for path in sys.path)}
    server = subprocess.Popen(
        [sys.executable, "-m", "kswarms.scenarios.cli", "explore", *arguments, "--no-browser", "--port", "0"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=environment,
    )
    assert server.stdout is not None
    assert server.stderr is not None
    line = server.stdout.readline()
    try:
        assert line.startswith("page: http://127.0.0.1:"), server.stderr.read()
        yield line.split()[1]
    finally:
        server.send_signal(signal.SIGINT)
        errors = server.communicate(timeout=PATIENCE)[1]
    assert server.returncode == 130
    assert errors == "kswarms: interrupted\n"
