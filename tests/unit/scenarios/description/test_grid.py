"""Grids: expansion to conditions at every combination of values, and validation."""

import tomllib
from typing import Any

import pytest

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.description.condition import Condition, SwarmRule
from kswarms.scenarios.description.scenario import Scenario

AVOID, LEARNER = SwarmRule(policy="avoid"), SwarmRule(policy="inter-learner(rule='greedy')")


def scenario(grid: dict[str, Any], *policies: str, **condition: Any) -> Scenario:
    swarms = tuple(SwarmRule(policy=policy) for policy in policies or ("avoid", "inter-learner"))
    conditions = (Condition(swarms=swarms, **condition),)
    return Scenario(id="own", title="Own", conditions=conditions, densities=(6,), grid=grid)


def test_every_condition_is_expanded_at_every_point() -> None:
    base = Condition(name="base", swarms=(AVOID, LEARNER), duration=60.0)
    other = base.replace(name="", swarms=(LEARNER, AVOID), parameters="argos")
    grid = {"side": [2, 3.5], "reward.delta": [0.02, 0.2]}
    own = Scenario(id="own", title="Own", conditions=(base, other), densities=(6,), grid=grid)
    conditions = own.conditions
    points = [{"side": side, "reward.delta": delta} for side in (2, 3.5) for delta in (0.02, 0.2)]
    names = [", ".join(f"{field}={value}" for field, value in point.items()) for point in points]
    assert [each.name for each in conditions] == [*(f"base, {name}" for name in names), *names]
    assert [each.grid_values for each in conditions] == points * 2
    assert [each.game(6).side for each in conditions] == [2.0, 2.0, 3.5, 3.5] * 2
    assert conditions[1].swarms[1].policy == "inter-learner(rule='greedy', reward='wlu(delta=0.2)')"
    assert conditions[1].swarms[0] == AVOID
    assert conditions[7].game(6).parameters.leg_mean == 3.0


@pytest.mark.parametrize(
    ("field", "value", "policies"),
    [
        ("S2.policy", "attack", ("avoid", "attack")),
        ("S1.reward.delta", 0.02, ("inter-learner(reward='wlu(delta=0.02)')", "inter-learner")),
        ("S2.rule", "greedy", ("inter-learner", "inter-learner(rule='greedy')")),
        ("reward", "individual", ("inter-learner(reward='individual')",) * 2),
        ("rule.gamma", 0.5, ("mixed", "avoid+learner(rule='ucb(gamma=0.5)')")),
    ],
)
def test_a_grid_sets_arguments_of_policies(field: str, value: str | float, policies: tuple[str, str]) -> None:
    before = {"S2.policy": ("avoid", "avoid"), "rule.gamma": ("mixed", "avoid+learner")}
    (condition,) = scenario({field: [value]}, *before.get(field, ("inter-learner",) * 2)).conditions
    assert tuple(swarm.policy for swarm in condition.swarms) == policies


def test_a_grid_sets_fields_of_games_and_swarms() -> None:
    grid = {
        "parameters": ["argos"],
        "parameters.friction": [0.3],
        "puck_limit": [0, 5],
        "S1.drive": [0.5],
        "S2.share": [2],
        "multiple_of": [6],
    }
    first, second = (condition.game(6) for condition in scenario(grid).conditions)
    assert (first.puck_limit, second.puck_limit) == (None, 5)
    assert (first.parameters.friction, first.parameters.leg_mean) == (0.3, 3.0)
    assert [(swarm.size, swarm.drive) for swarm in first.swarms] == [(2, 0.5), (4, 0.6)]


@pytest.mark.parametrize(
    ("grid", "message"),
    [
        ({"speed": [1]}, "grid.speed=1: unknown field; allowed: layout, "),
        ({"name": ["a"]}, "grid.name='a': unknown field"),
        ({"parameters.speed": [1]}, "grid.parameters.speed=1: unknown field"),
        ({"parameters.friction": [-1]}, "grid.parameters.friction=-1: must be greater than or equal to 0"),
        ({"S3.drive": [0.5]}, "grid.S3.drive=0.5: unknown field"),
        ({"S1.speed": [0.5]}, "grid.S1.speed=0.5: unknown field; allowed: policy, drive"),
        ({"S1.rule.gamma": [0.5]}, "grid.S1.rule.gamma=0.5: needs a swarm of learners"),
        ({"side": []}, "grid.side=[]: must be a list of different values"),
        ({"side": [2, 3, 2]}, "grid.side=[2, 3, 2]: must be a list of different values"),
        ({"side": [-2]}, "grid.side=-2: must be greater than or equal to 0.0001"),
        ({"side": 2}, "grid.side=2: must be a valid tuple"),
        ({"side": [{}]}, "grid.side.0"),
        ({"side": list(range(2, 43)), "duration": list(range(1, 41))}, "grid=1640: must have at most 1000"),
        ({"reward.delta": [2]}, "policy.reward.delta=2: must be less than or equal to 1"),
        ({"S2.policy": ["dance"]}, "policy='dance': must be one of"),
    ],
)
def test_an_invalid_grid_is_refused_in_one_line(grid: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError) as refusal:
        scenario(grid)
    assert str(refusal.value).startswith(message)
    assert "\n" not in str(refusal.value)


def test_names_of_conditions_must_differ_with_a_grid() -> None:
    twice = (Condition(swarms=(AVOID,)), Condition(swarms=(AVOID, AVOID)))
    with pytest.raises(InputError, match="must have different names"):
        Scenario(id="own", title="Own", conditions=twice, densities=(6,), grid={"side": [2, 3]})


def test_toml_holds_the_grid_instead_of_its_points() -> None:
    gridded = scenario({"side": [2, 3], "S2.policy": ["avoid", "learner"]}, name="a, side=2")
    read = tomllib.loads(gridded.to_toml())
    assert read["grid"] == {"side": [2, 3], "S2.policy": ["avoid", "learner"]}
    assert [each["name"] for each in read["conditions"]] == ["a, side=2"]
    assert Scenario(**read) == gridded
    assert hash(Scenario(**read)) == hash(gridded)


def test_a_scenario_with_a_grid_can_be_changed() -> None:
    gridded = scenario({"side": [2, 3]})
    assert gridded.replace(seeds=3).conditions == gridded.conditions
    part = gridded.replace(conditions=gridded.conditions[1:])
    assert len(part.conditions) == 1
    assert Scenario(**tomllib.loads(part.to_toml())) == part
    with pytest.raises(InputError, match=r"^conditions.grid_point.side=2: must be in the grid"):
        gridded.replace(grid={"side": [3, 4]})
