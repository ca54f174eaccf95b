"""Names with arguments, as users write them: ``ucb``, ``wlu(delta=0.145)``, ``learner(rule="greedy")``."""

import ast
from collections.abc import Collection, Mapping
from typing import Any, NamedTuple, TypeVar

from kswarms.agents.common.descriptions import Checked
from kswarms.agents.common.errors import InputError
from kswarms.agents.user_code.loading import blaming, is_reference, load_class

_Thing = TypeVar("_Thing", bound=Checked)


class Call(NamedTuple):
    """A name and the keyword arguments that go with it."""

    name: str
    arguments: dict[str, Any]


def parse_call(field: str, text: str) -> Call:
    """Read ``name`` or ``name(key=value, …)``; the values are Python literals.

    Parameters
    ----------
    field : str
        What the text is for, to be named in an error.
    text : str
        For example ``wlu(delta={1: 0.02, 3: 0.125})``.

    Raises
    ------
    InputError
        If the text has another form.

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


def build(field: str, text: str, known: Mapping[str, type[_Thing]], base: type) -> _Thing:
    """Build the object that a text describes.

    Parameters
    ----------
    field : str
        What it is for, to be named in an error.
    text : str
        Name of one of `known` or reference to a user-defined class, with arguments.
    known : mapping of str to type
        The classes by name.
    base : type
        What a class from outside must be a subclass of.

    Raises
    ------
    InputError
        If the name is unknown or an argument not allowed.
    """
    call = parse_call(field, text)
    if is_reference(call.name):
        kind: type[_Thing] = load_class(field, call.name, base)
    elif call.name in known:
        kind = known[call.name]
    else:
        raise InputError(
            field, call.name, f"must be one of {', '.join(known)}, or a class as my_file.py:MyClass"
        )
    require_known(field, call, tuple(kind.model_fields))
    with blaming(field, call.name, "its constructor"):
        try:
            return kind(**call.arguments)
        except InputError as error:
            raise InputError(f"{field}.{error.field}", error.value, error.allowed) from None


def require_known(field: str, call: Call, allowed: Collection[str]) -> None:
    """Refuse a call with an argument that is not among `allowed`.

    Raises
    ------
    InputError
        If there is one.
    """
    for name, value in call.arguments.items():
        if name not in allowed:
            raise InputError(
                f"{field}.{name}", value, f"no such field; there are {', '.join(allowed) or 'none'}"
            )


def split_outside(text: str, separator: str) -> list[str]:
    """Split a text at a separator, but not within brackets or quotes, and strip the parts.

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
