"""Parsing of policies, and building them for each robot.

A policy is a text, a class or a factory. A text is the name of a policy in `POLICIES`, a reference to a
user-defined class (``path/to/my_file.py:MyPolicy``), or the name of an action, which is then always taken.
Names and references may have arguments. Several policies, joined by ``+`` or in a list, are dealt out to the
robots of a swarm.
"""

import copy
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache, partial
from pathlib import Path
from typing import Any, Self

from kswarms.agents.actions import Action
from kswarms.agents.common.errors import InputError, require_type
from kswarms.agents.learning.rewards import make_reward
from kswarms.agents.learning.selection_rules import make_rule
from kswarms.agents.policies.fixed import FixedPolicy
from kswarms.agents.policies.interface import Policy, Setting
from kswarms.agents.policies.learner import LEARNER_DEFAULTS
from kswarms.agents.policies.registry import ALIASES, POLICIES
from kswarms.agents.policies.user_policy import check_factory, parameters_of
from kswarms.agents.user_code.loading import (
    check_reference,
    is_reference,
    load_class,
    reference_to,
    sources,
    user_errors,
)
from kswarms.agents.user_code.syntax import Call, is_literal, parse_call, split_outside

Factory = Callable[[Setting], Policy]
"""A policy class, or a callable that returns a policy: ``functools.partial(MyPolicy, patience=2)``."""
PolicyLike = str | Factory | Sequence[str | Factory]
"""One policy, or several that are dealt out to the robots of a swarm."""


@dataclass(frozen=True)
class PolicySpec:
    """One policy with its arguments; ``str(spec)`` is its text."""

    label: str  # text of the policy, or the name of a factory without a text
    given: Factory | None = None  # the class or factory, unless the policy was given as a text
    call: Call | None = field(default=None, compare=False)  # None if other processes cannot import it

    @classmethod
    def of_factory(cls, factory: Factory) -> Self:
        """Return the spec of a class or factory, with the text ``module:Class(…)`` if it is importable."""
        kind, arguments = factory, {}
        if isinstance(factory, partial) and not factory.args:
            kind, arguments = factory.func, factory.keywords
        reference = reference_to(kind)
        if reference is None or not all(map(is_literal, arguments.values())):
            return cls(getattr(kind, "__qualname__", repr(kind)), factory)
        call = Call(reference, arguments)
        return cls(str(call), factory, call)

    @property
    def text(self) -> str:
        """Text from which another process can build the policy; an `InputError` if there is none."""
        self._require_call()
        return self.label

    def _require_call(self) -> Call:
        if self.call is None:
            rule = (
                "cannot be imported by other processes: define the class at the top level of a module or "
                "script, and give the class or functools.partial of it with plain values"
            )
            raise InputError("policy", self.label, rule)
        return self.call

    @property
    def name(self) -> str:
        """Name or reference, without the arguments."""
        return self.label if self.call is None else self.call.name

    @property
    def arguments(self) -> Mapping[str, Any]:
        """Arguments by name."""
        return {} if self.call is None else self.call.arguments

    @property
    def is_user_defined(self) -> bool:
        """Whether the class of the policy comes from outside the package."""
        return self.given is not None or is_reference(self.name)

    @property
    def runs_user_code(self) -> bool:
        """Whether the policy, its reward or its rule comes from outside the package."""
        return self.given is not None or bool(self.references)

    @cached_property
    def references(self) -> Mapping[str, str]:
        """References to user-defined classes, by the field that has them."""
        named = {"policy": self.name}
        for part in LEARNER_DEFAULTS:
            if isinstance(text := self.arguments.get(part), str):
                named[f"policy.{part}"] = parse_call(f"policy.{part}", text).name
        return {field: name for field, name in named.items() if is_reference(name)}

    def check(self, setting: Setting) -> None:
        """Validate the policy for a game without executing user-defined code.

        Of a user-defined class only the form of its reference is checked. Raises an `InputError`.
        """
        for named_by, reference in self.references.items():
            check_reference(named_by, reference)
        if self.given is not None:
            check_factory(self.name, self.given, {})
        elif not is_reference(self.name):
            own = [part for part in LEARNER_DEFAULTS if f"policy.{part}" in self.references]
            built_in = {part: LEARNER_DEFAULTS[part] for part in own if self.learner_part(part)}
            (self.with_arguments(**built_in) if built_in else self).build(setting)

    def factory(self, actions: Sequence[Action]) -> Factory:
        """Load the class and check the arguments; return a factory for a game with these actions."""
        name, make, arguments = self.name, self.given, {} if self.given else dict(self.arguments)
        by_name = {action.name: action for action in actions}
        if make is None and name in by_name:
            if self.label != name:
                raise InputError("policy", self.label, "an action takes no arguments")
            return partial(FixedPolicy, within=by_name[name], against=by_name[name])
        if make is None and is_reference(name):
            make = load_class("policy", name)
        elif make is None:
            if name not in POLICIES:
                known = ", ".join([*POLICIES, *ALIASES, *by_name])
                rule = f"must be one of {known}, or several joined by '+', or a class as my_file.py:MyPolicy"
                raise InputError("policy", name, rule)
            make = POLICIES[name]
        check_factory(name, make, arguments)
        with InputError.within("policy"):
            if self.learner_part("reward"):  # all robots share one reward and one rule
                arguments["reward"] = make_reward(arguments.get("reward", LEARNER_DEFAULTS["reward"]))
                arguments["rule"] = make_rule(arguments.get("rule", LEARNER_DEFAULTS["rule"]))
        return partial(_build, name if self.is_user_defined else "", make, arguments)

    def build(self, setting: Setting) -> Policy:
        """Build the policy of one robot."""
        return self.factory(setting.actions)(setting)

    __call__ = build  # a spec is a factory, too

    def files(self) -> list[Path]:
        """Return the files that the policy depends on: user-defined code and learned policies."""
        file = self._require_call().arguments.get("file")
        found = self.code_files()
        return [*found, Path(file)] if isinstance(file, str) and Path(file).is_file() else found

    def code_files(self) -> list[Path]:
        """Return the files with user-defined code of the policy, its reward and its rule."""
        return [path for each in self.references.items() for path in sources(*each)]

    def learner_part(self, part: str) -> Call | None:
        """Return the ``reward`` or ``rule`` (`part`) of a learner; None for other policies."""
        if self.given or self.name not in POLICIES:
            return None
        if part not in (parameter.name for parameter in parameters_of(POLICIES[self.name])):
            return None
        return parse_call(part, self.arguments.get(part, LEARNER_DEFAULTS[part]))

    def with_arguments(self, **changes: Any) -> "PolicySpec":
        """Return the same policy with some arguments changed."""
        name, arguments = self._require_call()
        (changed,) = parse_policies(str(Call(name, {**arguments, **changes})))
        return changed

    def __str__(self) -> str:
        return self.label


