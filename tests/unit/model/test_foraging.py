"""Games from numbers and texts: arguments of the game, and errors."""

import math
from typing import Any

import numpy as np
import pytest

from kswarms.agents.common.errors import InputError
from kswarms.model.description.game import Game, Swarm
from kswarms.model.foraging import ForagingModel


def test_the_defaults() -> None:
    game = ForagingModel().game
    assert game == Game(swarms=(Swarm(policy="avoid", size=10), Swarm(policy="attack", size=10)))


@pytest.mark.parametrize(
    ("arguments", "swarms"),
    [
        ({"n": 7, "policies": "mixed"}, [("mixed", 7, 0.6, 0.6)]),
        ({"n": 7, "policies": " avoid , attack"}, [("avoid", 4, 0.6, 0.6), ("attack", 3, 0.6, 0.6)]),
        ({"n": 7, "policies": ["avoid", "attack"]}, [("avoid", 4, 0.6, 0.6), ("attack", 3, 0.6, 0.6)]),
        (
            {"n": 13, "policies": "avoid,avoid", "shares": "7:6"},
            [("avoid", 7, 0.6, 0.6), ("avoid", 6, 0.6, 0.6)],
        ),
        (
            {"n": 8, "policies": "avoid,attack,fight", "shares": "1:2:1", "drives": "0.7,0.6/0.65,0.5"},
            [("avoid", 2, 0.7, 0.6), ("attack", 4, 0.6, 0.65), ("fight", 2, 0.5, 0.6)],
        ),
    ],
)
def test_swarms_are_read_from_text(
    arguments: dict[str, Any], swarms: list[tuple[str, int, float, float]]
) -> None:
    game = ForagingModel(**arguments).game
    assert [(s.policy, s.size, s.drive, s.drive_action) for s in game.swarms] == swarms


def test_the_other_arguments_reach_the_game() -> None:
    fields = {"layout": "nearer-station", "body": "krembot", "parameters": "argos, friction=0.2"}
    fields |= {"duration": 30.0, "side": 1.5, "puck_limit": 5, "supply": 7}
    model = ForagingModel(**fields, seed=12)
    assert model.game == Game(swarms=ForagingModel().game.swarms, **fields)
    assert model.seed == 12
    assert model.supply == [7, 7]


def test_numpy_numbers_are_accepted() -> None:
    assert ForagingModel(n=np.int64(12), seed=np.int64(3), duration=np.float64(20)).game.size == 12  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"n": 1}, "n=1: must be a whole number ≥ 2"),
        ({"n": 0}, "n=0: "),
        ({"n": 10**400}, "n=1000000"),
        ({"n": 5.5}, "n=5.5: must be a whole number"),
        ({"n": math.nan}, "n=nan: "),
        ({"n": "ten"}, "n='ten': "),
        ({"n": 300}, "n=300: robots of radius 0.085 m do not fit in a square of 2.0 m"),
        ({"policies": ""}, "policies='': must be a text or a sequence"),
        ({"policies": "avoid,flee"}, "policy='flee': must be one of avoid"),
        ({"shares": "7"}, "shares='7': must be 2 whole numbers"),
        ({"shares": "7:6:5"}, "shares='7:6:5': must be 2 whole numbers"),
        ({"shares": "7:0"}, "shares='7:0': must be 2 whole numbers ≥ 1"),
        ({"shares": "7:x"}, "shares='7:x': must be 2 whole numbers ≥ 1 separated by ':'"),
        ({"shares": "7:6.5"}, "shares='7:6.5': "),
        ({"n": 4, "shares": "1:100"}, "size=0: must be greater than or equal to 1"),
        ({"drives": "0.7"}, "drives='0.7': must be 2 numbers separated by ','"),
        ({"drives": "0.7,0.6,0.6"}, "drives='0.7,0.6,0.6': must be 2 numbers"),
        ({"drives": "0.7,fast"}, "drive='fast': must be a number"),
        ({"drives": "0.7,0"}, "drive=0.0: must be greater than or equal to 0.001"),
        ({"drives": "0.7,-0.6"}, "drive=-0.6: must be greater than or equal to 0.001"),
        ({"drives": "0.7,nan"}, "drive=nan: must be a finite number"),
        ({"drives": "0.7,0.6/2"}, "drive_action=2.0: must be less than or equal to 1"),
        ({"parameters": "fast"}, "parameters='fast': must begin with one of"),
        ({"duration": 0}, "duration=0: must be greater than or equal to 0.000001"),
        ({"seed": -1}, "seed=-1: must be a whole number ≥ 0"),
        ({"seed": 1.5}, "seed=1.5: must be a whole number"),
        ({"record": "video"}, "record='video': must be one of model, agents, conflicts, robots, trajectory"),
        ({"record": "model,video"}, "record='video': "),
        ({"policies": None}, "policies=None: must be a text or a sequence"),
        ({"policies": []}, "policies=[]: must be a text or a sequence"),
        ({"shares": 3}, "shares=3: must be a text"),
        ({"drives": 0.6}, "drives=0.6: must be a text"),
        ({"parameters": None}, "parameters=None: must be a valid dictionary or"),
        ({"record": ["model"]}, "record=['model']: must be a text"),
        ({"seed": True}, "seed=True: must be a whole number"),
        ({"n": True}, "n=True: must be a whole number"),
        ({"policies": 3}, "policies=3: must be a text or a sequence"),
        ({"policies": {"avoid": 3}}, "policies={'avoid': 3}: must be a text or a sequence"),
        ({"shares": None}, "shares=None: must be a text"),
        ({"drives": (0.6, 0.7)}, "drives=(0.6, 0.7): must be a text"),
        ({"layout": 3}, "layout=3: "),
        ({"policies": b"avoid"}, "policy=97: "),
        ({"swarms": []}, "swarms=[]: unknown field; use n, policies, shares and drives"),
        ({"duration": "long"}, "duration='long': must be a number"),
        ({"self": 3}, "self=3: unknown field; "),
        ({"robots": 3}, "robots=3: unknown field; allowed: layout, stations, "),
    ],
)
def test_errors_name_field_value_and_rule(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError) as refusal:
        ForagingModel(**arguments)
    assert str(refusal.value).startswith(message)
    assert "\n" not in str(refusal.value)
