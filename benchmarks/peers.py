"""Robot-seconds per CPU second of kswarms and of other simulators, in one run.

Run ``python -m benchmarks.peers [DIRECTORY]``. The others are installed into an environment in DIRECTORY,
which is kept, or else in a temporary directory. kswarms plays in the environment of this command. VMAS is
measured only where PyTorch is installed already. `benchmarks.peer_worlds` has the worlds.
"""

import os
import statistics
import subprocess
import sys
import tempfile
import venv
from importlib.util import find_spec
from pathlib import Path
from typing import Final

from benchmarks import peer_worlds
from benchmarks.bench import print_table

PACKAGES: Final = ("mesa==3.3.1", "scipy", "networkx", "simpy==4.1.2", "pymunk==7.3.1")
VMAS_PACKAGES: Final = (
    "vmas==1.5.2",
    "gym==0.26.2",
    "gym-notices==0.0.8",
    "pyglet==1.5.27",
    "six",
    "cloudpickle",
)
"""VMAS and what it needs, without PyTorch."""


PEERS: Final = {
    "kswarms": "complete games of avoid against attack with their set-up",
    "simpy": "as many timeouts as these games have events; nothing else",
    "mesa": "a query of neighbours and a move of each agent in each period of 0.1 s; no contacts",
    "pymunk, 1 sub-step": "driven discs with contacts and friction, solved each 0.1 s",
    "pymunk, 10 sub-steps": "the same, solved each 0.01 s",
    "vmas": f"{peer_worlds.BATCH:,} games at once of driven discs, pushed apart by forces each 0.1 s",
}
"""What each world simulates. Only kswarms has sensors, conflicts, policies, scores and foraging."""


def install(directory: Path) -> Path:
    """Install the other simulators into an environment; return its interpreter."""
    if not (directory / "bin" / "python").exists():
        venv.create(directory, with_pip=True)
    _pip(directory, *PACKAGES)
    if find_spec("torch") is not None:
        _pip(directory, "--no-deps", "--target", str(directory / "vmas"), *VMAS_PACKAGES)
    return directory / "bin" / "python"


def _pip(directory: Path, *words: str) -> None:
    command = [directory / "bin" / "python", "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    subprocess.run([*command, *words], check=True)


def measure(name: str, python: Path, cpu_seconds: float) -> float:
    """Return the robot-seconds per CPU second of a world, in a new process with one thread."""
    paths = [str(Path(__file__).parents[1])] if name == "kswarms" else []
    if name == "vmas":
        paths = [str(python.parents[1] / "vmas")]
    own = name in ("kswarms", "vmas")
    threads = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    # -P: the directory of the script has a module `profile`, as the standard library has.
    command = [sys.executable if own else str(python), "-P", peer_worlds.__file__, name, str(cpu_seconds)]
    environment = {**os.environ, **threads, "PYTHONPATH": os.pathsep.join(paths)}
    done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, text=True, check=True)
    return float(done.stdout.split()[-1])


def main(directory: Path | None = None, cpu_seconds: float = 3.0, rounds: int = 3) -> None:
    """Install the simulators and print a table of their speeds: medians of several rounds, taken in turn."""
    with tempfile.TemporaryDirectory() as temporary:
        python = install(directory or Path(temporary))
        names = [name for name in PEERS if name != "vmas" or find_spec("torch") is not None]
        speeds: dict[str, list[float]] = {name: [] for name in names}
        for _ in range(rounds):
            for name in names:
                speeds[name].append(measure(name, python, cpu_seconds))
    medians = {name: statistics.median(values) for name, values in speeds.items()}
    missing = [] if "vmas" in names else ["vmas: not measured, PyTorch is not installed"]
    print_table(
        f"{peer_worlds.ROBOTS} robots in a square of {peer_worlds.SIDE:g} m, one thread",
        ["simulator", "robot-s/CPU-s", "× kswarms"],
        [[name, f"{speed:,.0f}", f"{speed / medians['kswarms']:.2f}"] for name, speed in medians.items()],
        "\n  ".join([*(f"{name}: {PEERS[name]}" for name in names), *missing]),
    )


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:2]))
