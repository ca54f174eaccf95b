"""Games for tests: construction, playing, and checks that hold for every game."""

from typing import Any

import pytest

from kswarms.model.description.game import Game, Swarm
from kswarms.model.game_model import GameModel

ALL_TABLES = "conflicts,robots,trajectory"


def make_game(*policies: str, size: int = 6, **fields: Any) -> Game:
    """Return a game of equally large swarms, one per policy."""
    return Game(swarms=tuple(Swarm(policy=policy, size=size) for policy in policies), **fields)


def play(game: Game, seed: int = 0, record: str = ALL_TABLES) -> GameModel:
    model = GameModel(game, seed, record)
    model.play()
    return model


def play_learning_phase(game: Game, seed: int = 0, record: str = ALL_TABLES) -> GameModel:
    """Play the learning phase only; no robot has decided or moved in the measured game."""
    model = GameModel(game.replace(sample_period=game.learning), seed, record)
    model.step()
    assert (model.env.now, model.phase) == (model.game_begin, "game")
    return model


def conflicts_of(model: GameModel, phase: str) -> list[dict[str, Any]]:
    """Return the recorded conflicts of a phase as rows."""
    table = model.tables()["conflicts"]
    rows = [dict(zip(table, values, strict=True)) for values in zip(*table.values(), strict=True)]
    return [row for row in rows if row["phase"] == phase]


def check_times_and_pucks(model: GameModel) -> None:
    """Check that the times of the measured game add up to its duration, and pucks to those picked up."""
    measured = model.env.now - model.game_begin
    for robot in model.robots:
        t_a, t_p = robot.times()
        assert sum(t_a) + t_p == measured
        assert min(*t_a, t_p) >= 0
    for row in model.results():
        assert row["duration"] == pytest.approx(measured * model.game.parameters.period)
        times = row["t_a_intra"] + row["t_a_inter"] + row["t_p"]
        assert times == pytest.approx(row["size"] * row["duration"], abs=1e-6)
    carried = sum(robot.carrying for robot in model.robots)
    assert model.picked_up + model.carried_at_start == sum(model.pucks) + carried
    assert model.pucks == [sum(robot.pucks for robot in members) for members in model.members]
