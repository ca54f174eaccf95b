"""Validation of policy classes and factories."""

import inspect
from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any

from kswarms.agents.common.errors import InputError
from kswarms.agents.user_code.syntax import require_known


def check_factory(reference: str, make: Callable[..., Any], arguments: Mapping[str, Any]) -> None:
    """Raise an `InputError` if a policy class lacks a method, or the factory does not take the arguments."""
    if inspect.isclass(make):
        missing = [] if callable(getattr(make, "choose", None)) else ["choose"]
        if callable(getattr(make, "learn", None)) and not callable(getattr(make, "freeze", None)):
            missing.append("freeze, since it learns")
        if missing:
            raise InputError("policy", reference, f"is no policy: it lacks {', '.join(missing)}")
    parameters = parameters_of(make)
    if not parameters or parameters[0].kind is inspect.Parameter.KEYWORD_ONLY:
        raise InputError("policy", reference, "must take a Setting as its first argument")
    named = {p.name: p for p in parameters[1:] if p.kind not in (p.VAR_POSITIONAL, p.VAR_KEYWORD)}
    if not any(p.kind is p.VAR_KEYWORD for p in parameters):
        require_known("policy", arguments, named)
    for name, parameter in named.items():
        if parameter.default is parameter.empty and name not in arguments:
            raise InputError(f"policy.{name}", None, "is required")


@lru_cache(maxsize=64)
def parameters_of(make: Callable[..., Any]) -> tuple[inspect.Parameter, ...]:
    """Return the parameters of a class or factory, except those that a partial has fixed."""
    fixed = getattr(make, "keywords", {})
    return tuple(p for name, p in inspect.signature(make).parameters.items() if name not in fixed)
