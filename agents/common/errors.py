"""The error for invalid input."""

import re
import reprlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final, Self

from pydantic import ValidationError

from kswarms.agents.common.quoting import for_terminal

LONGEST_VALUE: Final = 120
"""Maximum number of characters of a value or a field in a message."""
_LONGEST_RULE: Final = 2000
"""Maximum number of characters of a rule, which may list names."""


class _Shortener(reprlib.Repr):
    """`repr` that looks only at the beginning and the end of long values."""

    def __init__(self) -> None:
        super().__init__()
        self.maxstring = self.maxlong = self.maxother = LONGEST_VALUE

    def repr_int(self, value: int, level: int) -> str:
        """Python refuses to print very large integers."""
        bits = value.bit_length()
        return super().repr_int(value, level) if bits <= 2000 else f"<integer of {bits} bits>"

    def repr_PosixPath(self, value: Path, level: int) -> str:  # noqa: N802  # the name that reprlib requires
        """Show a path as the text that the user gave."""
        return self.repr_str(str(value), level)


_SHORTENER: Final = _Shortener()


def shorten(value: object) -> str:
    """Return `repr(value)` on one line, cut to `LONGEST_VALUE` characters, even if `repr` fails."""
    try:
        text = _SHORTENER.repr(value)
    except Exception:  # noqa: BLE001  # any error of a user's `__repr__`
        text = f"<{type(value).__name__}>"
    return _cut(printable(text))


def require_type(field: str, value: object, kind: type, allowed: str) -> None:
    """Raise an `InputError` unless a value is of a type; booleans are no numbers."""
    if not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool):
        raise InputError(field, value, allowed)


def require_integer(field: str, value: object, low: int, high: int) -> None:
    """Raise an `InputError` unless a value is an integer in a range."""
    if not isinstance(value, int) or isinstance(value, bool) or not low <= value <= high:
        raise InputError(field, value, f"must be an integer from {low} to {high}")


def printable(text: str) -> str:
    """Return a text as one line: line breaks become spaces, other control characters escape sequences."""
    return for_terminal(re.sub(r"\s*[\n\r]\s*", " ", text))


def _cut(text: str) -> str:
    """Cut the middle of a text that is longer than `LONGEST_VALUE`."""
    half = (LONGEST_VALUE - 3) // 2
    return text if len(text) <= LONGEST_VALUE else f"{text[:half]}...{text[-half:]}"


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

    Notes
    -----
    The text of the error is one line. It shows long fields and values shortened; the attributes are complete.
    """

    __module__ = "kswarms"  # the public name, shown in tracebacks

    def __init__(self, field: str, value: object, allowed: str) -> None:
        # All three are passed on, so that the error can be pickled.
        super().__init__(field, value, allowed)
        self.field = field
        self.value = value
        self.allowed = allowed

    def __str__(self) -> str:
        rule = printable(str(self.allowed))[:_LONGEST_RULE]
        return f"{_cut(printable(str(self.field)))}={shorten(self.value)}: {rule}"

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
            return cls(f"{outer_path}.{cause.field}".strip("."), cause.value, cause.allowed)
        if unknown:
            return cls(path, first["input"], f"unknown field; allowed: {', '.join(fields)}")
        if first["type"] == "missing":
            return cls(path, None, "is required")
        return cls(path, first["input"], first["msg"].replace("Input should be", "must be"))
