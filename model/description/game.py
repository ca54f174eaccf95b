"""A game as data: who plays, where, for how long. Everything that decides what is simulated, but the seed."""

import math
from collections.abc import Sequence
from typing import Any, Final, Literal, Self

from pydantic import (
    Field,
    SerializerFunctionWrapHandler,
    field_validator,
    model_serializer,
    model_validator,
)

from kswarms.agents.actions import Action
from kswarms.agents.common.descriptions import Checked
from kswarms.agents.common.errors import InputError
from kswarms.agents.policies.interface import Setting
from kswarms.agents.policies.registry import ALIASES, POLICIES, make_policy, parts
from kswarms.agents.policies.user_policy import rehearse
from kswarms.agents.robot.body import BODIES, Body
from kswarms.agents.streams import Streams
from kswarms.model.description.arena import LAYOUTS, Arena, build_arena
from kswarms.model.description.parameters import PRESETS, Parameters

MOST_PERIODS: Final = 2**53
"""No game has more, so that they can be counted."""
MOST_ROBOTS: Final = 1_000_000
"""No swarm has more, nor does a number of robots that is divided among swarms."""
MOST_PUCKS: Final = 10**9
"""More are no limit."""
LONGEST_STEP: Final = 0.8
"""What a robot may cover in a period, as a part of its radius: two that meet must not pass each other."""


class Swarm(Checked):
    """One swarm.

    Attributes
    ----------
    policy : str
        Policy of its robots, or several, dealt out (see `kswarms.agents.policies.registry.deal`).
    size : int
        Robots in it.
    drive, drive_action : float
        Drive command in state P and in state A, as a part of the top speed.
    """

    policy: str
    size: int = Field(ge=1, le=MOST_ROBOTS)
    drive: float = Field(0.6, gt=0, le=1)
    drive_action: float = Field(0.6, gt=0, le=1)


