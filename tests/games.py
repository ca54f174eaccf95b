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


def game_under_way(*policies: str, seconds: float = 20.0, seed: int = 1, **fields: Any) -> GameModel:
    """Return a game that was played for some time."""
    policies = policies or ("attack", "learner")
    model = GameModel(make_game(*policies, **{"duration": 60.0, **fields}), seed, ALL_TABLES)
    model.env.run(until=round(seconds * 10))
    return model


def conflicts_of(model: GameModel, phase: str) -> list[dict[str, Any]]:
    """Return the recorded conflicts of a phase as rows."""
    table = model.tables()["conflicts"]
    rows = [dict(zip(table, values, strict=True)) for values in zip(*table.values(), strict=True)]
    return [row for row in rows if row["phase"] == phase]


def check_times_and_pucks(model: GameModel) -> None:
    """Check that the times of the measured game add up to its duration, and pucks to those picked up."""
    measured = model.env.now - model.game_begin
    missed = [0.0] * len(model.members)  # by removed robots
    for robot in model.robots + model.removed:
        t_a, t_p = robot.times()
        assert min(*t_a, t_p) >= 0
        missed[robot.swarm] += measured - sum(t_a) - t_p
        assert sum(t_a) + t_p <= measured if robot in model.removed else sum(t_a) + t_p == measured
    period = model.game.parameters.period
    for row, missing in zip(model.results(), missed, strict=True):
        assert row["duration"] == pytest.approx(measured * period)
        times = row["t_a_intra"] + row["t_a_inter"] + row["t_p"]
        assert times + missing * period == pytest.approx(row["size"] * row["duration"], abs=1e-6)
    carried = sum(robot.carrying for robot in model.robots)
    assert model.picked_up + model.carried_at_start == sum(model.pucks) + carried + model.lost
    players = [model.players(swarm) for swarm in range(len(model.members))]
    assert model.pucks == [sum(robot.pucks for robot in members) for members in players]
