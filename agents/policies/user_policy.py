"""Validation of user-defined policies."""

import copy
import inspect
from collections.abc import Callable, Mapping
from typing import Any

from kswarms.agents.common.errors import InputError
from kswarms.agents.policies.interface import Policy, Setting
from kswarms.agents.user_code.loading import user_errors
from kswarms.agents.user_code.syntax import require_known


def check_factory(reference: str, make: Callable[..., Any], arguments: Mapping[str, Any]) -> None:
    """Check that a class or factory has the methods of a policy and takes the arguments.

    Raises
    ------
    InputError
        If it does not.
    """
    if inspect.isclass(make):
        missing = [] if callable(getattr(make, "choose", None)) else ["choose"]
        if callable(getattr(make, "learn", None)) and not callable(getattr(make, "freeze", None)):
            missing.append("freeze, since it learns")
        if missing:
            raise InputError("policy", reference, f"is no policy: it lacks {', '.join(missing)}")
    parameters = list(inspect.signature(make).parameters.values())
    if not parameters or parameters[0].kind is inspect.Parameter.KEYWORD_ONLY:
        raise InputError("policy", reference, "must take a Setting as its first argument")
    named = {p.name: p for p in parameters[1:] if p.kind not in (p.VAR_POSITIONAL, p.VAR_KEYWORD)}
    if not any(p.kind is p.VAR_KEYWORD for p in parameters):
        require_known("policy", arguments, named)
    for name, parameter in named.items():
        if parameter.default is parameter.empty and name not in arguments:
            raise InputError(f"policy.{name}", None, "is required")


def build_user_policy(
    reference: str, make: Callable[..., Policy], arguments: Mapping[str, Any], setting: Setting
) -> Policy:
    """Build a user-defined policy with its own copy of the arguments.

    Raises
    ------
    InputError
        If the constructor raises.
    """
    with user_errors("policy", reference, "its constructor"), InputError.within("policy"):
        return make(setting, **copy.deepcopy(dict(arguments)))
