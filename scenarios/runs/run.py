"""From scenarios to runs: what has to be played, each game once however many figures ask for it."""

import hashlib
import json
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Final

from kswarms.agents.common.errors import InputError
from kswarms.agents.policies.registry import parts
from kswarms.agents.policies.user_policy import files
from kswarms.model.description.game import Game
from kswarms.scenarios.description.scenario import Condition, Scenario
from kswarms.scenarios.runs.cost import cpu_seconds

LAST_SEED: Final = 2**53
"""Seeds are not greater, so that every table and file has them whole."""


@dataclass(frozen=True)
class Run:
    """One game with one seed.

    Attributes
    ----------
    digest : str
        Names what is simulated (`digest`), whoever asked for it.
    game : Game
        What is played.
    seed : int
        Seed index, ≥ 0.
    labels : tuple of (scenario, condition)
        The curves that the run belongs to.
    """

    digest: str
    game: Game
    seed: int
    labels: tuple[tuple[str, str], ...]

    @property
    def n(self) -> int:
        """Robots in all."""
        return self.game.size

    @property
    def effort(self) -> float:
        """CPU time that it takes, roughly (s), by which long runs are told from short ones."""
        game = self.game
        return cpu_seconds(self.n, game.learning, game.duration, game.puck_limit, game.parameters.period)


@cache
def package_version() -> str:
    """Return the version of this package."""
    return version("kswarms")


@cache
def code_version() -> str:
    """Return the version of this package with a fingerprint of the code that plays: of `agents` and `model`.

    Two states of the code that a developer gave no versions of their own differ in it.
    """
    root = Path(__file__).resolve().parents[2]
    content = hashlib.sha256()
    for package in ("agents", "model"):
        for path in sorted((root / package).rglob("*.py")):
            content.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes())
    return f"{package_version()} {content.hexdigest()[:12]}"


def digest(game: Game, seed: int) -> str:
    """Return the name of what is simulated: 16 hexadecimal digits of a SHA-256.

    It covers the game, the learned policies and the users' code that it loads, the seed and the version of
    the package, so two runs of one name have the same results. 64 bits keep a study of a million runs clear
    of collisions (odds of 3 in 10⁸).
    """
    return digests(game, (seed,))[0]


def digests(game: Game, seeds: Iterable[int]) -> list[str]:
    """Return the names of one game with several seeds, each as `digest` gives it."""
    content = {
        "game": game.model_dump(mode="json"),
        "files": _contents(game),
        "version": package_version(),
    }
    return [_hash({**content, "seed": seed}) for seed in seeds]


def describe_curve(condition: Condition, n: int) -> str:
    """Return what decides the results of a curve, but the number of robots and the seed, as JSON.

    Parameters
    ----------
    condition : Condition
        The curve.
    n : int
        Any of its numbers of robots.
    """
    game = condition.game(n)
    content = {
        "condition": condition.model_dump(mode="json"),
        "parameters": game.parameters.model_dump(mode="json"),  # what a preset's name stands for
        "files": _contents(game),
    }
    return _json(content)


def _hash(content: object) -> str:
    return hashlib.sha256(_json(content).encode()).hexdigest()[:16]


def _json(content: object) -> str:
    return json.dumps(content, sort_keys=True, separators=(",", ":"))


def _contents(game: Game) -> list[str]:
    return [hashlib.sha256(file.read_bytes()).hexdigest() for file in _loaded(game)]


def _loaded(game: Game) -> list[Path]:
    """Return the files of learned policies and of users' code that play in a game."""
    return [file for swarm in game.swarms for text in parts(swarm.policy) for file in files(text)]


def require_unchanged(run: Run) -> None:
    """Make sure that a run still is what its name says.

    Raises
    ------
    InputError
        If a file that it is made of was changed since it was named.
    """
    loaded = _loaded(run.game)
    try:
        changed = bool(loaded) and digest(run.game, run.seed) != run.digest
    except OSError:  # it is gone
        changed = True
    if changed:
        names = ", ".join(dict.fromkeys(map(str, loaded)))
        raise InputError("policy", names, "must not change while its games are played")


def expand(scenarios: Iterable[Scenario], first_seed: int = 0) -> list[Run]:
    """Return the runs of scenarios: conditions × densities × seeds, each game and seed once.

    Parameters
    ----------
    scenarios : iterable of Scenario
        What is asked for.
    first_seed : int
        The seeds are this one and the following.
    """
    runs: dict[str, Run] = {}
    for scenario in scenarios:
        for condition in scenario.conditions:
            label = (scenario.id, condition.name)
            for n in scenario.densities:
                game = condition.game(n)
                seeds = range(first_seed, first_seed + scenario.seeds)
                for seed, name in zip(seeds, digests(game, seeds), strict=True):
                    labels = runs[name].labels if name in runs else ()
                    runs[name] = Run(name, game, seed, (*labels, label))
    return list(runs.values())
