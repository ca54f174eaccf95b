"""Parsing of names with arguments: ``ucb``, ``wlu(delta=0.145)``, ``learner(rule="greedy")``."""

import ast
from collections.abc import Collection, Mapping
from typing import Any, NamedTuple, TypeVar

from kswarms.agents.common.descriptions import FrozenModel
from kswarms.agents.common.errors import InputError
from kswarms.agents.user_code.loading import is_reference, load_class, user_errors

_Thing = TypeVar("_Thing", bound=FrozenModel)


class Call(NamedTuple):
    """A name with keyword arguments; ``str(call)`` is its text."""

    name: str
    arguments: dict[str, Any]

    def __str__(self) -> str:
        inside = ", ".join(f"{key}={value!r}" for key, value in self.arguments.items())
        return f"{self.name}({inside})" if inside else self.name


def parse_call(field: str, text: str) -> Call:
    """Parse ``name`` or ``name(key=value, …)``, where the values are Python literals; errors name `field`.

    Examples
    --------
    >>> parse_call("reward", "wlu(delta=0.145)")
    Call(name='wlu', arguments={'delta': 0.145})
    """
    if not isinstance(text, str):
        raise InputError(field, text, "must be a text: name or name(key=value, …)")
    name, bracket, rest = text.strip().partition("(")
    if not bracket:
        return Call(name.strip(), {})
    try:
        call = ast.parse(f"_({rest}", mode="eval").body
        if not (isinstance(call, ast.Call) and isinstance(call.func, ast.Name)) or call.args:
            raise ValueError
        arguments = {str(word.arg): ast.literal_eval(word.value) for word in call.keywords if word.arg}
        if len(arguments) < len(call.keywords):
            raise ValueError
    except (SyntaxError, ValueError, TypeError, RecursionError, MemoryError):
        raise InputError(field, text, "must be name or name(key=value, …) with plain values") from None
    return Call(name.strip(), arguments)


def is_literal(value: Any) -> bool:
    """Return whether a value equals the literal that its ``repr`` denotes."""
    try:
        return bool(ast.literal_eval(repr(value)) == value)
    except (SyntaxError, ValueError, TypeError, RecursionError, MemoryError):
        return False


def build(field: str, text: str, known: Mapping[str, type[_Thing]], base: type) -> _Thing:
    """Build the object that a text describes, of a class in `known` or a user-defined subclass of `base`."""
    call = parse_call(field, text)
    if call.name in known:
        kind = known[call.name]
    elif is_reference(call.name):
        kind = load_class(field, call.name, base)
    else:
        allowed = f"must be one of {', '.join(known)}, or a class as my_file.py:MyClass"
        raise InputError(field, call.name, allowed)
    require_known(field, call.arguments, kind.model_fields)
    with user_errors(field, call.name, "its constructor"), InputError.within(field):
        return kind(**call.arguments)


def require_known(field: str, arguments: Mapping[str, Any], allowed: Collection[str]) -> None:
    """Raise an `InputError` if an argument is not among `allowed`."""
    for name, value in arguments.items():
        if name not in allowed:
            names = ", ".join(allowed) or "none"
            raise InputError(f"{field}.{name}", value, f"unknown field; allowed: {names}")


def split_outside(text: str, separator: str) -> list[str]:
    """Split a text at a separator outside brackets and quotes, and strip the parts.

    Examples
    --------
    >>> split_outside("attack, learner(reward='wlu', rule='ucb')", ",")
    ['attack', "learner(reward='wlu', rule='ucb')"]
    """
    parts, depth, quote = [""], 0, ""
    for letter in text:
        if quote:
            quote = "" if letter == quote else quote
        elif letter in "'\"":
            quote = letter
        else:
            depth += (letter in "([{") - (letter in ")]}")
        if letter == separator and not quote and depth == 0:
            parts.append("")
        else:
            parts[-1] += letter
    return [part.strip() for part in parts]
