"""What the controls of the page say: a game in the making, from which one that can be played is built."""

from typing import Any, Final, Literal, NamedTuple, Self

from kswarms.agents.actions import Action
from kswarms.agents.common.errors import InputError
from kswarms.agents.learning.rewards import REWARDS
from kswarms.agents.learning.selection_rules import RULES
from kswarms.agents.policies.spec import parse_policies
from kswarms.model.description.game import Game
from kswarms.model.description.parameters import parse_parameters, text_of
from kswarms.scenarios.description.condition import Condition, SwarmRule


class SwarmForm(NamedTuple):
    """The controls of one swarm, as the fields of `kswarms.scenarios.description.condition.SwarmRule`."""

    policy: str = "avoid"
    share: int = 1
    drive: float = 0.6
    drive_action: float = 0.6


class Form(NamedTuple):
    """The controls of a game; what they say need not be allowed until `game` is called.

    Attributes
    ----------
    swarms : tuple of SwarmForm
        S1 to SK.
    n, seed : int
        Robots in all; seed.
    layout, body, parameters, actions, learning, duration, multiple_of
        As in `kswarms.scenarios.description.condition.Condition`.
    puck_limit, supply : int
        Likewise; 0 for no limit.
    absent, absent_from
        As in `kswarms.model.description.game.Game`.
    """

    swarms: tuple[SwarmForm, ...]
    n: int = 20
    seed: int = 0
    layout: str = "symmetric"
    body: str = "krembot-sim"
    parameters: str = "fitted"
    actions: tuple[Action, ...] = ()
    learning: float = 0.0
    duration: float = 600.0
    puck_limit: int = 0
    supply: int = 0
    multiple_of: int | None = None
    absent: tuple[int, ...] = ()
    absent_from: Literal["learning", "game"] = "learning"

    @classmethod
    def of_condition(cls, condition: Condition, n: int, seed: int) -> Self:
        """Return the form of a curve of a scenario, for a number of robots and a seed."""
        return cls(
            swarms=tuple(SwarmForm(s.policy, s.share, s.drive, s.drive_action) for s in condition.swarms),
            n=n,
            seed=seed,
            puck_limit=condition.puck_limit or 0,
            supply=condition.supply or 0,
            **{name: getattr(condition, name) for name in _SHARED}
            | {"parameters": text_of(condition.parameters), "body": condition.body.name},
        )

    @classmethod
    def of_game(cls, game: Game, seed: int) -> Self:
        """Return the form of a game, its sizes as shares."""
        return cls(
            swarms=tuple(SwarmForm(s.policy, s.size, s.drive, s.drive_action) for s in game.swarms),
            n=game.size,
            seed=seed,
            layout=game.layout,
            body=game.body.name,
            parameters=text_of(game.parameters),
            actions=game.actions,
            learning=game.learning,
            duration=game.duration,
            puck_limit=game.puck_limit or 0,
            supply=game.supply or 0,
            absent=game.absent,
            absent_from=game.absent_from,
        )

    def condition(self) -> Condition:
        """Return the curve of a scenario that this is.

        Raises
        ------
        InputError
            If there is none.
        """
        return Condition(
            swarms=tuple(SwarmRule(**swarm._asdict()) for swarm in self.swarms),
            puck_limit=self.puck_limit or None,
            supply=self.supply or None,
            **{name: getattr(self, name) for name in _SHARED},
        )

    def game(self) -> Game:
        """Return the game.

        Raises
        ------
        InputError
            If there is none.
        """
        if isinstance(self.seed, bool) or not isinstance(self.seed, int) or self.seed < 0:
            raise InputError("seed", self.seed, "must be a whole number ≥ 0")
        game = self.condition().game(self.n)
        return game.replace(absent=self.absent, absent_from=self.absent_from) if self.absent else game

    def with_swarm(self, k: int, **changes: Any) -> Self:
        """Return the form with some controls of a swarm (from 0) changed."""
        swarms = [*self.swarms]
        swarms[k] = swarms[k]._replace(**changes)
        return self._replace(swarms=tuple(swarms))


_SHARED: Final = ("layout", "body", "parameters", "actions", "learning", "duration", "multiple_of")


def with_parameter(text: str, name: str, value: float) -> str:
    """Return a text of parameters with one of them changed; not named where the preset has that value.

    Raises
    ------
    InputError
        If the text is of no parameters, or the value not allowed.
    """
    return text_of(parse_parameters(text).replace(**{name: value}))


class Learning(NamedTuple):
    """What the controls of learning show: of the first learner among the policies.

    Attributes
    ----------
    reward, rule : str
        Names.
    delta, gamma : float, optional
        Δ and γ; None where the reward or the rule has none, or Δ is one for each opponent.
    """

    reward: str
    rule: str
    delta: float | None
    gamma: float | None


def learning_of(policies: list[str]) -> Learning | None:
    """Return how the first learner among some policies learns; none if no learner can be parsed."""
    for policy in policies:
        try:
            for spec in parse_policies(policy):
                reward, rule = spec.learns_by("reward"), spec.learns_by("rule")
                if reward is not None and rule is not None:
                    delta, gamma = (
                        _number(kinds[call.name].model_fields, call.arguments, name)
                        if call.name in kinds
                        else None
                        for kinds, call, name in ((REWARDS, reward, "delta"), (RULES, rule, "gamma"))
                    )
                    return Learning(reward.name, rule.name, delta, gamma)
        except InputError:
            continue
    return None


def _number(fields: Any, arguments: dict[str, Any], name: str) -> float | None:
    value = arguments.get(name, fields[name].default) if name in fields else None
    return float(value) if isinstance(value, int | float) else None
