"""One curve of a scenario: a game without its seed and its number of robots."""

import math
from typing import Any

from pydantic import Field, field_validator

from kswarms.agents.body import BODIES
from kswarms.agents.common.descriptions import Line
from kswarms.agents.common.errors import InputError
from kswarms.agents.common.limits import LONGEST_NAME, MAX_ROBOTS, MAX_SWARMS
from kswarms.agents.policies.spec import parse_policies
from kswarms.model.description.fields import GameFields, SwarmFields
from kswarms.model.description.game import Game, Swarm, apportion
from kswarms.model.description.presets import text_of

Value = bool | int | float | str
"""Value of a field in a grid."""


class SwarmRule(SwarmFields):
    """One swarm of a condition.

    Attributes
    ----------
    policy : str, class, callable, or sequence of these
        As for a swarm of a game; a class or callable must be importable, so that it has a text.
    share : int
        Share of all robots, in proportion to the shares of the other swarms.
    """

    policy: str = Field(min_length=1)
    share: int = Field(default=1, ge=1, le=MAX_ROBOTS)

    @field_validator("policy", mode="before")
    @classmethod
    def _to_text(cls, policy: Any) -> Any:
        return policy if isinstance(policy, str) else "+".join(spec.text for spec in parse_policies(policy))


class Condition(GameFields):
    """One curve of a scenario: everything that a game has except its seed and its number of robots.

    Attributes
    ----------
    name : str
        Name of the curve; may be empty if it is the only one.
    swarms : tuple of SwarmRule
        S1 to SK.
    multiple_of : int, optional
        The number of robots must be a multiple of it. The default is the sum of the shares in lowest terms;
        the proportions then hold exactly.
    grid_point : tuple of (str, value)
        Fields that the grid of the scenario sets, with their values. The scenario fills it in.
    """

    name: Line = Field(default="", max_length=LONGEST_NAME)
    swarms: tuple[SwarmRule, ...] = Field(min_length=1, max_length=MAX_SWARMS)
    multiple_of: int | None = Field(default=None, ge=1, le=MAX_ROBOTS)
    grid_point: tuple[tuple[str, Value], ...] = ()

    @property
    def grid_values(self) -> dict[str, Value]:
        """Values that the grid of the scenario sets, by field; empty without a grid."""
        return dict(self.grid_point)

    def sizes(self, n: int) -> list[int]:
        """Return the size of each swarm; raise an `InputError` if the shares do not allow `n` robots."""
        shares = [swarm.share for swarm in self.swarms]
        step = self.multiple_of or sum(shares) // math.gcd(*shares)
        sizes = apportion(n, shares) if n > 0 else [0]
        if n % step or min(sizes) < 1:
            proportions = ":".join(map(str, shares))
            raise InputError("n", n, f"must be a multiple of {step} that gives each of {proportions} a robot")
        return sizes

    def game(self, n: int) -> Game:
        """Return the game of `n` robots."""
        swarms = tuple(
            Swarm(policy=rule.policy, size=size, drive=rule.drive, drive_action=rule.drive_action)
            for rule, size in zip(self.swarms, self.sizes(n), strict=True)
        )
        return Game(swarms=swarms, **self.game_fields())

    def non_defaults(self) -> dict[str, Any]:
        """Return the non-default values for TOML: presets by name, tables last."""
        values = self.model_dump(mode="json", exclude_defaults=True)
        if "parameters" in values:
            values["parameters"] = text_of(self.parameters)
        if BODIES.get(self.body.name) == self.body and "body" in values:
            values["body"] = self.body.name
        return dict(sorted(values.items(), key=lambda item: (_is_table(item[1]), item[0] != "name")))


def _is_table(value: object) -> bool:
    return isinstance(value, dict) or (isinstance(value, list) and isinstance(value[0], dict))
