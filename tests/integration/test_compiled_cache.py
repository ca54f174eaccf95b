"""Cached machine code is that of the present sources; a cache that cannot be used is no error."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from kswarms.agents.common import jit
from kswarms.model.game_model import GameModel
from tests.games import make_game

CALLEE = "from kswarms.agents.common.jit import compiled\n@compiled\ndef callee(x):\n    return x + {}\n"
CALLER = """
from kswarms.agents.callee import callee
from kswarms.agents.common.jit import compiled
@compiled
def caller(x):
    return 2.0 * callee(x)
"""
CALL = "from kswarms.model.caller import caller; print(caller(1.0))"


class Package:
    """A small package with two compiled functions in two folders; the first calls the second."""

    def __init__(self, directory: Path) -> None:
        self.root = directory / "kswarms"
        for folder in ("", "agents", "agents/common", "model"):
            (self.root / folder).mkdir(parents=True, exist_ok=True)
            (self.root / folder / "__init__.py").write_text("")
        shutil.copy(jit.__file__, self.root / "agents" / "common")
        (self.root / "model" / "caller.py").write_text(CALLER)
        self.write(1.0)

    def write(self, summand: float, time: float | None = None) -> None:
        """Write the called function; `time` is the modification time of its file."""
        path = self.root / "agents" / "callee.py"
        path.write_text(CALLEE.format(summand))
        if time is not None:
            os.utime(path, (time, time))

    def run(self, code: str = CALL, **environment: str) -> tuple[str, str]:
        """Run code in a new process; return its output and its errors."""
        inherited = {name: text for name, text in os.environ.items() if name != "NUMBA_CACHE_DIR"}
        done = subprocess.run(
            [sys.executable, "-B", "-c", code],
            env={**inherited, "PYTHONPATH": str(self.root.parent), **environment},
            cwd=self.root.parent,
            capture_output=True,
            text=True,
            timeout=120,
        )
        assert done.returncode == 0, done.stderr
        return done.stdout.strip(), done.stderr

    def files(self) -> dict[Path, int]:
        """Return the cache files with their modification times."""
        return {path: path.stat().st_mtime_ns for path in self.root.parent.rglob("*.nb[ic]")}


@pytest.fixture
def package(tmp_path: Path) -> Package:
    return Package(tmp_path)


@pytest.mark.slow
def test_code_is_that_of_the_present_sources_whatever_their_times(package: Package) -> None:
    assert package.run() == ("4.0", "")
    package.write(2.0, time=1)
    assert package.run() == ("6.0", "")
    package.write(3.0, time=4e9)
    assert package.run() == ("8.0", "")
    before = package.files()
    assert package.run() == ("8.0", "")  # cached in spite of the time in the future
    package.write(3.0, time=1)
    assert package.run() == ("8.0", "")
    assert package.files() == before


@pytest.mark.slow
def test_a_terminal_shows_one_line_while_code_is_compiled(package: Package) -> None:
    code = f"import sys; sys.stderr.isatty = lambda: True; {CALL}"
    worker = f"import multiprocessing as m; m.parent_process = lambda: 'main'; {code}"
    assert package.run(worker) == ("4.0", "")
    package.write(2.0)
    assert package.run(code) == ("6.0", "kswarms: compiling once, for up to half a minute\n")
    assert package.run(code) == ("6.0", "")


@pytest.mark.parametrize(
    ("place", "name", "value"),
    [
        ("np", "__version__", "0"),
        ("numba", "__version__", "0"),
        ("sys", "version", "0"),
        ("_CONFIG", "CPU_NAME", "generic"),
        ("_CONFIG", "CPU_FEATURES", "+sse2"),
        ("_CONFIG", "OPT", "0"),
    ],
)
def test_names_of_cache_files_depend_on_versions_and_processor(
    place: str, name: str, value: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(getattr(jit, place), name, value)
    assert jit._digest.__wrapped__() != jit._digest()


@pytest.mark.slow
def test_cache_files_that_are_damaged_are_replaced_and_old_ones_deleted(package: Package) -> None:
    package.run()
    for path in package.files():
        path.write_bytes(b"\x80\x05damaged")
    assert package.run() == ("4.0", "")
    code = f"from kswarms.agents.common import jit; jit._MAX_FILES = 4; {CALL}"
    for summand in (2.0, 3.0):
        package.write(summand)
        assert package.run(code)[0] == str(2.0 + 2.0 * summand)
    assert len(package.files()) == 8  # an index and a data file for each of two digests in two folders


@pytest.mark.slow
def test_without_a_writable_directory_nothing_is_cached_and_one_line_says_so(package: Package) -> None:
    for folder in ("agents", "agents/common", "model"):
        (package.root / folder / "__pycache__").write_text("not a directory")
    home = {"HOME": "/dev/null", "XDG_CACHE_HOME": "/dev/null", "NUMBA_CACHE_DIR": ""}
    output, errors = package.run(**home)
    assert output == "4.0"
    assert errors.startswith("kswarms: no writable directory for machine code")
    assert errors.count("\n") == 1
    workers = f"import multiprocessing as m; m.parent_process = lambda: 'main'; {CALL}"
    assert package.run(workers, **home) == ("4.0", "")
    assert not package.files()


@pytest.mark.slow
def test_a_full_disk_is_one_line(package: Package) -> None:
    code = f"import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0)); {CALL}"
    output, errors = package.run(code)
    assert output == "4.0"
    assert errors.count("\n") == 1
    assert "NUMBA_CACHE_DIR" in errors


@pytest.mark.slow
def test_games_without_compilation_are_the_same() -> None:
    # Two swarms with conflicts, walls, pucks and a jam, in a small arena.
    code = """
from kswarms import GameModel
from tests.games import make_game
model = GameModel(make_game("mixed", "aggressive", size=9, duration=3.0), 5)
model.play()
print(model.results(), model.states.positions.tolist())
"""
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1", "PYTHONPATH": os.pathsep.join(map(str, sys.path))}
    words = [sys.executable, "-W", "error::RuntimeWarning", "-c", code]
    done = subprocess.run(words, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    model = GameModel(make_game("mixed", "aggressive", size=9, duration=3.0), 5)
    model.play()
    assert done.stdout.strip() == f"{model.results()} {model.states.positions.tolist()}"
