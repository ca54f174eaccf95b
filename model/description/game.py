"""A game as data: everything that determines a simulation except the seed."""

import math
from collections.abc import Sequence
from typing import Literal, Self

from pydantic import Field, field_validator, model_validator

from kswarms.agents.actions import Action
from kswarms.agents.common.errors import InputError
from kswarms.agents.common.limits import LONGEST_STEP, MAX_ROBOTS, MAX_SWARMS, SHORTEST_STEP
from kswarms.agents.policies.interface import Setting
from kswarms.agents.policies.registry import ALIASES, POLICIES
from kswarms.agents.policies.spec import parse_policies
from kswarms.agents.streams import Streams
from kswarms.model.description.arena import Arena, build_arena
from kswarms.model.description.fields import GameFields, SwarmFields


class Swarm(SwarmFields):
    """One swarm of a game.

    Attributes
    ----------
    size : int
        Number of robots.
    """

    size: int = Field(ge=1, le=MAX_ROBOTS)


class Game(GameFields):
    """Description of one game.

    Attributes
    ----------
    swarms : tuple of Swarm
        The swarms, S1 first.
    absent : tuple of int
        Numbers of absent robots, ascending. The other robots keep their numbers, random streams, starting
        places and policies, so two games differ only by the effect of the absent robots.
    absent_from : {'learning', 'game'}
        Whether they are absent from the start, or learn and leave before the measured game.

    Raises
    ------
    InputError
        If a field is out of range or the fields do not fit together.
    """

    swarms: tuple[Swarm, ...] = Field(min_length=1, max_length=MAX_SWARMS)
    absent: tuple[int, ...] = ()
    absent_from: Literal["learning", "game"] = "learning"

    @field_validator("absent")
    @classmethod
    def _sort(cls, absent: tuple[int, ...]) -> tuple[int, ...]:
        return tuple(sorted(absent))

    @model_validator(mode="after")
    def _check(self) -> Self:
        self._check_places()
        self._check_policies()
        self._check_motion()
        self._check_absent()
        self._check_room()
        return self

    def _check_places(self) -> None:
        if self.layout == "nearer-station" and len(self.swarms) > 2:
            # The position of its upper station follows from the distances to two bases.
            raise InputError("layout", self.layout, f"must have at most 2 swarms, not {len(self.swarms)}")
        if self.layout != "symmetric" and self.stations:
            raise InputError("stations", self.stations, f"must not be given with the layout {self.layout}")
        if self.bases and len(self.bases) != len(self.swarms):
            raise InputError("bases", self.bases, f"must be {len(self.swarms)} places, one per swarm")

    def _check_policies(self) -> None:
        actions = self.action_set
        names = [action.name for action in actions]
        if len(set(names)) < len(names):
            raise InputError("actions", names, "must have different names")
        for name in names:
            if name in POLICIES or name in ALIASES:
                raise InputError("actions", name, "must not have the name of a policy")
        for k, swarm in enumerate(self.swarms):
            setting = Setting(k, len(self.swarms), actions, Streams(0, 0))
            for spec in parse_policies(swarm.policy):
                spec.check(setting)

    def _check_motion(self) -> None:
        parameters, body = self.parameters, self.body
        drives = [drive for swarm in self.swarms for drive in (swarm.drive, swarm.drive_action)]
        steps = [parameters.period * body.top_speed * drive for drive in (min(drives), max(drives))]
        if steps[1] > LONGEST_STEP * body.radius:
            rule = f"must be so short that a robot moves at most {LONGEST_STEP} of its radius in a period"
            raise InputError("period", parameters.period, rule)
        if steps[0] < SHORTEST_STEP * body.radius:
            rule = f"must be so high that a robot moves at least {SHORTEST_STEP} of its radius in a period"
            raise InputError("drive", min(drives), rule)
        for name in ("station_radius", "base_radius"):
            if (radius := getattr(parameters, name)) < steps[1] / 2:
                rule = f"must be at least {steps[1] / 2:.4g} m, or robots drive past the centre unnoticed"
                raise InputError(name, radius, rule)
        for name, time in (("learning", self.learning), ("duration", self.duration)):
            if 0 < time < parameters.period:
                raise InputError(name, time, f"must be at least one control period, {parameters.period} s")
        if body.radius + body.sensing_scale * parameters.wall_distance > self.side / 2:
            # Otherwise a robot could see walls in every direction and find no free heading.
            raise InputError("wall_distance", parameters.wall_distance, "must be less than half the arena")

    def _check_absent(self) -> None:
        if not self.absent:  # `absent_from` has no effect; the default makes equal games compare equal
            object.__setattr__(self, "absent_from", "learning")
        for robot in self.absent:
            if not 0 <= robot < self.size:
                raise InputError("absent", robot, f"must be a robot of the game, 0 to {self.size - 1}")
        if len(set(self.absent)) < len(self.absent):
            raise InputError("absent", self.absent, "must name each robot once")
        if len(self.absent) == self.size:
            raise InputError("absent", self.absent, "must leave a robot in the game")

    def _check_room(self) -> None:
        radius = self.body.radius
        reach = radius + self.parameters.clearance / 2
        room = max(0.0, self.side - 2 * self.parameters.wall_clearance - reach / 2) ** 2
        if self.size * math.pi * reach**2 > 0.7 * room:
            # Randomly placed discs jam when they cover about 80 % of the area. Packings in a square lose
            # a margin at the walls, which is much if there are few discs.
            rule = f"robots of radius {radius} m do not fit in a square of {self.side} m"
            raise InputError("n", self.size, rule)
        self.arena(0)

    @property
    def size(self) -> int:
        """Number of robots N, absent robots included."""
        return sum(swarm.size for swarm in self.swarms)

    @property
    def runs_user_code(self) -> bool:
        """Whether a game of this description executes user-defined code."""
        return any(swarm.runs_user_code for swarm in self.swarms)

    @property
    def action_set(self) -> tuple[Action, ...]:
        """The actions; flight and fight if `actions` is empty."""
        return self.actions or self.parameters.actions()

    def arena(self, seed: int) -> Arena:
        """Return the arena; only random stations depend on the seed of the run."""
        radii = self.parameters.station_radius, self.parameters.base_radius
        places = self.stations, self.bases
        return build_arena(self.layout, len(self.swarms), self.side, *radii, seed, *places)


def apportion(n: int, shares: Sequence[int]) -> list[int]:
    """Divide `n` robots among swarms in proportion to shares ≥ 1, by largest remainder; ties go to the first.

    Examples
    --------
    >>> apportion(6, [1, 2, 1])
    [2, 3, 1]
    """
    if n > MAX_ROBOTS:
        raise InputError("n", n, f"must be at most {MAX_ROBOTS}")
    total = sum(shares)
    sizes = [n * share // total for share in shares]
    by_remainder = sorted(range(len(shares)), key=lambda k: -(n * shares[k] % total))
    for k in by_remainder[: n - sum(sizes)]:
        sizes[k] += 1
    return sizes
