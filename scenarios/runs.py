"""From scenarios to runs: what has to be played, each game once however many figures ask for it."""

import hashlib
import json
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from pathlib import Path

from agents.errors import InputError
from agents.own import files
from agents.policies import parts
from model.game import Game
from scenarios.description import Scenario


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
        """Robot-periods at most, those of learning included, by which long runs are told from short ones."""
        return self.n * (self.game.learning + self.game.duration) / self.game.parameters.period


@cache
def package_version() -> str:
    """Return the version of this package."""
    return version("kswarms")


def digest(game: Game, seed: int) -> str:
    """Return the name of what is simulated: 16 hexadecimal digits of a SHA-256.

    It covers the game, the learned policies and the users' code that it loads, the seed and the version of
    the package, so two runs of one name have the same results. 64 bits keep a study of a million runs clear
    of collisions (odds of 3 in 10⁸).
    """
    content = {
        "game": game.model_dump(mode="json"),
        "files": [hashlib.sha256(file.read_bytes()).hexdigest() for file in _loaded(game)],
        "seed": seed,
        "version": package_version(),
    }
    text = json.dumps(content, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()[:16]


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
    if (loaded := _loaded(run.game)) and digest(run.game, run.seed) != run.digest:
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
                for seed in range(first_seed, first_seed + scenario.seeds):
                    name = digest(game, seed)
                    labels = runs[name].labels if name in runs else ()
                    runs[name] = Run(name, game, seed, (*labels, label))
    return list(runs.values())
