"""Base class of validated, immutable data."""

import re
from functools import cache
from types import UnionType
from typing import Annotated, Any, Literal, Self, Union, get_args, get_origin

import numpy as np
from pydantic import AfterValidator, BaseModel, ConfigDict, ValidationError, model_validator

from kswarms.agents.common.errors import InputError
from kswarms.agents.common.limits import ONE_LINE


def _check_line(text: str) -> str:
    is_blank = text and not any(c.isprintable() and not c.isspace() for c in text)
    if is_blank or not re.fullmatch(ONE_LINE, text):
        raise InputError("", text, "must be one line with visible characters and no control characters")
    return text


Line = Annotated[str, AfterValidator(_check_line)]
"""Text on one line, not blank; it may be empty."""


def parse_number(text: str) -> float | str:
    """Return the number that a text stands for, or the text if it stands for none."""
    try:
        return float(text)
    except ValueError:
        return text


class FrozenModel(BaseModel):
    """Immutable pydantic model; an invalid, unknown or missing field raises `InputError`.

    Numbers are finite, and no booleans or texts. −0.0 becomes 0.0, so that equal models have equal texts.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    # `/`, so that a field named self is reported as unknown.
    def __init__(self, /, **values: Any) -> None:
        try:
            super().__init__(**values)
        except ValidationError as error:
            raise InputError.from_validation(error, tuple(type(self).model_fields)) from None

    @model_validator(mode="before")
    @classmethod
    def _check_numbers(cls, values: Any) -> Any:
        if not isinstance(values, dict):
            return values
        numbers = _fields_of_numbers(cls) & values.keys()
        return values | {name: _check_number(name, values[name]) for name in numbers}

    def replace(self, /, **changes: Any) -> Self:
        """Return a validated copy with some fields changed."""
        return type(self)(**{**dict(self), **changes})


@cache
def _fields_of_numbers(model: type[FrozenModel]) -> frozenset[str]:
    """Return the names of the fields that take numbers, or tuples of numbers, but no booleans and texts."""
    return frozenset(name for name, field in model.model_fields.items() if _is_number(field.annotation))


def _is_number(annotation: Any) -> bool:
    kind, arguments = get_origin(annotation), get_args(annotation)
    if kind is Literal:
        return all(type(value) is int for value in arguments)
    if kind is Annotated:
        return _is_number(arguments[0])
    if kind in (Union, UnionType, tuple):
        return all(_is_number(each) for each in arguments if each not in (type(None), Ellipsis))
    return annotation in (int, float)


def _check_number(name: str, value: Any) -> Any:
    # pydantic accepts true as 1 and "1" as 1, so `seeds = true` would mean one seed.
    if isinstance(value, list | tuple | set | frozenset):
        numbers = (_check_number(f"{name}.{k}", each) for k, each in enumerate(value))
        return list(numbers) if isinstance(value, list) else tuple(numbers)
    if isinstance(value, bool | np.bool_ | str | bytes):
        raise InputError(name, value, "must be a number")
    return 0.0 if isinstance(value, float | np.floating) and value == 0 else value
