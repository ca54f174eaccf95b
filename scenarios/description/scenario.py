"""Scenarios as data: which swarms meet in which world, at which densities (specification, chapter 3).

A scenario belongs to one figure or table of the source; each of its conditions is one curve. Both
are frozen and checked when they are made, so that a scenario that exists can be played.
"""

import math
from collections.abc import Iterable
from typing import Any, Final, Self

from pydantic import Field, model_validator

from kswarms.agents.actions import Action
from kswarms.agents.common.descriptions import Checked
from kswarms.agents.common.errors import InputError
from kswarms.model.description.game import Game, Swarm, apportion
from kswarms.model.description.parameters import parse_parameters

DENSITIES: Final = (6, 10, 16, 20, 26, 30, 36, 40, 46, 50)
"""Robots in all, unless a scenario says otherwise (section 3.1)."""

SEEDS: Final = 20
"""Games for each density, unless a scenario says otherwise (section 3.1)."""

LEARNING: Final = 3000.0
"""Time for which a learner learns before the game that is measured (s, section 3.1)."""

MOST_SEEDS: Final = 1_000_000
"""Games for a density at most."""
LONGEST_NAME: Final = 100
LONGEST_TITLE: Final = 200
"""Letters of a name, which files are called by, and of a title."""
_ONE_LINE: Final = r"^[^\x00-\x1f\x7f]*$"


class SwarmRule(Checked):
    """One swarm of a condition, whatever the number of robots.

    Attributes
    ----------
    policy : str
        A policy with its arguments, as ``inter-learner(rule='greedy')``, the name of an action, or several
        of these joined by ``+``.
    share : int
        The swarm's part of all robots, in proportion to the other swarms' shares.
    drive, drive_action : float
        Share of the top speed in state P and in state A.
    """

    policy: str = Field(min_length=1)
    share: int = Field(default=1, ge=1)
    drive: float = 0.6
    drive_action: float = 0.6


class Condition(Checked):
    """One curve of a scenario: everything about a game but its seed and its number of robots.

    Attributes
    ----------
    name : str
        Name of the curve, empty if the scenario has no other.
    swarms : tuple of SwarmRule
        S1 to SK.
    layout, body : str
        Names of the arena's layout and of the robots' body.
    parameters : str
        Name of a preset and what differs from it, as ``"fitted, period=0.05"``.
    actions : tuple of Action
        What robots can do; empty for flight and fight as the parameters have them.
    learning : float
        Time for which learners learn before the game (s); with 0 they learn in the game itself.
    duration : float
        Length of the game (s), the limit if it is played for pucks.
    puck_limit, supply : int, optional
        Pucks that end the game; pucks of each station. None: no limit.
    multiple_of : int, optional
        What the number of robots must be a multiple of. None: of the sum of the shares in lowest
        terms, so that the proportions hold exactly.
    """

    name: str = Field(default="", max_length=LONGEST_NAME, pattern=_ONE_LINE)
    swarms: tuple[SwarmRule, ...] = Field(min_length=1)
    layout: str = "symmetric"
    body: str = "krembot-sim"
    parameters: str = "fitted"
    actions: tuple[Action, ...] = ()
    learning: float = 0.0
    duration: float = 600.0
    puck_limit: int | None = None
    supply: int | None = None
    multiple_of: int | None = Field(default=None, ge=1)

    def sizes(self, n: int) -> list[int]:
        """Return how many of `n` robots each swarm has.

        Raises
        ------
        InputError
            If `n` does not suit the proportions, or leaves a swarm empty.
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
            If there is no such game.
        """
        swarms = tuple(
            Swarm(policy=rule.policy, size=size, drive=rule.drive, drive_action=rule.drive_action)
            for rule, size in zip(self.swarms, self.sizes(n), strict=True)
        )
        return Game(
            swarms=swarms,
            layout=self.layout,
            parameters=parse_parameters(self.parameters),
            body=self.body,
            actions=self.actions,
            learning=self.learning,
            duration=self.duration,
            puck_limit=self.puck_limit,
            supply=self.supply,
        )


class Scenario(Checked):
    """An experiment: its curves, the numbers of robots and the seeds they are played with.

    Attributes
    ----------
    id : str
        Name of the source's figure, as ``fig-6.1a``.
    title : str
        What meets what, in a line.
    conditions : tuple of Condition
        The curves, under names that differ.
    densities : tuple of int
        Numbers of robots in all.
    seeds : int
        Games for each density.
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
            raise InputError("conditions", names, "must have names that differ")
        for condition in self.conditions:
            for n in self.densities:
                condition.sizes(n)
            condition.game(max(self.densities))  # fewer robots fit where more do
        return self

    def game(self, condition: str, n: int) -> Game:
        """Return the game that `n` robots play under a condition.

        Raises
        ------
        InputError
            If there is no condition of that name, or `n` does not suit its proportions.
        """
        by_name = {each.name: each for each in self.conditions}
        if condition not in by_name:
            raise InputError("condition", condition, f"must be one of {', '.join(map(repr, by_name))}")
        return by_name[condition].game(n)

    def allows(self, n: int) -> bool:
        """Tell whether `n` robots can play under every condition."""
        try:
            for condition in self.conditions:
                condition.game(n)
        except InputError:
            return False
        return True

    def to_toml(self) -> str:
        """Return the scenario as TOML, from which ``Scenario(**tomllib.loads(text))`` makes it again."""
        return _toml(self._plain())

    def _plain(self) -> dict[str, Any]:
        return self.model_dump(mode="json", exclude_none=True)


def toml_of(scenarios: Iterable[Scenario]) -> str:
    """Return several scenarios as one TOML document, each an element of its array ``scenarios``."""
    return _toml({"scenarios": [scenario._plain() for scenario in scenarios]})


def _toml(content: dict[str, Any]) -> str:
    import tomlkit  # here: nothing but `kswarms show` needs it

    return tomlkit.dumps(content)
