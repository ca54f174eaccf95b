"""Scenarios as data: proportions, games, validation, TOML."""

import math
import tomllib

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from kswarms.agents.actions import Action
from kswarms.agents.body import KREMBOT
from kswarms.agents.common.errors import InputError
from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.description.condition import Condition, SwarmRule
from kswarms.scenarios.description.scenario import Scenario

AVOID = SwarmRule(policy="avoid")


def with_shares(*shares: int, **rest: object) -> Condition:
    return Condition(swarms=tuple(SwarmRule(policy="avoid", share=share) for share in shares), **rest)


@pytest.mark.parametrize(
    ("condition", "n", "sizes"),
    [
        (with_shares(1, 1), 2, [1, 1]),
        (with_shares(1, 1), 50, [25, 25]),
        (with_shares(3, 3), 10, [5, 5]),
        (with_shares(7, 6), 13, [7, 6]),
        (with_shares(7, 6), 52, [28, 24]),
        (with_shares(1), 7, [7]),
        (with_shares(1, 1, 1), 9, [3, 3, 3]),
        (with_shares(1, 2, 1, multiple_of=2), 6, [2, 3, 1]),
        (with_shares(1, 2, 1, multiple_of=2), 8, [2, 4, 2]),
        (with_shares(1, 2, 1, multiple_of=2), 50, [13, 25, 12]),
    ],
)
def test_robots_are_divided_by_the_shares(condition: Condition, n: int, sizes: list[int]) -> None:
    assert condition.sizes(n) == sizes
    assert [swarm.size for swarm in condition.game(n).swarms] == sizes


@pytest.mark.parametrize(
    ("condition", "n"),
    [
        (with_shares(1, 1), 7),
        (with_shares(1, 1), 0),
        (with_shares(1, 1), -6),
        (with_shares(1), 0),
        (with_shares(7, 6), 12),
        (with_shares(7, 6), 14),
        (with_shares(1, 1, 1), 10),
        (with_shares(1, 2, 1, multiple_of=2), 7),
        (with_shares(1, 2, 1, multiple_of=2), 2),  # S3 would be empty
    ],
)
def test_a_number_that_does_not_suit_the_shares_is_refused(condition: Condition, n: int) -> None:
    with pytest.raises(InputError, match=rf"^n={n}: must be a multiple of \d+") as refusal:
        condition.game(n)
    assert (refusal.value.field, refusal.value.value) == ("n", n)


@given(st.lists(st.integers(1, 9), min_size=1, max_size=5), st.integers(1, 10))
def test_without_multiple_of_the_proportions_hold_exactly(shares: list[int], times: int) -> None:
    step = sum(shares) // math.gcd(*shares)
    sizes = with_shares(*shares).sizes(times * step)
    assert [size * sum(shares) for size in sizes] == [share * times * step for share in shares]


def test_a_game_has_all_fields_of_its_condition() -> None:
    flee = Action(name="flee", direction=-1, duration=0.5)
    places = ((0.0, 0.5), (0.0, -0.5), (0.0, 0.0))
    push = Action(name="push", direction=1, duration=2.0)
    game = Condition(
        swarms=(SwarmRule(policy="flee", drive=0.7, drive_action=0.5), SwarmRule(policy="attack")),
        side=2.5,
        stations=places,
        bases=((-0.9, 0.0), (0.9, 0.1)),
        sample_period=2.0,
        body="krembot",
        parameters="argos, period=0.05, friction=0.25, preempt=true, wall_escape=clear",
        actions=(flee, push),
        learning=900.0,
        duration=120.0,
        puck_limit=9,
        supply=30,
    ).game(8)
    first, second = game.swarms
    assert (first.policy, first.size, first.drive, first.drive_action) == ("flee", 4, 0.7, 0.5)
    assert (second.policy, second.size, second.drive, second.drive_action) == ("attack", 4, 0.6, 0.6)
    assert (game.side, game.sample_period) == (2.5, 2.0)
    assert (game.stations, game.bases) == (places, ((-0.9, 0.0), (0.9, 0.1)))
    assert (game.body, game.actions) == (KREMBOT, (flee, push))
    assert (game.learning, game.duration, game.puck_limit, game.supply) == (900.0, 120.0, 9, 30)
    changed = (game.parameters.friction, game.parameters.preempt, game.parameters.wall_escape)
    assert changed == (0.25, True, "clear")
    assert game.parameters.leg_mean == 3.0  # of the preset


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"id": "Fig 6.1"}, "id"),
        *[
            ({"title": title}, "title")
            for title in ("", " ", "\u00a0\u2003", "a\nb", "\x1b[1m", "\u202ea", "\u200b", "\udcff")
        ],
        *[({"seeds": seeds}, "seeds") for seeds in (True, "3", 10**400, -0.0)],
        *[({"densities": [6, n]}, "densities.1") for n in (True, "8")],
        ({"seeds": 0}, "seeds"),
        ({"densities": ()}, "densities"),
        ({"densities": (6, 7)}, "n"),
        ({"densities": (1000, 6)}, "n"),
        ({"densities": (6, 10**400)}, "n"),
        ({"densities": (6.5,)}, "densities.0"),
        ({"conditions": ()}, "conditions"),
        ({"conditions": (with_shares(1, 1), with_shares(1, 1))}, "conditions"),
        ({"colour": "red"}, "colour"),
    ],
)
def test_an_invalid_scenario_is_refused(changes: dict[str, object], field: str) -> None:
    good = {"id": "fig-0", "title": "A test", "conditions": (with_shares(1, 1),)}
    Scenario(**good)
    with pytest.raises(InputError) as refusal:
        Scenario(**(good | changes))
    assert refusal.value.field == field
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize(
    "world",
    [
        {"swarms": (SwarmRule(policy="dance"), AVOID)},
        {"swarms": ({"policy": "avoid", "drive": -0.6}, AVOID)},
        {"swarms": ({"policy": "avoid", "drive_action": 0.0}, AVOID)},
        {"body": "roomba"},
        {"parameters": "fitted, friction=-1"},
        {"duration": 0.0},
        {"learning": -1.0},
        {"learning": math.inf},
        {"puck_limit": -1},
        {"supply": -1},
        {"actions": (Action(name="push", direction=1, duration=1.0),)},  # avoid needs a flight
    ],
)
def test_a_condition_without_a_valid_game_is_refused(world: dict[str, object]) -> None:
    with pytest.raises(InputError):
        Scenario(id="fig-0", title="A test", conditions=(Condition(**({"swarms": (AVOID, AVOID)} | world)),))


