"""Grids: a condition is expanded to a condition for each combination of values of some fields."""

from collections.abc import Iterable, Mapping
from itertools import product
from math import prod
from typing import Any, Final

from kswarms.agents.common.errors import InputError
from kswarms.agents.common.limits import MAX_POINTS
from kswarms.agents.policies.editing import with_learning
from kswarms.agents.policies.spec import parse_policies
from kswarms.model.description.fields import GameFields
from kswarms.model.description.parameters import Parameters
from kswarms.scenarios.description.condition import Condition, SwarmRule, Value

Grid = Mapping[str, tuple[Value, ...]]
"""Values of each field."""

_FIELDS: Final = (*(name for name in GameFields.model_fields if name != "parameters"), "multiple_of")
_LEARNING: Final = ("reward", "rule")


def expand_grid(conditions: Iterable[Condition], grid: Grid) -> tuple[Condition, ...]:
    """Return each condition at each point of the grid. Conditions that are already at a point are kept.

    A field belongs to a condition, such as ``side`` or ``parameters.friction``; to all learners: ``reward``,
    ``rule``, ``reward.delta`` or ``rule.gamma``; or to a swarm, such as ``S1.drive``, ``S2.policy`` or
    ``S2.reward.delta``.
    """
    conditions = tuple(conditions)
    for field, values in grid.items():
        if len(set(map(repr, values))) < len(values) or not values:
            raise InputError(f"grid.{field}", list(values), "must be a list of different values")
    size = len(conditions) * prod(map(len, grid.values()))
    if size > MAX_POINTS and not any(condition.grid_point for condition in conditions):
        raise InputError("grid", size, f"must have at most {MAX_POINTS} points, over all conditions")
    expanded: list[Condition] = []
    for condition in conditions:
        for field, value in condition.grid_point:
            if value not in grid.get(field, ()):
                raise InputError(f"conditions.grid_point.{field}", value, "must be in the grid")
        points = [()] if condition.grid_point else product(*(product([name], grid[name]) for name in grid))
        expanded += (_at_point(condition, point) for point in points)
    return tuple(expanded)


def collapse_grid(conditions: tuple[Condition, ...], grid: Grid) -> tuple[Condition, ...]:
    """Reverse `expand_grid`; return `conditions` unchanged if that is impossible."""
    first = tuple((field, values[0]) for field, values in grid.items())
    bases = tuple(
        condition.replace(name=condition.name.removesuffix(_label(first)).removesuffix(", "), grid_point=())
        for condition in conditions
        if condition.grid_point == first
    )
    return bases if expand_grid(bases, grid) == conditions else conditions


def _label(point: tuple[tuple[str, Value], ...]) -> str:
    return ", ".join(f"{field}={value}" for field, value in point)


def _at_point(condition: Condition, point: tuple[tuple[str, Value], ...]) -> Condition:
    if not point:
        return condition
    name = ", ".join(filter(None, (condition.name, _label(point))))
    for field, value in point:
        try:
            condition = _with_field(condition, field, value)
        except InputError as error:
            raise InputError(f"grid.{field}", value, error.allowed) from None
    return condition.replace(name=name, grid_point=point)


def _with_field(condition: Condition, field: str, value: Value) -> Condition:
    first, _, rest = field.partition(".")
    numbers = {f"S{k + 1}": k for k in range(len(condition.swarms))}
    if first == "parameters" and rest in Parameters.model_fields:
        return condition.replace(parameters=condition.parameters.replace(**{rest: value}))
    if first == "parameters" and not rest:
        return condition.replace(parameters=value)
    if field in _FIELDS:
        return condition.replace(**{field: value})
    if first in _LEARNING:
        swarms = tuple(_set_learning(swarm, first, rest, value) for swarm in condition.swarms)
        if swarms == condition.swarms:
            _require_learner(condition.swarms, first)
        return condition.replace(swarms=swarms)
    if first in numbers:
        k = numbers[first]
        swarm = _with_swarm_field(condition.swarms[k], rest, value)
        return condition.replace(swarms=(*condition.swarms[:k], swarm, *condition.swarms[k + 1 :]))
    known = ", ".join([*_FIELDS, "parameters", "parameters.friction", *_LEARNING, "reward.delta", *numbers])
    raise InputError(field, value, f"unknown field; allowed: {known} and so on")


def _with_swarm_field(swarm: SwarmRule, field: str, value: Value) -> SwarmRule:
    part, _, argument = field.partition(".")
    if part in _LEARNING:
        _require_learner((swarm,), part)
        return _set_learning(swarm, part, argument, value)
    return swarm.replace(**{field: value})


def _require_learner(swarms: Iterable[SwarmRule], part: str) -> None:
    specs = (spec for swarm in swarms for spec in parse_policies(swarm.policy))
    if not any(spec.learner_part(part) for spec in specs):
        raise InputError(part, "", "needs a swarm of learners in every condition")


def _set_learning(swarm: SwarmRule, part: str, argument: str, value: Any) -> SwarmRule:
    """Set the reward or rule of the learners of a swarm, or one argument of it."""
    if argument:
        return swarm.replace(policy=with_learning(swarm.policy, part, **{argument: value}))
    return swarm.replace(policy=with_learning(swarm.policy, part, value))
