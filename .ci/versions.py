"""Run the tests with several versions of Python and of the libraries, each in an environment in `.versions`.

The environments: each Python that is found, with the newest libraries; and the Python that runs this script,
with the lowest versions that pyproject.toml allows. `--short` runs a part of the tests, and skips this Python
with the newest libraries.
"""

import argparse
import contextlib
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import lowest_versions

ROOT = Path(__file__).parents[1]
PYTHONS = ("3.14", "3.13", "3.12", "3.11")
THIS = f"{sys.version_info.major}.{sys.version_info.minor}"
SHORT = [
    "tests/unit/agents", "tests/unit/model", "tests/unit/analysis/measures", "tests/unit/analysis/results",
    "tests/unit/analysis/statistics", "tests/unit/analysis/tables", "tests/integration/test_batch_run.py",
    "tests/integration/test_batch_run_subclasses.py", "tests/integration/test_determinism.py",
    "tests/integration/test_mesa_interface.py", "tests/integration/test_mesa_versions.py",
]  # fmt: skip
REPORT = """
import sys
from importlib.metadata import version
names = "mesa", "numpy", "numba", "pandas", "pyarrow"
print(f"Python {sys.version.split()[0]}", *(f"{name} {version(name)}" for name in names), sep=", ")
"""
PASSED, FAILED, UNFINISHED = "passed", "FAILED", "not finished in time"


def find_python(version: str) -> str | None:
    """Return the path of a Python of a version: this one, one on the path, or one of pyenv."""
    pyenv = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv"))
    of_pyenv = sorted(pyenv.glob(f"versions/{version}.*/bin/python"))
    found = [shutil.which(f"python{version}"), *map(str, reversed(of_pyenv))]
    for path in [sys.executable] * (version == THIS) + [path for path in found if path]:
        code = f"import sys, venv, sqlite3, ssl; sys.exit('{version}' != '%d.%d' % sys.version_info[:2])"
        if subprocess.run([path, "-c", code], capture_output=True, check=False).returncode == 0:
            return path
    return None


class Budget:
    """The time that is left for environments; without `within`, there is no limit.

    An environment is expected to take `about` (s), or as long as the longest one so far.
    """

    def __init__(self, within: float | None, about: float) -> None:
        self._end = None if within is None else time.monotonic() + within
        self._about = about

    def allows_one(self) -> bool:
        """Return whether a further environment would end in time."""
        return self._end is None or time.monotonic() + self._about <= self._end

    def left(self) -> float | None:
        """Return the time that is left (s), or None without a limit."""
        return None if self._end is None else max(0.0, self._end - time.monotonic())

    def spent(self, seconds: float) -> None:
        """Note the duration of an environment."""
        self._about = max(self._about, seconds)


def run(command: list[str | Path], limit: float | None) -> str:
    """Run a command with a time limit (s) and return `PASSED`, `FAILED` or `UNFINISHED`.

    At the limit, the command and all processes that it started are killed.
    """
    with subprocess.Popen(command, cwd=ROOT, start_new_session=True) as process:
        try:
            return PASSED if process.wait(limit) == 0 else FAILED
        except subprocess.TimeoutExpired:
            return UNFINISHED
        finally:
            with contextlib.suppress(ProcessLookupError):  # all have ended
                os.killpg(process.pid, signal.SIGKILL)


def check(name: str, python: str, options: list[str], tests: list[str], budget: Budget) -> bool:
    """Install kswarms into an environment, with options of pip, and run tests; return whether none failed.

    Tests that do not finish in time are stopped. They have not failed.
    """
    started = time.monotonic()
    environment = ROOT / ".versions" / name
    own = environment / "bin" / "python"
    quiet = ["--quiet", "--disable-pip-version-check", "--no-input", "--no-compile"]
    commands: list[list[str | Path]] = [
        [python, "-m", "venv", "--clear", environment],
        [own, "-m", "pip", "install", *quiet, *options, "-e", ".[pytest]"],
        [own, "-c", REPORT],
        [own, "-m", "pytest", "-q", "-n", "auto", "--dist", "loadfile", "-p", "no:cacheprovider", *tests],
    ]
    outcomes = (run(command, budget.left()) for command in commands)
    outcome = next((each for each in outcomes if each != PASSED), PASSED)
    budget.spent(time.monotonic() - started)
    print(f"{name}: {outcome}, {time.monotonic() - started:.0f} s", flush=True)
    return outcome != FAILED


def main() -> int:
    """Check all environments; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--short", action="store_true", help="run a part of the tests")
    parser.add_argument("--within", type=float, help="skip or stop environments that would end later (s)")
    parser.add_argument("--about", type=float, default=0.0, help="expected time of the first one (s)")
    given = parser.parse_args()
    short, budget = given.short, Budget(given.within, given.about)
    tests = [*SHORT, "-m", "not slow and not full"] if short else ["tests"]
    failed = []
    constraints = ROOT / ".versions" / "lowest.txt"
    constraints.parent.mkdir(exist_ok=True)
    constraints.write_text("".join(f"{line}\n" for line in lowest_versions.pins(ROOT)), encoding="utf-8")
    # Old libraries warn of newer ones, of which kswarms itself knows nothing.
    if not budget.allows_one():
        print("lowest: skipped, no time is left", flush=True)
    elif not check("lowest", sys.executable, ["-c", str(constraints)], [*tests, "-W", "default"], budget):
        failed.append("lowest")
    for version in PYTHONS:
        name = f"python-{version}"
        if short and version == THIS:
            print(f"{name}: skipped, `make test` runs all tests with it", flush=True)
        elif (python := find_python(version)) is None:
            print(f"{name}: skipped, there is no Python {version}", flush=True)
        elif not budget.allows_one():
            print(f"{name}: skipped, no time is left", flush=True)
        elif not check(name, python, ["--upgrade", "--upgrade-strategy", "eager"], tests, budget):
            failed.append(name)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
