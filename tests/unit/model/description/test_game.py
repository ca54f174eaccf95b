"""Games as data: defaults, derived values, validation."""

import json
import math
import pickle
from functools import partial
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kswarms.agents.actions import TOWARDS, Action
from kswarms.agents.body import BODIES, KREMBOT, Body
from kswarms.agents.common.errors import InputError, shorten
from kswarms.agents.policies.interface import Setting
from kswarms.model.description.fields import LAYOUTS
from kswarms.model.description.game import Game, Swarm, apportion
from kswarms.model.description.presets import PRESETS
from kswarms.model.game_model import GameModel

AVOID = Swarm(policy="avoid", size=10)
FITTED = PRESETS["fitted"]
LARGE = {"radius": 0.1, "sensor_range": 0.5, "top_speed": 0.3}
DASH = Action(name="dash", direction=-1, duration=0.05)
RAM = Action(name="ram", direction=1, duration=2.0)


def game(**fields: Any) -> Game:
    return Game(**{"swarms": (AVOID, AVOID), **fields})


def swarm(**fields: Any) -> dict[str, Any]:
    """Return the argument `swarms` of a game of one swarm."""
    return {"swarms": ({"policy": "avoid", "size": 2, **fields},)}


def test_the_defaults_are_those_of_the_experiments() -> None:
    plain = game()
    assert (AVOID.drive, AVOID.drive_action) == (0.6, 0.6)
    assert (plain.layout, plain.side, plain.duration) == ("symmetric", 2.0, 600.0)
    assert (plain.puck_limit, plain.supply, plain.parameters) == (None, None, FITTED)
    assert [action.name for action in plain.action_set] == ["flight", "fight"]
    assert plain.size == 20
    assert plain.body == BODIES["krembot-sim"]


def test_a_game_is_a_value() -> None:
    assert game() == game()
    assert hash(game()) == hash(game())
    assert pickle.loads(pickle.dumps(game(supply=3))) == game(supply=3) != game()


class Fearless:
    def __init__(self, setting: Setting, nerve: float = 1.0) -> None:
        self.fight = setting.first(TOWARDS)

    def choose(self, opponent: int) -> Action:
        return self.fight


def test_policies_are_texts_classes_callables_or_lists() -> None:
    def local(setting: Setting) -> Fearless:
        return Fearless(setting)

    assert Swarm(policy=["avoid", "mixed"], size=3) == Swarm(policy="avoid+avoid+aggressive", size=3)
    importable = Swarm(policy=[partial(Fearless, nerve=0.5), "avoid"], size=2)
    assert importable.policy == f"{__name__}:Fearless(nerve=0.5)+avoid"
    model = GameModel(game(swarms=[{"policy": local, "size": 2}, importable], duration=1.0))
    model.play()
    names = [robot.policy_name for robot in model.robots]
    assert names[0] == names[1] == model.results()[0]["policy"]
    assert names[0].endswith("<locals>.local")
    assert names[2:] == importable.policy.split("+")
    assert all(isinstance(robot.policy, Fearless) for robot in model.members[0])
    with pytest.raises(InputError, match=r"^policy=3: must be a text, a class"):
        Swarm(policy=3, size=1)


def test_user_defined_actions_replace_the_standard_ones() -> None:
    assert game(actions=(DASH, RAM)).action_set == (DASH, RAM)
    assert game(actions=(DASH,), **swarm(policy="dash")).action_set == (DASH,)


@pytest.mark.parametrize("name", ["attack", "learner", "mixed"])
def test_no_action_has_the_name_of_a_policy(name: str) -> None:
    with pytest.raises(InputError, match=f"^actions='{name}': must not have the name of a policy$"):
        game(actions=(DASH, RAM.replace(name=name)))


@pytest.mark.parametrize("layout", LAYOUTS)
def test_every_layout_has_an_arena(layout: str) -> None:
    arena = game(layout=layout).arena(3)
    assert arena.bases.shape == arena.stations.shape == (2, 2)


