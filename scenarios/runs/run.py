"""A run (a game with a seed), its digest, and the runs of scenarios."""

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from hashlib import file_digest, sha256
from pathlib import Path
from typing import Final, Literal

from kswarms import __version__
from kswarms.agents.common.errors import InputError
from kswarms.agents.common.input_files import require_regular_file
from kswarms.agents.policies.spec import parse_policies
from kswarms.model.description.game import Game
from kswarms.scenarios.description.condition import Condition
from kswarms.scenarios.description.scenario import Scenario

_ROBOT_SECOND: Final = 5e-6
"""CPU time per robot and second of play, at a control period of 0.1 s (s)."""
_ROBOT_SECONDS_PER_PUCK: Final = 300.0
"""Play per puck, in games that end at a number of pucks (robot-seconds)."""


Order = Literal["longest", "seeds"]
"""Order of play: the longest runs first, or all runs of the first seed first."""


@dataclass(frozen=True)
class Run:
    """One game with one seed."""

    digest: str
    """Identifier of the simulation (see `digest`)."""
    game: Game
    seed: int
    """Seed of the game, ≥ 0."""
    labels: tuple[tuple[str, str], ...]
    """Scenario and condition of each curve that contains the run."""

    def __str__(self) -> str:
        scenario, condition = self.labels[0]
        return f"run scenario={scenario!r} condition={condition!r} n={self.n} seed={self.seed}"

    @property
    def n(self) -> int:
        """Number of robots."""
        return self.game.size

    @property
    def effort(self) -> float:
        """Estimated CPU time (s)."""
        game = self.game
        return cpu_seconds(self.n, game.learning, game.duration, game.puck_limit, game.parameters.period)


def cpu_seconds(n: int, learning: float, duration: float, puck_limit: int | None, period: float) -> float:
    """Estimate the CPU time (s) of a run of `n` robots, given its durations and control period (s)."""
    duration = learning + expected_duration(n, duration, puck_limit)
    return _ROBOT_SECOND * n * duration * (0.1 / period)


def expected_duration(n: int, duration: float, puck_limit: int | None) -> float:
    """Estimate the length of the measured game (s)."""
    return duration if puck_limit is None else min(duration, puck_limit * _ROBOT_SECONDS_PER_PUCK / n)


@cache
def code_version() -> str:
    """Return the version of the package and a hash of the code that affects results."""
    root = Path(__file__).resolve().parents[2]
    content = sha256()
    for package in ("agents", "model"):
        for path in sorted((root / package).rglob("*.py")):
            content.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes())
    return f"{__version__} {content.hexdigest()[:12]}"


def digest(game: Game, seed: int) -> str:
    """Return an identifier of a simulation: 16 hexadecimal digits of a SHA-256.

    It covers the game, the files that it loads (learned policies, user code), the seed and the version of the
    package: equal digests mean equal results. A collision among a million runs has probability 3 in 10⁸.
    """
    return digests(game, (seed,))[0]


def digests(game: Game, seeds: Iterable[int]) -> list[str]:
    """Return the `digest` of a game with each of several seeds."""
    content = {"game": game.model_dump(mode="json"), "files": _file_hashes(game), "version": __version__}
    return [sha256(_json({**content, "seed": seed}).encode()).hexdigest()[:16] for seed in seeds]


def describe_curve(condition: Condition, n: int) -> str:
    """Describe a curve as JSON: its condition and the hashes of loaded files. `n` is any of its densities."""
    return _json({"condition": condition.model_dump(mode="json"), "files": _file_hashes(condition.game(n))})


def _json(content: object) -> str:
    return json.dumps(content, sort_keys=True, separators=(",", ":"))


def _file_hashes(game: Game) -> list[str]:
    return [hash_file(file) for file in loaded_files(game)]


def hash_file(path: Path) -> str:
    """Return the SHA-256 of a regular file, which may have any size."""
    require_regular_file("policy", path)
    with path.open("rb") as file:
        return file_digest(file, "sha256").hexdigest()


def loaded_files(game: Game) -> list[Path]:
    """Return the files that a game loads: user-defined code and learned policies."""
    specs = (spec for swarm in game.swarms for spec in parse_policies(swarm.policy))
    return [file for spec in specs for file in spec.files()]


def user_code_files(game: Game) -> list[Path]:
    """Return the files with user-defined code that a game executes, each once."""
    specs = (spec for swarm in game.swarms for spec in parse_policies(swarm.policy))
    return list(dict.fromkeys(file for spec in specs for file in spec.code_files()))


def require_unchanged(run: Run) -> None:
    """Raise an `InputError` if a file that the run loads has changed since its digest was computed."""
    loaded = loaded_files(run.game)
    try:
        changed = bool(loaded) and digest(run.game, run.seed) != run.digest
    except (OSError, InputError):
        changed = True
    if changed:
        names = ", ".join(dict.fromkeys(map(str, loaded)))
        raise InputError("policy", names, "must not change while its games are played")


def expand(scenarios: Iterable[Scenario], first_seed: int = 0) -> list[Run]:
    """Return the runs of scenarios: conditions × densities × seeds, each pair of game and seed once.

    The seeds of a scenario are consecutive, from `first_seed`. A run in several curves has all their labels.
    """
    runs: dict[str, Run] = {}
    for scenario in scenarios:
        seeds = range(first_seed, first_seed + scenario.seeds)
        for condition in scenario.conditions:
            label = (scenario.id, condition.name)
            for n in scenario.densities:
                game = condition.game(n)
                for seed, run_digest in zip(seeds, digests(game, seeds), strict=True):
                    labels = runs[run_digest].labels if run_digest in runs else ()
                    runs[run_digest] = Run(run_digest, game, seed, (*labels, label))
    return list(runs.values())


def sort_runs(runs: Iterable[Run], order: Order) -> list[Run]:
    """Sort runs in the order of play: the longest first, of all runs or of each seed."""
    return sorted(runs, key=lambda run: (run.seed if order == "seeds" else 0, -run.effort))


def select_shard(runs: Sequence[Run], part: int, parts: int) -> list[Run]:
    """Return one of several parts of runs, whose efforts are about equal; `part` counts from 1.

    Each run is in one part. The parts depend on the runs alone, not on what has been played.
    """
    dealt = sorted(runs, key=lambda run: (-run.effort, run.digest))[part - 1 :: parts]
    chosen = {run.digest for run in dealt}
    return [run for run in runs if run.digest in chosen]
