"""Values of the page's controls, from which a game is built."""

from collections.abc import Mapping
from typing import Any, Literal, NamedTuple, Self

from kswarms.agents.body import BODIES
from kswarms.agents.common.descriptions import FrozenModel
from kswarms.agents.common.errors import InputError, require_integer
from kswarms.agents.common.limits import MAX_SEED
from kswarms.agents.learning.rewards import REWARDS
from kswarms.agents.learning.selection_rules import RULES
from kswarms.agents.policies.spec import parse_policies
from kswarms.agents.user_code.syntax import Call
from kswarms.model.description.game import Game
from kswarms.model.description.presets import parse_parameters, text_of
from kswarms.scenarios.description.condition import Condition, SwarmRule


class Form(NamedTuple):
    """Values of the controls. They may be invalid; `game` validates them."""

    swarms: tuple[dict[str, Any], ...]  # fields of a `SwarmRule` for each swarm
    fields: dict[str, Any]  # fields of a `Condition`: parameters as text, body by name
    n: int  # number of robots
    seed: int
    absent: tuple[int, ...] = ()
    absent_from: Literal["learning", "game"] = "learning"

    @classmethod
    def of_condition(cls, condition: Condition, n: int, seed: int) -> Self:
        """Return the form of a condition with a number of robots and a seed."""
        fields = condition.game_fields() | {"multiple_of": condition.multiple_of}
        fields["parameters"] = text_of(condition.parameters)
        if BODIES.get(condition.body.name) == condition.body:
            fields["body"] = condition.body.name
        return cls(tuple(rule.model_dump() for rule in condition.swarms), fields, n, seed)

    @classmethod
    def of_game(cls, game: Game, seed: int) -> Self:
        """Return the form of a game; the sizes of its swarms become shares."""
        rules = [SwarmRule(share=swarm.size, **swarm.model_dump(exclude={"size"})) for swarm in game.swarms]
        form = cls.of_condition(Condition(swarms=tuple(rules), **game.game_fields()), game.size, seed)
        return form._replace(absent=game.absent, absent_from=game.absent_from)

    def replace(self, **changes: Any) -> Self:
        """Return the form with some values changed: attributes of the form, or entries of `fields`."""
        own = {name: value for name, value in changes.items() if name in self._fields}
        fields = {name: value for name, value in changes.items() if name not in own}
        return self._replace(**{"fields": self.fields | fields, **own})

    def replace_swarm(self, k: int, **changes: Any) -> Self:
        """Return the form with some fields of a swarm (from 0) changed."""
        return self._replace(swarms=(*self.swarms[:k], self.swarms[k] | changes, *self.swarms[k + 1 :]))

    def game(self) -> Game:
        """Return the game; raise `InputError` if a value is invalid."""
        require_integer("seed", self.seed, 0, MAX_SEED)
        rules = tuple(SwarmRule(**swarm) for swarm in self.swarms)
        game = Condition(swarms=rules, **self.fields).game(self.n)
        return game.replace(absent=self.absent, absent_from=self.absent_from) if self.absent else game


def with_parameter(text: str, name: str, value: float) -> str:
    """Return the text of parameters with one value changed, without default values."""
    return text_of(parse_parameters(text).replace(**{name: value}))


class Learning(NamedTuple):
    """Reward and selection rule of a learner, by name, with their arguments Δ and γ."""

    reward: str
    rule: str
    delta: float | None  # None if the reward has no Δ, or a Δ for each opponent
    gamma: float | None  # None if the rule has no γ


def learning_of(policies: list[str], parameters: str) -> Learning | None:
    """Return reward and rule of the first learner among policies; None if no learner can be parsed.

    A rule without its own γ has that of the parameters of the game.
    """
    for policy in policies:
        try:
            for spec in parse_policies(policy):
                reward, rule = spec.learner_part("reward"), spec.learner_part("rule")
                if reward is not None and rule is not None:
                    delta = _argument(reward, REWARDS, "delta")
                    gamma = _argument(rule, RULES, "gamma", parse_parameters(parameters).gamma)
                    return Learning(reward.name, rule.name, delta, gamma)
        except InputError:
            continue
    return None


def _argument(
    call: Call, kinds: Mapping[str, type[FrozenModel]], name: str, default: float | None = None
) -> float | None:
    """Return a number that a call has as argument, or its default; None if it has no such number.

    `default` replaces a default of None.
    """
    fields = kinds[call.name].model_fields if call.name in kinds else {}
    if name not in fields:
        return None
    value = call.arguments.get(name, default if fields[name].default is None else fields[name].default)
    return float(value) if isinstance(value, int | float) else None