def test_places_replace_those_of_the_layout() -> None:
    arena = game(stations=[(0.0, 0.0)], side=4.0).arena(0)
    assert arena.stations.tolist() == [[0.0, 0.0]]
    assert arena.bases.tolist() == [[-1.6, 0.0], [1.6, 0.0]]
    bases = [[0.0, 0.5], [0.0, -0.5]]
    arena = game(bases=bases, layout="random-stations").arena(0)
    assert arena.bases.tolist() == bases
    assert arena.stations.shape == (2, 2)


def test_presets_and_limits_have_short_forms() -> None:
    assert game(body="krembot", parameters="argos, friction=0.1, period=0.05") == game(
        body=KREMBOT, parameters=PRESETS["argos"].replace(friction=0.1, period=0.05)
    )
    assert game(body=LARGE).body == Body(**LARGE)
    assert game(puck_limit=0, supply=0) == game()


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"swarms": ()}, "swarms=(): "),
        (swarm(size=0), "swarms.0.size=0: must be greater than or equal to 1"),
        (swarm(size=10**400), f"swarms.0.size={shorten(10**400)}: must be less than or equal to 1000000"),
        (swarm(size=-3), "swarms.0.size=-3: "),
        (swarm(size=2.5), "swarms.0.size=2.5: must be a valid integer"),
        (swarm(drive=0), "swarms.0.drive=0: must be greater than or equal to 0.001"),
        (swarm(drive=1.1), "swarms.0.drive=1.1: must be less than"),
        (swarm(drive=math.nan), "swarms.0.drive=nan: "),
        (swarm(drive_action=-1), "swarms.0.drive_action=-1: "),
        ({"swarms": (AVOID, {"policy": "flee", "size": 2})}, "policy='flee': must be one of avoid, attack"),
        ({"swarms": ({"size": 2},)}, "swarms.0.policy=None: is required"),
        ({"layout": "round"}, "layout='round': must be 'symmetric', 'nearer-station' or 'random-stations'"),
        ({"body": "epuck"}, "body='epuck': must be one of krembot-sim, krembot, "),
        ({"absent": (20,)}, "absent=20: must be a robot of the game, 0 to 19"),
        ({"absent": (3, -1)}, "absent=-1: must be a robot of the game, 0 to 19"),
        ({"absent": (3, 4, 3)}, "absent=(3, 3, 4): must name each robot once"),
        ({"absent": (0,), **swarm(size=1)}, "absent=(0,): must leave a robot"),
        ({"absent": (1.5,)}, "absent.0=1.5: must be a valid integer"),
        ({"absent": (1,), "absent_from": "dinner"}, "absent_from='dinner': must be 'learning' or 'game'"),
        ({"side": 0}, "side=0: must be greater than or equal to 0.0001"),
        ({"side": -2.0}, "side=-2.0: "),
        ({"side": math.nan}, "side=nan: "),
        ({"duration": 0}, "duration=0: "),
        ({"duration": -600}, "duration=-600: "),
        ({"duration": math.nan}, "duration=nan: "),
        ({"duration": math.inf}, "duration=inf: "),
        ({"puck_limit": -1}, "puck_limit=-1: must be greater than or equal to 1"),
        ({"supply": 2.5}, "supply=2.5: "),
        ({"parameters": {"friction": -1}}, "parameters.friction=-1: "),
        ({"speed": 1}, "speed=1: unknown field; allowed: layout, stations, "),
        ({"body": {"radius": 0.1}}, "body.sensor_range=None: is required"),
        ({"body": {**LARGE, "radius": 0}}, "body.radius=0: must be greater than or equal to 0.001"),
        ({"stations": [(0.0, 0.9)]}, "station 1=[0.0, 0.9]: with radius 0.16 m must lie inside the walls"),
        ({"stations": [(0.8, 0.1)]}, "station 1=[0.8, 0.1]: with radius 0.16 m must not overlap base 2"),
        ({"stations": [(0.0, 0.0)] * 2}, "station 2=[0.0, 0.0]: with radius 0.16 m must not overlap stati"),
        ({"stations": [0.0]}, "stations.0=0.0: must be a valid tuple"),
        ({"stations": [(0.0, math.nan)]}, "stations.0.1=nan: must be a finite number"),
        ({"stations": [(0.0, 0.0)], "layout": "random-stations"}, "stations=((0.0, 0.0),): must not be giv"),
        ({"bases": [(0.5, 0.0)]}, "bases=((0.5, 0.0),): must be 2 places, one per swarm"),
        ({"bases": [(0.5, 0.0), (0.6, 0.0)]}, "base 2=[0.6, 0.0]: with radius 0.17 m must not overlap base"),
        ({"actions": (RAM, RAM)}, "actions=['ram', 'ram']: must have different names"),
        ({"parameters": {"base_radius": 0.21}}, "base 1="),
        (
            {**swarm(size=12), "body": "krembot", "side": 0.2401, "parameters": "fitted, clearance=0"},
            "n=12: robots of radius 0.0325 m do not fit",
        ),
        (swarm(size=200), "n=200: robots of radius 0.085 m do not fit"),
        ({"side": 0.8, "parameters": "fitted, station_radius=0.05, base_radius=0.05"}, "n=20: robots of ra"),
        ({"parameters": {"wall_clearance": 1}}, "n=20: robots of radius 0.085 m do not fit in"),
        ({"parameters": {"wall_clearance": 9000}}, "n=20: robots of radius 0.085 m do not fit in"),
        ({"parameters": {"wall_distance": 1.5}}, "wall_distance=1.5: must be less than half the arena"),
        ({"sample_period": 0}, "sample_period=0: must be greater than or equal to 0.000001"),
        ({"sample_period": math.nan}, "sample_period=nan: "),
        ({"sample_period": 1e308}, "sample_period=1e+308: must be less than or equal to 1000000000"),
        ({"sample_period": "often"}, "sample_period='often': "),
        ({"parameters": {"period": 0.5}}, "period=0.5: must be so short"),
        ({"side": 1e7}, "side=10000000.0: must be less than or equal to 10000"),
        *[
            ({name: value}, f"{name}={value!r}: must be a number")
            for name in ("side", "puck_limit", "learning", "sample_period", "duration")
            for value in (True, np.False_, "1", b"1")
        ],
        ({"absent": (0, True)}, "absent.1=True: must be a number"),
        ({"stations": [(0.0, 0.0), (np.True_, 0.5)]}, "stations.1.0=np.True_: must be a number"),
        ({"bases": [("0.5", 0.0)]}, "bases.0.0='0.5': must be a number"),
        (swarm(size="2"), "swarms.0.size='2': must be a number"),
        (swarm(drive_action=True), "swarms.0.drive_action=True: must be a number"),
        (
            {"actions": ({"name": "x", "direction": True, "duration": 1},)},
            "actions.0.direction=True: must be a nu",
        ),
        ({"body": {**LARGE, "top_speed": "1"}}, "body.top_speed='1': must be a number"),
        ({"body": {**LARGE, "name": " \t"}}, "body.name=' \\t': must be one line"),
        ({"parameters": {"push_share": False}}, "parameters.push_share=False: must be a number"),
        ({"side": 10**400}, "side="),
        (swarm(drive=1e-300), "swarms.0.drive=1e-300: must be greater than or equal to 0.001"),
        (
            {"body": {**LARGE, "top_speed": 1e-300}},
            "body.top_speed=1e-300: must be greater than or equal to 0.001",
        ),
        ({"parameters": "fitted, period=1e-6", **swarm(drive=0.001)}, "drive=0.001: must be so high that"),
        ({"parameters": {"station_radius": 0.001}}, "station_radius=0.001: must be at least 0.0075 m"),
        ({"parameters": {"base_radius": 0.007}}, "base_radius=0.007: must be at least 0.0075 m"),
        ({"duration": 0.05}, "duration=0.05: must be at least one control period, 0.1 s"),
        ({"learning": 1e-9}, "learning=1e-09: must be at least one control period, 0.1 s"),
        ({"actions": (DASH.replace(duration=1e-6), RAM) * 51}, "actions=("),
        ({"duration": 1e300}, "duration=1e+300: must be less than or equal to 1000000000"),
        ({"learning": 1e300}, "learning=1e+300: must be less than or equal to 1000000000"),
        ({"supply": 2**63}, "supply=9223372036854775808: must be less than or equal to 1000000000"),
        ({"layout": "nearer-station", "swarms": (AVOID,) * 3}, "layout='nearer-station': must have"),
        ({"layout": "random-stations", "parameters": {"station_radius": 0.6}}, "station_radius=0.6: "),
        ({"body": "krembot", "parameters": {"period": 0.2}}, "period=0.2: must be so short"),
        ({"parameters": {"period": 0.35}, **swarm(drive=0.1, drive_action=0.9)}, "period=0.35: must be so"),
    ],
)
def test_errors_name_field_value_and_rule(fields: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError) as refusal:
        game(**fields)
    assert str(refusal.value).startswith(message)
    assert "\n" not in str(refusal.value)


