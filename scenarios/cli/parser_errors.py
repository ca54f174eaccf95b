"""Errors of typer's parser as `InputError`: typer's messages lack the value or the rule."""

import re
from collections.abc import Sequence
from typing import Any

from pydantic import ValidationError

from kswarms.agents.common.errors import InputError


def to_input_error(error: Any, words: Sequence[str]) -> InputError:
    """Return the `InputError` of a `typer.TyperException`; `words` are the arguments of the command line."""
    param = getattr(error, "param", None)
    if isinstance(error.__cause__, ValidationError) and param is not None:
        return _invalid_value(InputError.from_validation(error.__cause__, ()), param)
    if param is not None:
        return InputError(_field_of(param), None, error.message or "is required")
    context, option = getattr(error, "ctx", None), getattr(error, "option_name", None)
    if option is not None and context is not None:
        known = [name for each in context.command.get_params(context) for name in each.opts]
        names = sorted(name for name in known if name.startswith("-"))
        return InputError("option", option, f"must be one of {', '.join(names)}")
    if option is not None:
        values = [word.partition("=")[2] for word in words if word.startswith(f"{option}=")]
        rule = "takes no value" if values else "needs a value"
        return InputError(_name(option), values[0] if values else None, rule)
    message = error.format_message()
    extra = re.fullmatch(r"Got unexpected extra argument\(s\) \((.*)\)", message, re.DOTALL)
    if extra and context is not None:
        return InputError("arguments", extra[1], f"must not be given; {context.get_usage()}")
    return InputError("arguments", " ".join(words), message)


def _invalid_value(found: InputError, param: Any) -> InputError:
    # For a choice, typer's rule repeats the value.
    allowed = found.allowed.removeprefix(f"Value error, {found.value!r} ").removesuffix(".")
    return InputError(_field_of(param), found.value, allowed.replace("is not one of", "must be one of"))


def _field_of(param: Any) -> str:
    if param.param_type_name == "argument":
        return str(param.metavar or param.name).lower()
    return _name(param.opts[-1])


def _name(option: str) -> str:
    return option.lstrip("-").replace("-", "_")
