"""Fields of a game that do not depend on the number of robots. `Game` and scenario conditions extend them."""

from typing import Annotated, Any, Final, Literal, get_args

import numpy as np
from pydantic import Field, InstanceOf, field_serializer, model_validator

from kswarms.agents.actions import Action
from kswarms.agents.body import BODIES, Body
from kswarms.agents.common.descriptions import FrozenModel
from kswarms.agents.common.errors import InputError
from kswarms.agents.common.limits import (
    LONGEST_DISTANCE,
    LONGEST_TIME,
    MAX_ACTIONS,
    MAX_PLACES,
    MAX_PUCKS,
    SHORTEST_DISTANCE,
    SHORTEST_TIME,
    SLOWEST,
)
from kswarms.agents.policies.spec import PolicySpec, parse_policies
from kswarms.model.description.parameters import Parameters
from kswarms.model.description.presets import PRESETS, parse_parameters

Layout = Literal["symmetric", "nearer-station", "random-stations"]
LAYOUTS: Final[tuple[Layout, ...]] = get_args(Layout)
Place = tuple[float, float]


class SwarmFields(FrozenModel):
    """Fields of a swarm that do not depend on its size.

    Attributes
    ----------
    policy : str, class, callable, or sequence of these
        One policy, or several that are dealt out to the robots (see `kswarms.agents.policies.spec.deal`).
        Stored as a text where it has one.
    drive, drive_action : float
        Drive command in state P and in state A, as a fraction of the top speed.
    """

    policy: Annotated[str, Field(min_length=1)] | tuple[InstanceOf[PolicySpec], ...]
    drive: float = Field(0.6, ge=SLOWEST, le=1)
    drive_action: float = Field(0.6, ge=SLOWEST, le=1)

    @model_validator(mode="before")
    @classmethod
    def _policy_to_text(cls, values: Any) -> Any:
        if not isinstance(values, dict) or isinstance(values.get("policy", ""), str):
            return values
        specs = parse_policies(values["policy"])
        text = all(spec.call is not None for spec in specs)
        return {**values, "policy": "+".join(map(str, specs)) if text else specs}

    @property
    def runs_user_code(self) -> bool:
        """Whether a policy of the swarm executes user-defined code."""
        return any(spec.runs_user_code for spec in parse_policies(self.policy))

    @field_serializer("policy")
    def _dump_policy(self, _: object) -> str:
        return self.policy_name

    @property
    def policy_name(self) -> str:
        """Text of the policy, or a description of a class or callable that has none."""
        return self.policy if isinstance(self.policy, str) else "+".join(map(str, self.policy))


class GameFields(FrozenModel):
    """Fields of a game that do not depend on the number of robots.

    Attributes
    ----------
    layout : {'symmetric', 'nearer-station', 'random-stations'}
        Placement of stations and bases; it scales with `side`.
    stations : tuple of (float, float)
        Centres of the stations (m), in place of those of the layout; the origin is the middle of the arena.
    bases : tuple of (float, float)
        Centres of the bases, one per swarm (m), in place of those of the layout.
    side : float
        Side of the arena (m).
    body : Body
        Body of the robots, or the name of one of `kswarms.agents.body.BODIES`.
    parameters : Parameters
        Free parameters of the world, or their text (see `parse_parameters`).
    actions : tuple of Action
        Actions of a robot in a conflict; empty for flight and fight with the durations of the parameters.
    supply : int, optional
        Pucks at each station; None or 0 for no limit.
    learning : float
        Duration of the learning phase before the measured game, in the same world (s). With 0, learners learn
        during the measured game.
    duration : float
        Duration of the measured game (s); its maximum if there is a puck limit.
    puck_limit : int, optional
        Number of deposited pucks, over all swarms, that ends the game; None or 0 for no limit.
    sample_period : float
        Time between two samples of the recorded tables (s).
    """

    layout: Layout = "symmetric"
    stations: tuple[Place, ...] = Field((), max_length=MAX_PLACES)
    bases: tuple[Place, ...] = Field((), max_length=MAX_PLACES)
    side: float = Field(2.0, ge=SHORTEST_DISTANCE, le=LONGEST_DISTANCE)
    body: Body = BODIES["krembot-sim"]
    parameters: Parameters = PRESETS["fitted"]
    actions: tuple[Action, ...] = Field((), max_length=MAX_ACTIONS)
    supply: int | None = Field(None, ge=1, le=MAX_PUCKS)
    learning: float = Field(0.0, ge=0, le=LONGEST_TIME)
    duration: float = Field(600.0, ge=SHORTEST_TIME, le=LONGEST_TIME)
    puck_limit: int | None = Field(None, ge=1, le=MAX_PUCKS)
    sample_period: float = Field(10.0, ge=SHORTEST_TIME, le=LONGEST_TIME)

    @model_validator(mode="before")
    @classmethod
    def _resolve_shorthands(cls, values: Any) -> Any:
        if not isinstance(values, dict):
            return values
        values = dict(values)
        if isinstance(text := values.get("parameters"), str):
            values["parameters"] = parse_parameters(text)
        if isinstance(name := values.get("body"), str):
            if name not in BODIES:
                raise InputError("body", name, f"must be one of {', '.join(BODIES)}, or a body as numbers")
            values["body"] = BODIES[name]
        for name in ("puck_limit", "supply"):
            if not isinstance(values.get(name), bool | np.bool_) and values.get(name) == 0:
                values[name] = None
        return values

    def game_fields(self) -> dict[str, Any]:
        """Return the fields of this class alone, without those of a subclass."""
        return {name: getattr(self, name) for name in GameFields.model_fields}
