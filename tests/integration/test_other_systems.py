"""A game needs no function that only Linux has; a study says what it needs."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

# Functions and files of Linux only are missing. `fcntl`, which macOS has, is missing too.
SYSTEM = """
import os, sys

def refuse(event, arguments):
    if event == "open" and str(arguments[0]).startswith(("/proc/", "/sys/")):
        raise FileNotFoundError(arguments[0])
sys.addaudithook(refuse)
sys.modules["fcntl"] = None
for name in (
    "sched_getaffinity", "sched_setaffinity", "posix_fadvise", "posix_fallocate", "sendfile", "splice",
    "eventfd", "memfd_create", "copy_file_range", "pidfd_open", "getrandom", "fdatasync", "pipe2", "unshare",
):
    if hasattr(os, name):
        delattr(os, name)
"""

GAME = """
from pathlib import Path
from kswarms import ForagingModel
from kswarms.model.recorder import save_policies
model = ForagingModel(n=6, policies="learner,attack", learning=20.0, duration=20.0, record="model,robots")
model.play()
save_policies(model, 1, Path("learned.json"))
save_policies(model, 1, Path("learned.json"))
again = ForagingModel(n=6, policies='learned(file="learned.json"),attack', duration=20.0)
again.play()
print(model.ended, again.ended, sorted(path.name for path in Path().iterdir()))
"""

STUDY = """
from kswarms.scenarios.cli.cpus import available_cpus
assert available_cpus() == os.cpu_count()
try:
    import kswarms.scenarios.study.study
except ImportError as error:
    print(error)
"""


def run(code: str, directory: Path) -> str:
    """Run code in a new interpreter, on a system without what only Linux has."""
    paths = os.pathsep.join(path or str(Path.cwd()) for path in sys.path)
    done = subprocess.run(
        [sys.executable, "-c", SYSTEM + code],
        cwd=directory,
        env={**os.environ, "PYTHONPATH": paths},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout


@pytest.mark.slow
def test_a_game_is_played_and_its_policies_are_saved(tmp_path: Path) -> None:
    assert run(GAME, tmp_path) == "time time ['learned.json']\n"


def test_a_study_needs_locks(tmp_path: Path) -> None:
    assert "needs locks of files (the module fcntl)" in run(STUDY, tmp_path)
