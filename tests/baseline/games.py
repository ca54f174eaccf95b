"""Digests of the results of many games, to show that a change of the code does not change them.

Run as a script, this module plays all games and writes ``digests.json`` beside it. Do so only if results
should change, and note it in the change log.
"""

import hashlib
import json
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

import numpy as np

from kswarms.agents.actions import Action
from kswarms.model.description.game import Game, Swarm
from kswarms.model.description.presets import parse_parameters
from kswarms.model.game_model import GameModel
from kswarms.model.recorder import save_policies
from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.runs.play import play
from kswarms.scenarios.runs.run import Run, digest

FILE: Final = Path(__file__).with_name("digests.json")
RECORDS: Final = "conflicts,robots,trajectory"

# The columns of version 0.1.0; later ones are not compared, so that adding a column changes no digest.
COLUMNS: Final = {
    "runs": (
        *("swarm", "size", "policy", "pucks", "sud", "t_a_intra", "t_a_inter", "t_p"),
        *("conflicts_intra", "conflicts_inter", "duration", "ended"),
    ),
    "policies": ("swarm", "opponent", "action", "share", "attack_share"),
    "conflicts": (
        *("phase", "robot", "swarm", "opponent", "opponent_swarm", "start", "x", "y"),
        *("action", "t_a", "t_p", "active", "seen", "reward", "q"),
    ),
    "robots": ("robot", "swarm", "policy", "pucks", "t_a", "t_p", "arms"),
    "trajectory": ("time", "robot", "x", "y", "heading", "state", "puck"),
}


def catalogue_games() -> Iterator[tuple[str, Game, int]]:
    """Yield a name, game and seed for every condition of the catalogue at two densities."""
    for scenario in CATALOGUE.values():
        for condition in scenario.conditions:
            for k, n in enumerate((scenario.densities[0], scenario.densities[len(scenario.densities) // 2])):
                yield f"{scenario.id}/{condition.name}/n={n}/seed={k}", condition.game(n), k


def other_games(directory: Path) -> Iterator[tuple[str, Game, int]]:
    """Yield games with features that the catalogue lacks; learned policies are saved into `directory`."""

    def game(*swarms: tuple[Any, ...], parameters: str = "fitted", **rest: Any) -> Game:
        fields = ("policy", "size", "drive", "drive_action")
        return Game(
            swarms=tuple(Swarm(**dict(zip(fields, swarm, strict=False))) for swarm in swarms),
            parameters=parse_parameters(parameters),
            **{"duration": 120.0, **rest},
        )

    several = ("avoid", "attack", "aggressive", "random", "mixed")
    for k in range(1, 6):
        yield f"swarms={k}", game(*((policy, 8) for policy in several[:k])), 7
    yield "preempt", game(("attack", 12), ("mixed", 12), parameters="fitted, preempt=true"), 3
    yield "push share", game(("aggressive", 14), ("attack", 14), parameters="argos, push_share=0.5"), 4
    yield "wall rays", game(("random", 10), parameters="fitted, wall_half_angle=0.7, wall_escape=away"), 5
    for absent_from in ("learning", "game"):
        yield (
            f"absent from {absent_from}",
            game(("attack", 8), ("learner", 8), learning=60.0, absent=(3, 11), absent_from=absent_from),
            6,
        )
    yield "drives", game(("avoid", 8, 0.7, 0.6), ("attack", 8, 0.5, 0.9)), 8
    small = "fitted, station_radius=0.07, base_radius=0.07"
    yield "krembots", game(("avoid", 8), ("attack", 8), parameters=small, body="krembot", side=1.0), 9
    yield "supply and limit", game(("attack", 10), ("avoid", 10), supply=9, puck_limit=12, duration=900.0), 10
    yield "layouts", game(("avoid", 9), ("avoid", 9), layout="random-stations", side=3.0), 11
    actions = (
        Action(name="out", direction=-1, duration=0.7),
        Action(name="wait", direction=-1, duration=0.1),
        Action(name="in", direction=1, duration=1.3),
    )
    learners = (
        "learner(reward='individual', rule='discounted-ucb', otherwise='wait')+in",
        "inter-learner(reward='wlu(delta={1: 0.02}, b=1.2)', rule='periodic-random(every=3)')",
        "intra-learner(rule='greedy')",
    )
    yield "actions", game(*((policy, 6) for policy in learners), actions=actions, learning=200.0), 12
    taught = GameModel(game(("attack", 8), ("learner", 8), learning=300.0), seed=13)
    taught.play()
    save_policies(taught, 2, directory / "learned.json")
    yield "learned file", game(("attack", 8), (f"learned(file='{directory}/learned.json')", 8)), 14


def digests(games: Iterable[tuple[str, Game, int]]) -> Iterator[tuple[str, dict[str, str]]]:
    """Play games; yield each name with a digest of every table of the game."""
    for name, game, seed in games:
        outcome = play(Run(digest(game, seed), game, seed, ((name, ""),)), RECORDS)
        rows = {"runs": outcome.swarms, "policies": outcome.policies}
        tables = {table: {c: [row[c] for row in rows[table]] for c in COLUMNS[table]} for table in rows}
        tables |= {t: {c: outcome.records[t][c] for c in COLUMNS[t]} for t in outcome.records}
        # The texts of policies name temporary files.
        yield name, {table: _digest(columns, name) for table, columns in tables.items()}


def _digest(columns: dict[str, list[Any]], name: str) -> str:
    kept = {c: values for c, values in columns.items() if c != "policy" or name != "learned file"}
    text = json.dumps(kept, sort_keys=True, default=np.ndarray.tolist)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def main() -> None:
    """Write the digests of all games."""
    with TemporaryDirectory() as directory:
        found = dict(digests([*catalogue_games(), *other_games(Path(directory))]))
    FILE.write_text(json.dumps(found, indent=1) + "\n")
    sys.stdout.write(f"{len(found)} games\n")


if __name__ == "__main__":
    main()