def test_equal_numbers_have_equal_texts() -> None:
    signed = game(learning=-0.0, stations=[(-0.0, np.float32(-0.0))], parameters="fitted, friction=-0.0")
    plain = game(learning=0, stations=[(0, 0)], parameters={"friction": 0})
    assert signed == plain
    assert signed.model_dump_json() == plain.model_dump_json()
    sizes = (np.int64(3), 3.0, 3)
    assert len({swarm.model_dump_json() for swarm in (Swarm(policy="avoid", size=n) for n in sizes)}) == 1


def test_a_robot_may_cover_eight_tenths_of_its_radius_in_a_period() -> None:
    fast = swarm(drive=0.68, drive_action=0.68)
    assert game(**fast, parameters=FITTED.replace(period=0.40)).size == 2
    with pytest.raises(InputError, match=r"^period=0.41: must be so short"):
        game(**fast, parameters=FITTED.replace(period=0.41))


@pytest.mark.parametrize("body", ["krembot-sim", "krembot"])
@pytest.mark.parametrize("drive", [0.6, 0.7])
def test_the_drives_of_the_experiments_suit_both_bodies(body: str, drive: float) -> None:
    assert game(body=body, **swarm(drive=drive)).size == 2


@pytest.mark.parametrize(
    ("n", "shares", "sizes"),
    [
        (11, [1, 1], [6, 5]),
        (13, [7, 6], [7, 6]),
        (6, [1, 2, 1], [2, 3, 1]),
        (11, [1, 1, 1], [4, 4, 3]),
        (5, [1, 100], [0, 5]),
    ],
)
def test_apportioning(n: int, shares: list[int], sizes: list[int]) -> None:
    assert apportion(n, shares) == sizes


@given(st.integers(0, 500), st.lists(st.integers(1, 20), min_size=1, max_size=6))
def test_apportioned_sizes_are_the_proportions_rounded(n: int, shares: list[int]) -> None:
    sizes = apportion(n, shares)
    assert sum(sizes) == n
    for size, share in zip(sizes, shares, strict=True):
        assert abs(size - n * share / sum(shares)) < 1
    for k, share in enumerate(shares):
        for other, its_share in enumerate(shares):
            if share > its_share or (share == its_share and k < other):
                assert sizes[k] >= sizes[other]


# Absent robots.


def test_absent_robots_may_be_given_in_any_order() -> None:
    assert game(absent=(7, 3)) == game(absent=[3, 7])
    assert game(absent=(3, 7)).absent == (3, 7)
    assert game(absent=(3, 7)).size == 20


def test_absent_from_has_no_effect_without_absent_robots() -> None:
    assert game(absent_from="game") == game()


@pytest.mark.parametrize("absent_from", ["learning", "game"])
def test_a_game_with_absent_robots_can_be_made_from_its_description(absent_from: str) -> None:
    some = game(absent=(3, 19), absent_from=absent_from)
    assert Game(**json.loads(some.model_dump_json())) == some
    assert Game(**some.model_dump()) == some
