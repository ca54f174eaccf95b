"""The error for invalid input."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Self

from pydantic import ValidationError


class InputError(ValueError):
    """Invalid value of an argument, column or option.

    Parameters
    ----------
    field : str
        Name of the argument, column or option; nested names are joined by dots.
    value : object
        The invalid value.
    allowed : str
        The rule that the value breaks, for example ``must be greater than 0``.
    """

    __module__ = "kswarms"  # the public name, shown in tracebacks

    def __init__(self, field: str, value: object, allowed: str) -> None:
        # All three are passed on, so that the error can be pickled.
        super().__init__(field, value, allowed)
        self.field = field
        self.value = value
        self.allowed = allowed

    def __str__(self) -> str:
        return f"{self.field}={self.value!r}: {self.allowed}"

    @classmethod
    @contextmanager
    def within(cls, field: str) -> Iterator[None]:
        """Prefix the field of an `InputError` raised in the context with ``field.``."""
        try:
            yield
        except InputError as error:
            raise cls(f"{field}.{error.field}", error.value, error.allowed) from None

    @classmethod
    def from_validation(cls, error: ValidationError, fields: tuple[str, ...]) -> Self:
        """Convert the first error of a pydantic validation; `fields` are the names of the valid fields."""
        first = error.errors()[0]
        unknown = first["type"] == "extra_forbidden"
        # For a field with several types, pydantic adds type names to the path. Keep identifiers and indices,
        # and the name of an unknown field.
        *outer, last = first["loc"] or ("",)
        parts = [part for part in outer if str(part).isidentifier() or isinstance(part, int)]
        if unknown or str(last).isidentifier() or isinstance(last, int):
            parts.append(last)
        path = ".".join(map(str, parts))
        cause = first.get("ctx", {}).get("error")
        if isinstance(cause, InputError):
            outer_path = path.removesuffix(cause.field).removesuffix(".")  # a validator may name its field
            return cls(f"{outer_path}.{cause.field}".removeprefix("."), cause.value, cause.allowed)
        if unknown:
            return cls(path, first["input"], f"unknown field; allowed: {', '.join(fields)}")
        if first["type"] == "missing":
            return cls(path, None, "is required")
        return cls(path, first["input"], first["msg"].replace("Input should be", "must be"))
