"""Short constructors of swarms, learners and curves for the catalogue."""

from collections.abc import Mapping
from typing import Any

from kswarms.agents.common.descriptions import FrozenModel
from kswarms.agents.learning.rewards import REWARDS
from kswarms.agents.learning.selection_rules import RULES
from kswarms.scenarios.description.condition import Condition, SwarmRule
from kswarms.scenarios.description.scenario import LEARNING


def swarm(policy: str, **rule: Any) -> SwarmRule:
    """Return a swarm with the default drives."""
    return SwarmRule(policy=policy, **rule)


def fast(policy: str, **rule: Any) -> SwarmRule:
    """Return a swarm with the advantage of sections 7.2 and 7.3: a drive of 70 % in state P."""
    return SwarmRule(policy=policy, drive=0.7, **rule)


def learner(policy: str = "inter-learner", reward: str = "wlu", rule: str = "ucb", **rest: Any) -> SwarmRule:
    """Return a swarm of learners; `rest` are further fields of the swarm."""
    return swarm(_call(policy, {"reward": "wlu", "rule": "ucb"}, {"reward": reward, "rule": rule}), **rest)


def reward_of(name: str = "wlu", **arguments: Any) -> str:
    """Return the text of a reward without default arguments."""
    return _call(name, _defaults(REWARDS[name]), arguments)


def rule_of(name: str, **arguments: Any) -> str:
    """Return the text of a selection rule without default arguments."""
    return _call(name, _defaults(RULES[name]), arguments)


def curve(*swarms: SwarmRule, **world: Any) -> tuple[Condition, ...]:
    """Return the only curve of a scenario."""
    return curves({"": swarms}, **world)


def curves(swarms: Mapping[str, tuple[SwarmRule, ...]], **world: Any) -> tuple[Condition, ...]:
    """Return a condition for each name, with a learning phase if a swarm learns."""
    conditions = []
    for name, rules in swarms.items():
        learning = LEARNING if any("learner" in rule.policy for rule in rules) else 0.0
        conditions.append(Condition(name=name, swarms=rules, learning=learning, **world))
    return tuple(conditions)


def _call(name: str, defaults: Mapping[str, Any], arguments: Mapping[str, Any]) -> str:
    """Return the text of a call. It omits default arguments, so that equal games have equal texts."""
    given = []
    for key, value in arguments.items():
        default = defaults[key]
        if isinstance(value, dict):  # values by swarm-ID of the opponent
            value = {opponent: own for opponent, own in value.items() if own != default} or default
        if value != default:
            given.append(f"{key}={value!r}")
    return f"{name}({', '.join(given)})" if given else name


def _defaults(kind: type[FrozenModel]) -> dict[str, Any]:
    return {name: field.default for name, field in kind.model_fields.items()}