@pytest.mark.parametrize(
    ("policy", "complaint"),
    [
        ("dance", "policy='dance': must be one of avoid, attack, aggressive, random, learner"),
        ("inter-learner(reward='gold')", "reward='gold': must be one of wlu, individual, single-swarm"),
        ("inter-learner(otherwise='hop')", "otherwise='hop': must be one of flight, fight"),
        ("learner(about='all')", "about='all': must be inter, intra or both"),
        ("inter-learner(rule='ucb(gamma=-1)')", "gamma=-1: must be greater than or equal to 0"),
        ("inter-learner(rule='discounted-ucb(discount=0)')", "discount=0: must be greater than 0"),
        ("inter-learner(rule='discounted-ucb(discount=2)')", "discount=2: must be less than or equal to 1"),
        ("inter-learner(reward='wlu(delta=1.5)')", "=1.5: must be less than or equal to 1"),
        ("inter-learner(reward='wlu(b=0)')", "=0: must be greater than 0"),
        ("inter-learner(reward='wlu(b=3)')", "=3: must be less than 3"),
        ("inter-learner(reward='wlu(beta=3)')", "beta=3: unknown field; allowed: delta, b"),
        ("inter-learner(reward='wlu(delta=0.1')", "must be name or name(key=value, …)"),
        ("avoid(speed=3)", "policy.speed=3: unknown field; allowed: none"),
    ],
)
def test_an_invalid_policy_is_refused_with_a_reason(policy: str, complaint: str) -> None:
    text = f"""
        id = "my-1"
        title = "Mine"
        densities = [6]
        [[conditions]]
        learning = 300.0
        swarms = [{{policy = "avoid"}}, {{policy = "{policy}"}}]
    """
    with pytest.raises(InputError) as refusal:
        Scenario(**tomllib.loads(text))
    assert complaint in str(refusal.value)
    assert "policy" in refusal.value.field
    assert "\n" not in str(refusal.value)


def test_a_swarm_needs_robots_and_a_condition_needs_swarms() -> None:
    with pytest.raises(InputError, match=r"^share=0"):
        SwarmRule(policy="avoid", share=0)
    with pytest.raises(InputError, match=r"^policy=''"):
        SwarmRule(policy="")
    assert SwarmRule(policy=["avoid", "attack"]) == SwarmRule(policy="avoid+attack")
    with pytest.raises(InputError, match=r"^policy='.*lambda>': cannot be imported"):
        SwarmRule(policy=lambda setting: None)
    with pytest.raises(InputError, match=r"^swarms="):
        Condition(swarms=())
    with pytest.raises(InputError, match=r"^multiple_of=0"):
        with_shares(1, 1, multiple_of=0)


def test_a_scenario_finds_its_games_by_the_name_of_the_curve() -> None:
    scenario = CATALOGUE["fig-6.15"]
    assert scenario.game("fight-1000ms", 6).swarms[0].policy == "fight-1000ms"
    with pytest.raises(InputError, match=r"^condition='': must be one of 'flight-50ms'"):
        scenario.game("", 6)


def test_a_scenario_allows_numbers_that_suit_all_its_conditions() -> None:
    assert [n for n in range(1, 40) if CATALOGUE["fig-7.12"].allows(n)] == [13, 26, 39]


def test_descriptions_cannot_be_changed() -> None:
    with pytest.raises(ValidationError):
        CATALOGUE["fig-6.1a"].seeds = 3
    assert CATALOGUE["fig-6.1a"].replace(seeds=3).seeds == 3
    assert CATALOGUE["fig-6.1a"].seeds == 20


def test_toml_holds_every_field_and_no_defaults() -> None:
    condition = with_shares(2, 1, side=3.0, parameters="argos, period=0.05", sample_period=1.0).replace(
        stations=[(0.0, 0.5)], body={"radius": 0.05, "sensor_range": 0.4, "top_speed": 0.2}
    )
    scenario = Scenario(id="own", title="Own", conditions=(condition,), densities=(6,))
    text = scenario.to_toml()
    assert Scenario(**tomllib.loads(text)) == scenario
    assert tomllib.loads(text)["conditions"] == [
        {
            "stations": [[0.0, 0.5]],
            "side": 3.0,
            "parameters": "argos, period=0.05",
            "sample_period": 1.0,
            "swarms": [{"policy": "avoid", "share": 2}, {"policy": "avoid"}],
            "body": {"radius": 0.05, "sensor_range": 0.4, "top_speed": 0.2},
        }
    ]
