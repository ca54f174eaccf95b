"""Scenarios as data: swarms, world, densities and seeds of an experiment (specification, chapter 3).

A scenario belongs to one figure or table of the source; each of its conditions is one curve. Both are frozen
and validated on construction, so every scenario object can be played.
"""

import math
from collections.abc import Iterable
from typing import Any, Final, Self

import tomlkit
from pydantic import Field, model_validator

from kswarms.agents.common.descriptions import Checked
from kswarms.agents.common.errors import InputError
from kswarms.agents.robot.body import BODIES
from kswarms.model.description.fields import GameFields, SwarmFields
from kswarms.model.description.game import Game, Swarm, apportion
from kswarms.model.description.parameters import text_of

DENSITIES: Final = (6, 10, 16, 20, 26, 30, 36, 40, 46, 50)
"""Default numbers of robots (section 3.1)."""
SEEDS: Final = 20
"""Default number of games per density (section 3.1)."""
LEARNING: Final = 3000.0
"""Duration of the learning phase of learners in the source (s, section 3.1)."""
MOST_SEEDS: Final = 1_000_000
"""Maximum number of games per density."""
LONGEST_NAME: Final = 100
LONGEST_TITLE: Final = 200
"""Maximum number of characters of a name, which file names contain, and of a title."""
_ONE_LINE: Final = r"^[^\x00-\x1f\x7f]*$"


class SwarmRule(SwarmFields):
    """One swarm of a condition.

    Attributes
    ----------
    share : int
        Share of all robots, in proportion to the shares of the other swarms.
    """

    share: int = Field(default=1, ge=1)


class Condition(GameFields):
    """One curve of a scenario: everything that a game has except its seed and its number of robots.

    Attributes
    ----------
    name : str
        Name of the curve; may be empty if it is the only one.
    swarms : tuple of SwarmRule
        S1 to SK.
    multiple_of : int, optional
        The number of robots must be a multiple of it. The default is the sum of the shares in lowest terms,
        so that the proportions hold exactly.
    """

    name: str = Field(default="", max_length=LONGEST_NAME, pattern=_ONE_LINE)
    swarms: tuple[SwarmRule, ...] = Field(min_length=1)
    multiple_of: int | None = Field(default=None, ge=1)

    def sizes(self, n: int) -> list[int]:
        """Return the size of each swarm if there are `n` robots.

        Raises
        ------
        InputError
            If `n` does not suit the proportions or leaves a swarm empty.
        """
        shares = [swarm.share for swarm in self.swarms]
        step = self.multiple_of or sum(shares) // math.gcd(*shares)
        sizes = apportion(n, shares) if n > 0 else [0]
        if n % step or min(sizes) < 1:
            proportions = ":".join(map(str, shares))
            raise InputError("n", n, f"must be a multiple of {step} that gives each of {proportions} a robot")
        return sizes

    def game(self, n: int) -> Game:
        """Return the game of `n` robots.

        Raises
        ------
        InputError
            If the game is not allowed.
        """
        swarms = tuple(
            Swarm(policy=rule.policy, size=size, drive=rule.drive, drive_action=rule.drive_action)
            for rule, size in zip(self.swarms, self.sizes(n), strict=True)
        )
        return Game(swarms=swarms, **self.game_fields())


class Scenario(Checked):
    """An experiment: its curves, numbers of robots and seeds.

    Attributes
    ----------
    id : str
        Name, for example of a figure of the source: ``fig-6.1a``.
    title : str
        One line.
    conditions : tuple of Condition
        The curves; their names differ.
    densities : tuple of int
        Numbers of robots.
    seeds : int
        Number of games per density.
    """

    id: str = Field(pattern=r"^[a-z0-9][a-z0-9.-]*$", max_length=LONGEST_NAME)
    title: str = Field(min_length=1, max_length=LONGEST_TITLE, pattern=_ONE_LINE)
    conditions: tuple[Condition, ...] = Field(min_length=1)
    densities: tuple[int, ...] = Field(default=DENSITIES, min_length=1)
    seeds: int = Field(default=SEEDS, ge=1, le=MOST_SEEDS)

    @model_validator(mode="after")
    def _playable(self) -> Self:
        names = [condition.name for condition in self.conditions]
        if len(set(names)) < len(names):
            raise InputError("conditions", names, "must have different names")
        for condition in self.conditions:
            for n in self.densities:
                condition.sizes(n)
            condition.game(max(self.densities))  # fewer robots need less room
        return self

    def game(self, condition: str, n: int) -> Game:
        """Return the game of `n` robots under the condition of this name.

        Raises
        ------
        InputError
            If the condition does not exist, or `n` does not suit its proportions.
        """
        by_name = {each.name: each for each in self.conditions}
        if condition not in by_name:
            raise InputError("condition", condition, f"must be one of {', '.join(map(repr, by_name))}")
        return by_name[condition].game(n)

    def allows(self, n: int) -> bool:
        """Return whether `n` robots can play under every condition."""
        try:
            for condition in self.conditions:
                condition.game(n)
        except InputError:
            return False
        return True

    def to_toml(self) -> str:
        """Return the scenario as TOML, without default values."""
        return tomlkit.dumps(self._plain())

    def _plain(self) -> dict[str, Any]:
        plain = self.model_dump(mode="json", exclude_defaults=True)
        plain["conditions"] = [_plain_condition(condition) for condition in self.conditions]
        return plain


def toml_of(scenarios: Iterable[Scenario]) -> str:
    """Return several scenarios as one TOML document: its array ``scenarios``."""
    return tomlkit.dumps({"scenarios": [scenario._plain() for scenario in scenarios]})


def _plain_condition(condition: Condition) -> dict[str, Any]:
    """Return the values that differ from the defaults, with names of presets, in the order of TOML."""
    plain = condition.model_dump(mode="json", exclude_defaults=True)
    if "parameters" in plain:
        plain["parameters"] = text_of(condition.parameters)
    if BODIES.get(condition.body.name) == condition.body and "body" in plain:
        plain["body"] = condition.body.name
    return dict(sorted(plain.items(), key=lambda item: (_is_table(item[1]), item[0] != "name")))


def _is_table(value: object) -> bool:
    return isinstance(value, dict) or (isinstance(value, list) and isinstance(value[0], dict))
