"""The packages that are built: their contents, and a game played with the installed wheel."""

import os
import stat
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest
from packaging.requirements import Requirement

import kswarms

pytest.importorskip("build", reason="needs the extra `test`")

ROOT = Path(__file__).parents[2]

USER_MODULES = {
    "model.py": "raise ImportError('a module of the user')\n",
    "scenarios.py": "raise ImportError('a module of the user')\n",
    "analysis.py": "raise ImportError('a module of the user')\n",
    "agents.py": (
        "class Mine:\n"
        "    def __init__(self, setting):\n        self.action = setting.actions[0]\n"
        "    def choose(self, opponent):\n        return self.action\n"
    ),
    "play.py": (
        "import kswarms\n"
        "print(kswarms.__file__)\n"
        "model = kswarms.ForagingModel(n=4, policies='attack,agents.py:Mine', duration=2)\n"
        "model.play()\n"
        "print(model.ended, [row['policy'] for row in model.results()])\n"
    ),
}


def run(*command: str | Path, cwd: Path, **environment: str) -> str:
    done = subprocess.run(
        [sys.executable, *command],
        cwd=cwd,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def build(tree: Path, kind: str, directory: Path) -> Path:
    # Without isolation: hatchling is installed, in the version that pyproject.toml asks for.
    run("-m", "build", "--no-isolation", f"--{kind}", "--outdir", directory, cwd=tree)
    (package,) = directory.iterdir()
    return package


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build(ROOT, "wheel", tmp_path_factory.mktemp("wheel"))


@pytest.mark.slow
def test_the_wheel_contains_the_files_of_kswarms_and_no_links(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        entries = archive.infolist()
    metadata = f"kswarms-{kswarms.__version__}.dist-info"
    assert {entry.filename.split("/")[0] for entry in entries} == {"kswarms", metadata}
    assert not [entry.filename for entry in entries if stat.S_ISLNK(entry.external_attr >> 16)]
    packed = {entry.filename for entry in entries}
    # Every file of the packages, data included: tables, findings, templates, components of the page.
    tracked = subprocess.run(
        ["git", "ls-files", "agents", "model", "scenarios", "analysis"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    ).stdout.split()
    assert {".py", ".csv", ".toml", ".html", ".css", ".vue"} == {Path(name).suffix for name in tracked}
    assert {f"kswarms/{name}" for name in tracked} | {"kswarms/__init__.py", "kswarms/py.typed"} == {
        name for name in packed if not name.startswith(metadata)
    }


@pytest.fixture(scope="module")
def source_distribution(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build(ROOT, "sdist", tmp_path_factory.mktemp("sdist"))


@pytest.mark.slow
def test_the_source_distribution_builds_the_same_wheel(
    wheel: Path, source_distribution: Path, tmp_path: Path
) -> None:
    with tarfile.open(source_distribution) as archive:
        archive.extractall(tmp_path, filter="data")
    (tree,) = tmp_path.glob("kswarms-*")
    assert build(tree, "wheel", tmp_path / "wheel").read_bytes() == wheel.read_bytes()


@pytest.mark.slow
def test_an_index_would_accept_the_packages(wheel: Path, source_distribution: Path) -> None:
    checked = run("-m", "twine", "--no-color", "check", "--strict", wheel, source_distribution, cwd=ROOT)
    assert checked.count("PASSED") == 2


@pytest.mark.slow
@pytest.mark.parametrize("extra", ["", "all", "test"])
def test_no_usual_installation_needs_torch(wheel: Path, extra: str) -> None:
    found = requirements_of(wheel, extra)
    assert {"mesa", "numba"} < found
    assert ("solara" in found) == (extra != "")
    assert not {name for name in found if "torch" in name or name.startswith("nvidia")}


def requirements_of(wheel: Path, extra: str) -> set[str]:
    """Return the names of the libraries that the wheel needs with an extra."""
    name = f"kswarms-{kswarms.__version__}.dist-info/METADATA"
    lines = zipfile.ZipFile(wheel).read(name).decode().splitlines()
    prefix = "Requires-Dist: "
    requirements = [Requirement(line.removeprefix(prefix)) for line in lines if line.startswith(prefix)]
    names, extras, seen = set(), {extra}, set()
    while extras:
        seen.add(extra := extras.pop())
        for requirement in requirements:
            if requirement.marker is None or requirement.marker.evaluate({"extra": extra}):
                names.add(requirement.name)
                extras |= (requirement.extras if requirement.name == "kswarms" else set()) - seen
    return names


@pytest.mark.slow
def test_the_wheel_plays_beside_modules_of_the_user_named_like_its_packages(
    wheel: Path, tmp_path: Path
) -> None:
    installed, folder = tmp_path / "installed", tmp_path / "folder"
    folder.mkdir()
    for name, code in USER_MODULES.items():
        (folder / name).write_text(code)
    quiet = ("--quiet", "--disable-pip-version-check", "--no-deps", "--no-index")
    run("-m", "pip", "install", *quiet, "--target", installed, wheel, cwd=tmp_path)
    # Compiling without optimization saves half of the time.
    environment = {"PYTHONPATH": str(installed), "NUMBA_OPT": "0"}
    where, played = run("play.py", cwd=folder, **environment).splitlines()
    assert where == str(installed / "kswarms" / "__init__.py")
    assert played == "time ['attack', 'agents.py:Mine']"
    listing = run("-P", installed / "bin" / "kswarms", "list", cwd=folder, **environment)
    assert "fig-6.1a" in listing
