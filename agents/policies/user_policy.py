"""Policies of a user's own: what is asked of them before they play, and which files a policy is made of."""

import inspect
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, cast

from kswarms.agents.common.errors import InputError
from kswarms.agents.policies.interface import LearningPolicy, Policy, Setting
from kswarms.agents.policies.saved import check_arms
from kswarms.agents.user_code.loading import blaming, is_reference, load_class, sources
from kswarms.agents.user_code.syntax import Call, parse_call, require_known


def policy_class(call: Call) -> type[Any]:
    """Return the class that a call names: with the methods of a policy, and taking the call's arguments.

    Raises
    ------
    InputError
        If it is no such class.
    """
    kind = load_class("policy", call.name)
    missing = [] if _has(kind, "choose") else ["choose"]
    if _has(kind, "learn") and not _has(kind, "freeze"):
        missing.append("freeze, since it learns")
    if missing:
        raise InputError("policy", call.name, f"is no policy: it lacks {', '.join(missing)}")
    parameters = list(inspect.signature(kind).parameters.values())
    if not parameters or parameters[0].kind is inspect.Parameter.KEYWORD_ONLY:
        raise InputError("policy", call.name, "must take a Setting as its constructor's first argument")
    named = {p.name: p for p in parameters[1:] if p.kind not in (p.VAR_POSITIONAL, p.VAR_KEYWORD)}
    if not any(p.kind is p.VAR_KEYWORD for p in parameters):
        require_known("policy", call, named)
    for name, parameter in named.items():
        if parameter.default is parameter.empty and name not in call.arguments:
            raise InputError(f"policy.{name}", None, "is required")
    return kind


def _has(kind: type, method: str) -> bool:
    return callable(getattr(kind, method, None))


def rehearse(text: str, policy: Policy, setting: Setting) -> None:
    """Try a policy from outside, so that a mistake in it is told before the game; trust the package's own.

    Parameters
    ----------
    text : str
        What the policy was made from.
    policy : Policy
        One that plays in no game.
    setting : Setting
        What it was built for.

    Raises
    ------
    InputError
        If it fails, or returns what a policy does not.
    """
    name = parse_call("policy", text).name
    if not is_reference(name):
        return
    learn = getattr(policy, "learn", None)
    for opponent in range(setting.swarms):
        for _ in setting.actions:
            action = _tried(name, f"choose({opponent})", partial(policy.choose, opponent))
            if action not in setting.actions:
                raise InputError(
                    "policy", name, f"choose({opponent}) must return an action of the game, not {action!r}"
                )
            told = (0.0, 0.0) if learn is None else _tried(name, "learn(…)", partial(learn, 1.8, 6.0, 3))
            if not (isinstance(told, tuple) and len(told) == 2 and all(isinstance(x, float) for x in told)):
                raise InputError("policy", name, f"learn(…) must return two floats, R and Q, not {told!r}")
    if learn is not None:
        _tried(name, "freeze()", cast("LearningPolicy", policy).freeze)
    if (snapshot := getattr(policy, "snapshot", None)) is not None:
        arms = _tried(name, "snapshot()", snapshot)
        try:
            check_arms(arms)
        except (InputError, KeyError, TypeError) as error:
            raise InputError("policy", name, f"snapshot() must be as that of a Learner ({error})") from None
        names = [action.name for action in setting.actions]
        for arm in arms:
            if arm["action"] not in names or not 1 <= arm["opponent"] <= setting.swarms:
                raise InputError(
                    "policy", name, f"snapshot() must tell of the game's actions and swarms, not {arm}"
                )


def _tried(name: str, what: str, method: Callable[[], Any]) -> Any:
    with blaming("policy", name, what):
        return method()


def files(policy: str) -> list[Path]:
    """Return the files that a policy is made of: learned policies, and code from outside.

    Those are the code that the policy itself or its argument ``reward`` or ``rule`` names, and the file that
    its argument ``file`` names.

    Parameters
    ----------
    policy : str
        A text from which a policy was made.
    """
    call = parse_call("policy", policy)
    found = sources("policy", call.name) if is_reference(call.name) else []
    for field in ("reward", "rule"):
        text = call.arguments.get(field)
        if isinstance(text, str) and is_reference(name := parse_call(field, text).name):
            found += sources(field, name)
    file = call.arguments.get("file")
    return [*found, Path(file)] if isinstance(file, str) and Path(file).is_file() else found
