"""Scenarios as data: swarms, world, densities and seeds of an experiment (specification, chapter 3).

A scenario belongs to one figure or table of the source; each of its conditions is one curve. Both are frozen
and validated on construction, so every scenario object can be played.
"""

from collections.abc import Iterable
from typing import Any, Final, Self

import tomlkit
from pydantic import Field, model_validator

from kswarms.agents.common.descriptions import FrozenModel, Line
from kswarms.agents.common.errors import InputError
from kswarms.agents.common.limits import LONGEST_NAME, LONGEST_TITLE, MAX_POINTS, MAX_SEEDS
from kswarms.model.description.game import Game
from kswarms.scenarios.description.condition import Condition, Value
from kswarms.scenarios.description.grid import collapse_grid, expand_grid

DENSITIES: Final = (6, 10, 16, 20, 26, 30, 36, 40, 46, 50)
"""Default numbers of robots (section 3.1)."""
SEEDS: Final = 20
"""Default number of games per density (section 3.1)."""
ID_PATTERN: Final = r"^[a-z0-9][a-z0-9.-]*$"
"""Pattern of the ids of scenarios, which also become names of files."""
LEARNING: Final = 3000.0
"""Duration of the learning phase of learners in the source (s, section 3.1)."""


class Scenario(FrozenModel):
    """An experiment: its curves, numbers of robots and seeds.

    Attributes
    ----------
    id : str
        Name, for example of a figure of the source: ``fig-6.1a``.
    title : str
        One line.
    conditions : tuple of Condition
        The curves; their names differ. With a grid, one for each point, with the values in its name.
    densities : tuple of int
        Numbers of robots.
    seeds : int
        Number of games per density.
    grid : dict of str to tuple
        Values of fields (see `kswarms.scenarios.description.grid.expand_grid`). Each condition is expanded to
        a condition for each combination of values, which `Condition.grid_values` returns.
    """

    id: str = Field(pattern=ID_PATTERN, max_length=LONGEST_NAME)
    title: Line = Field(min_length=1, max_length=LONGEST_TITLE)
    conditions: tuple[Condition, ...] = Field(min_length=1, max_length=MAX_POINTS)
    densities: tuple[int, ...] = Field(default=DENSITIES, min_length=1, max_length=MAX_POINTS)
    seeds: int = Field(default=SEEDS, ge=1, le=MAX_SEEDS)
    grid: dict[str, tuple[Value, ...]] = {}

    def __hash__(self) -> int:
        return hash((self.id, self.conditions, self.densities, self.seeds))

    @model_validator(mode="after")
    def _expand(self) -> Self:
        object.__setattr__(self, "conditions", expand_grid(self.conditions, self.grid))
        return self

    @model_validator(mode="after")
    def _validate(self) -> Self:
        names = [condition.name for condition in self.conditions]
        if len(set(names)) < len(names):
            raise InputError("conditions", names, "must have different names")
        for condition in self.conditions:
            for n in self.densities:
                condition.sizes(n)
            condition.game(max(self.densities))  # fewer robots need less room
        return self

    def game(self, condition: str, n: int) -> Game:
        """Return the game of `n` robots under the condition of this name."""
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
        return tomlkit.dumps(self._non_defaults())

    def _non_defaults(self) -> dict[str, Any]:
        values = self.model_dump(mode="json", exclude_defaults=True)
        values["conditions"] = [each.non_defaults() for each in collapse_grid(self.conditions, self.grid)]
        return dict(sorted(values.items(), key=lambda item: item[0] in ("grid", "conditions")))


def toml_of(scenarios: Iterable[Scenario]) -> str:
    """Return several scenarios as one TOML document with an array ``scenarios``."""
    return tomlkit.dumps({"scenarios": [scenario._non_defaults() for scenario in scenarios]})