class Game(Checked):
    """A game.

    Attributes
    ----------
    swarms : tuple of Swarm
        The swarms, S1 first.
    layout : str
        Where stations and bases are: one of `kswarms.model.description.arena.LAYOUTS`.
    parameters : Parameters
        The free parameters of the world.
    body : str
        One of `kswarms.agents.robot.body.BODIES`.
    actions : tuple of Action
        What a robot can do at a conflict; empty for flight and fight with the parameters' durations.
    side : float
        Side of the arena (m); the layouts, given for 2 m, scale with it.
    learning : float
        Time for which learners learn before the measured game, in the same world (s); with 0 they learn in
        the measured game itself.
    duration : float
        Length of the measured game, or the longest it may take if there is a puck limit (s).
    puck_limit : int, optional
        The game ends with this puck deposited, over all swarms.
    supply : int, optional
        Pucks at each station; no limit if not given.
    absent : tuple of int
        Numbers of robots that are not there, ascending. All others keep theirs, and with them their streams,
        starting places and policies, so that two games differ by what the absent robots would have done.
    absent_from : {'learning', 'game'}
        Whether they are absent from the very beginning, or learn and leave before the measured game.

    Raises
    ------
    InputError
        If a field is out of range or the fields do not go together.
    """

    swarms: tuple[Swarm, ...] = Field(min_length=1)
    layout: str = "symmetric"
    parameters: Parameters = PRESETS["fitted"]
    body: str = "krembot-sim"
    actions: tuple[Action, ...] = ()
    side: float = Field(2.0, gt=0, le=10_000)
    learning: float = Field(0.0, ge=0)
    duration: float = Field(600.0, gt=0)
    puck_limit: int | None = Field(None, ge=1, le=MOST_PUCKS)
    supply: int | None = Field(None, ge=1, le=MOST_PUCKS)
    absent: tuple[int, ...] = ()
    absent_from: Literal["learning", "game"] = "learning"

    @field_validator("absent")
    @classmethod
    def _ascending(cls, absent: tuple[int, ...]) -> tuple[int, ...]:
        return tuple(sorted(absent))

    @model_serializer(mode="wrap")
    def _plain(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        fields: dict[str, Any] = handler(self)
        if not self.absent:
            # So that a game with all its robots has one name, whatever its absent robots would have done.
            fields.pop("absent", None)
            fields.pop("absent_from", None)
        return fields

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.layout not in LAYOUTS:
            raise InputError("layout", self.layout, f"must be one of {', '.join(LAYOUTS)}")
        if self.layout == "nearer-station" and len(self.swarms) > 2:
            # Its upper station is solved from the distances to two bases; a third swarm would have its own.
            raise InputError("layout", self.layout, f"must have at most 2 swarms, not {len(self.swarms)}")
        if self.body not in BODIES:
            raise InputError("body", self.body, f"must be one of {', '.join(BODIES)}")
        names = [action.name for action in self.action_set]
        if len(set(names)) < len(names):
            raise InputError("actions", names, "must have different names")
        for name in names:
            if name in POLICIES or name in ALIASES:
                raise InputError("actions", name, "must not have the name of a policy")
        for k, swarm in enumerate(self.swarms):
            setting = Setting(k, len(self.swarms), self.action_set, Streams(0, 0))
            for text in parts(swarm.policy):
                rehearse(text, make_policy(text, setting), setting)
        fastest = max(max(swarm.drive, swarm.drive_action) for swarm in self.swarms)
        step = self.parameters.period * self.body_preset.top_speed * fastest
        if step > LONGEST_STEP * self.body_preset.radius:
            raise InputError(
                "period",
                self.parameters.period,
                f"must be so short that a robot covers at most {LONGEST_STEP} of its radius",
            )
        periods = (self.learning + self.duration) / self.parameters.period
        if periods > MOST_PERIODS:
            raise InputError(
                "duration", self.duration, f"must be at most {MOST_PERIODS} periods, learning included"
            )
        reach = self.body_preset.radius + self.body_preset.sensing_scale * self.parameters.wall_distance
        if reach > self.side / 2:
            # Else a robot could have walls ahead in every direction, and never find where to turn.
            raise InputError(
                "wall_distance", self.parameters.wall_distance, "must be less than half the arena"
            )
        self._check_absent()
        self._check_room()
        return self

    def _check_absent(self) -> None:
        for robot in self.absent:
            if not 0 <= robot < self.size:
                raise InputError("absent", robot, f"must be a robot of the game, 0 to {self.size - 1}")
        if len(set(self.absent)) < len(self.absent):
            raise InputError("absent", self.absent, "must name each robot once")
        if len(self.absent) == self.size:
            raise InputError("absent", self.absent, "must leave a robot in the game")

    def _check_room(self) -> None:
        parameters, body, n = self.parameters, self.body_preset, self.size
        room = max(0.0, self.side - 2 * parameters.wall_clearance) ** 2
        if n * math.pi * (body.radius + parameters.clearance / 2) ** 2 > 0.7 * room:
            # Discs that are put down at random and parted jam when they cover about 80 % of the ground.
            raise InputError(
                "n", n, f"robots of radius {body.radius} m do not fit in a square of {self.side} m"
            )
        self.arena(0)  # of random stations, one layout tells whether there is room for any

    @property
    def size(self) -> int:
        """Robots in all, N, those that are absent included."""
        return sum(swarm.size for swarm in self.swarms)

    @property
    def body_preset(self) -> Body:
        """The body by its name."""
        return BODIES[self.body]

    @property
    def action_set(self) -> tuple[Action, ...]:
        """The actions, flight and fight if none were given."""
        return self.actions or self.parameters.actions()

    def arena(self, seed: int) -> Arena:
        """Build the arena; the seed matters to random stations alone.

        Raises
        ------
        InputError
            If stations, bases and walls overlap.
        """
        return build_arena(
            self.layout,
            len(self.swarms),
            self.side,
            self.parameters.station_radius,
            self.parameters.base_radius,
            seed,
        )


def apportion(n: int, shares: Sequence[int]) -> list[int]:
    """Divide `n` robots among swarms in proportion: by largest remainder, ties to the first.

    Parameters
    ----------
    n : int
        Robots in all.
    shares : sequence of int
        Proportions, each ≥ 1.

    Raises
    ------
    InputError
        If there are more than `MOST_ROBOTS`.

    Examples
    --------
    >>> apportion(6, [1, 2, 1])
    [2, 3, 1]
    """
    if n > MOST_ROBOTS:
        raise InputError("n", n, f"must be at most {MOST_ROBOTS}")
    whole = sum(shares)
    sizes = [n * share // whole for share in shares]
    by_remainder = sorted(range(len(shares)), key=lambda k: -(n * shares[k] % whole))
    for k in by_remainder[: n - sum(sizes)]:
        sizes[k] += 1
    return sizes
