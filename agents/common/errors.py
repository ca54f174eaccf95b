"""The one error a user's input can cause."""

from typing import Self

from pydantic import ValidationError


class InputError(ValueError):
    """A value from outside is not allowed.

    Parameters
    ----------
    field : str
        Name of the argument, column or option, dotted where it is nested.
    value : object
        What was given.
    allowed : str
        What would have been allowed, as the end of the sentence "… must be".
    """

    __module__ = "kswarms"  # where users find it, and what tracebacks show

    def __init__(self, field: str, value: object, allowed: str) -> None:
        # All three go to ``args``, so that the error crosses process boundaries whole.
        super().__init__(field, value, allowed)
        self.field = field
        self.value = value
        self.allowed = allowed

    def __str__(self) -> str:
        return f"{self.field}={self.value!r}: {self.allowed}"

    @classmethod
    def from_validation(cls, error: ValidationError, fields: tuple[str, ...]) -> Self:
        """Turn the first complaint of pydantic into one line.

        Parameters
        ----------
        error : pydantic.ValidationError
            What pydantic found.
        fields : tuple of str
            Names of the fields that exist, to be named when an unknown one was given.
        """
        first = error.errors()[0]
        unknown = first["type"] == "extra_forbidden"
        # Where a field may have several types, pydantic puts the name of the type into the path. A field that
        # there is not may be called anything.
        *outer, last = first["loc"] or ("",)
        parts = [part for part in outer if str(part).isidentifier() or isinstance(part, int)]
        if unknown or str(last).isidentifier() or isinstance(last, int):
            parts.append(last)
        path = ".".join(map(str, parts))
        cause = first.get("ctx", {}).get("error")
        if isinstance(cause, InputError):
            return cls(f"{path}.{cause.field}" if path else cause.field, cause.value, cause.allowed)
        if unknown:
            return cls(path, first["input"], f"no such field; there are {', '.join(fields)}")
        if first["type"] == "missing":
            return cls(path, None, "is required")
        return cls(path, first["input"], first["msg"].replace("Input should be", "must be"))
