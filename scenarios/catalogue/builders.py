"""The words in which the catalogue is written: swarms, learners, curves; so a scenario reads as data."""

from collections.abc import Mapping
from typing import Any, Final

from kswarms.agents.common.descriptions import Checked
from kswarms.agents.learning.rewards import REWARDS
from kswarms.agents.learning.selection_rules import RULES
from kswarms.scenarios.description.condition import Condition, SwarmRule
from kswarms.scenarios.description.scenario import LEARNING

_LEARNS_BY: Final = {"reward": "wlu", "rule": "ucb"}


def swarm(policy: str, **rule: Any) -> SwarmRule:
    """Return a swarm that drives as the others do."""
    return SwarmRule(policy=policy, **rule)


def fast(policy: str, **rule: Any) -> SwarmRule:
    """Return a swarm with the advantage of sections 7.2 and 7.3: it drives at 70 % in state P alone."""
    return SwarmRule(policy=policy, drive=0.7, drive_action=0.6, **rule)


def learner(about: str = "inter-learner", reward: str = "wlu", rule: str = "ucb", **rest: Any) -> SwarmRule:
    """Return a swarm that learns.

    Parameters
    ----------
    about : {'inter-learner', 'intra-learner', 'learner'}
        Policy: about other swarms, the own, or both.
    reward, rule : str
        As `reward_of` and `rule_of` write them.
    **rest
        Other fields of the swarm.
    """
    return swarm(_call(about, _LEARNS_BY, {"reward": reward, "rule": rule}), **rest)


def reward_of(name: str = "wlu", **arguments: Any) -> str:
    """Return a reward with those of its arguments that are not its defaults."""
    return _call(name, _defaults(REWARDS[name]), arguments)


def rule_of(name: str, **arguments: Any) -> str:
    """Return a selection rule with those of its arguments that are not its defaults."""
    return _call(name, _defaults(RULES[name]), arguments)


def curve(*swarms: SwarmRule, **world: Any) -> tuple[Condition, ...]:
    """Return the one curve of a scenario that has no other."""
    return curves({"": swarms}, **world)


def curves(swarms: Mapping[str, tuple[SwarmRule, ...]], **world: Any) -> tuple[Condition, ...]:
    """Return a condition for each name, with these swarms; whoever learns is given the time to."""
    return tuple(
        Condition(
            name=name,
            swarms=rules,
            learning=LEARNING if any("learner" in rule.policy for rule in rules) else 0.0,
            **world,
        )
        for name, rules in swarms.items()
    )


def _call(name: str, defaults: Mapping[str, Any], arguments: Mapping[str, Any]) -> str:
    """Write a call without what is default anyway, so that the same game has the same text and digest."""
    given = []
    for key, value in arguments.items():
        default = defaults[key]
        if isinstance(value, dict):  # of an opponent's swarm-ID
            value = {opponent: own for opponent, own in value.items() if own != default} or default
        if value != default:
            given.append(f"{key}={value!r}")
    return f"{name}({', '.join(given)})" if given else name


def _defaults(kind: type[Checked]) -> dict[str, Any]:
    return {name: field.default for name, field in kind.model_fields.items()}
