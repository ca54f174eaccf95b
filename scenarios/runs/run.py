"""Runs: a game with a seed, and the runs of scenarios."""

import hashlib
import json
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from kswarms import __version__
from kswarms.agents.common.errors import InputError
from kswarms.agents.policies.spec import parse_policies
from kswarms.model.description.game import Game
from kswarms.scenarios.description.condition import Condition
from kswarms.scenarios.description.scenario import Scenario
from kswarms.scenarios.runs.cost import cpu_seconds


@dataclass(frozen=True)
class Run:
    """One game with one seed.

    Attributes
    ----------
    digest : str
        Identifies what is simulated (see `digest`).
    game : Game
        The game.
    seed : int
        Its seed, ≥ 0.
    labels : tuple of (scenario, condition)
        The curves that contain the run.
    """

    digest: str
    game: Game
    seed: int
    labels: tuple[tuple[str, str], ...]

    def __str__(self) -> str:
        scenario, condition = self.labels[0]
        return f"run scenario={scenario!r} condition={condition!r} n={self.n} seed={self.seed}"

    @property
    def n(self) -> int:
        """Robots in all."""
        return self.game.size

    @property
    def effort(self) -> float:
        """Estimated CPU time (s)."""
        game = self.game
        return cpu_seconds(self.n, game.learning, game.duration, game.puck_limit, game.parameters.period)


@cache
def code_version() -> str:
    """Return the version of the package with a hash of `agents` and `model`, which decide the results."""
    root = Path(__file__).resolve().parents[2]
    content = hashlib.sha256()
    for package in ("agents", "model"):
        for path in sorted((root / package).rglob("*.py")):
            content.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes())
    return f"{__version__} {content.hexdigest()[:12]}"


def digest(game: Game, seed: int) -> str:
    """Return an identifier of what is simulated: 16 hexadecimal digits of a SHA-256.

    It covers the game, the learned policies and user code that it loads, the seed and the version of the
    package, so runs with equal digests have equal results. In a million runs, the probability of a
    collision of 64 bits is 3 in 10⁸.
    """
    return digests(game, (seed,))[0]


def digests(game: Game, seeds: Iterable[int]) -> list[str]:
    """Return the `digest` of a game with each of several seeds."""
    content = {"game": game.model_dump(mode="json"), "files": _file_hashes(game), "version": __version__}
    return [_sha256(_json({**content, "seed": seed}).encode())[:16] for seed in seeds]


def describe_curve(condition: Condition, n: int) -> str:
    """Return all that decides the results of a curve, except seed and `n` (any of its densities), as JSON."""
    return _json({"condition": condition.model_dump(mode="json"), "files": _file_hashes(condition.game(n))})


def _json(content: object) -> str:
    return json.dumps(content, sort_keys=True, separators=(",", ":"))


def _sha256(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def _file_hashes(game: Game) -> list[str]:
    return [_sha256(file.read_bytes()) for file in _files(game)]


def _files(game: Game) -> list[Path]:
    specs = (spec for swarm in game.swarms for spec in parse_policies(swarm.policy))
    return [file for spec in specs for file in spec.files()]


def require_unchanged(run: Run) -> None:
    """Check that the files that a run loads are those of its digest.

    Raises
    ------
    InputError
        If a file was changed or removed.
    """
    loaded = _files(run.game)
    try:
        changed = bool(loaded) and digest(run.game, run.seed) != run.digest
    except OSError:
        changed = True
    if changed:
        names = ", ".join(dict.fromkeys(map(str, loaded)))
        raise InputError("policy", names, "must not change while its games are played")


def expand(scenarios: Iterable[Scenario], first_seed: int = 0) -> list[Run]:
    """Return the runs of scenarios: conditions × densities × consecutive seeds, each game and seed once."""
    runs: dict[str, Run] = {}
    for scenario in scenarios:
        seeds = range(first_seed, first_seed + scenario.seeds)
        for condition in scenario.conditions:
            label = (scenario.id, condition.name)
            for n in scenario.densities:
                game = condition.game(n)
                for seed, name in zip(seeds, digests(game, seeds), strict=True):
                    labels = runs[name].labels if name in runs else ()
                    runs[name] = Run(name, game, seed, (*labels, label))
    return list(runs.values())