def parse_policies(policy: PolicyLike) -> tuple[PolicySpec, ...]:
    """Return the policies of a swarm, in the order in which they are dealt out.

    Names and values are checked when a policy is built.

    Examples
    --------
    >>> [str(spec) for spec in parse_policies("attack+mixed")]
    ['attack', 'avoid', 'aggressive']
    >>> (spec,) = parse_policies("inter-learner(rule='greedy')")
    >>> print(spec.with_arguments(reward="individual"))
    inter-learner(rule='greedy', reward='individual')
    """
    if isinstance(policy, str):
        return _parse_text(policy)
    if isinstance(policy, PolicySpec):
        return (policy,)
    if callable(policy):
        return (PolicySpec.of_factory(policy),)
    if not isinstance(policy, Sequence) or not policy:
        raise InputError("policy", policy, "must be a text, a class, a callable, or a list of these")
    return tuple(spec for part in policy for spec in parse_policies(part))


@lru_cache(maxsize=512)
def _parse_text(text: str) -> tuple[PolicySpec, ...]:
    specs: list[PolicySpec] = []
    for part in split_outside(text, "+"):
        call = parse_call("policy", part)
        if part in ALIASES:
            specs += _parse_text(ALIASES[part])
        elif call.name in ALIASES:
            raise InputError("policy", part, f"stands for {ALIASES[call.name]}, and takes no arguments")
        else:
            specs.append(PolicySpec(part, call=call))
    return tuple(specs)


def deal(policy: PolicyLike, size: int) -> list[PolicySpec]:
    """Return the policy of each of the `size` robots of a swarm.

    Each policy gets an equal share of the robots, in order; the first policies get one more if any remain.

    Examples
    --------
    >>> [spec.text for spec in deal("mixed", 5)]
    ['avoid', 'avoid', 'avoid', 'aggressive', 'aggressive']
    """
    specs = parse_policies(policy)
    share, extra = divmod(size, len(specs))
    return [spec for k, spec in enumerate(specs) for _ in range(share + (k < extra))]


def make_policy(policy: str | Factory, setting: Setting) -> Policy:
    """Build the policy of one robot.

    Parameters
    ----------
    policy : str or callable
        One policy: a text, a class, or a callable that returns a policy.
    setting : Setting
        The robot and the game.

    Raises
    ------
    InputError
        If there is no such policy, it is not exactly one, an argument is not allowed, or user code fails.
    """
    require_type("setting", setting, Setting, "must be a kswarms.Setting")
    (spec,) = parse_policies(policy)
    return spec.build(setting)


def _build(
    reference: str, make: Callable[..., Policy], arguments: Mapping[str, Any], setting: Setting
) -> Policy:
    """Build a policy. A user-defined policy has a `reference` and gets its own copies of the arguments."""
    if not reference:
        with InputError.within("policy"):
            return make(setting, **arguments)
    with user_errors("policy", reference, "its constructor"), InputError.within("policy"):
        return make(setting, **copy.deepcopy(dict(arguments)))
