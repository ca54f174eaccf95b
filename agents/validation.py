"""Base class of every description: immutable data, checked once, at the edge."""

from typing import Any, Self

from pydantic import BaseModel, ConfigDict, ValidationError

from agents.errors import InputError


class Checked(BaseModel):
    """Frozen data without unknown fields, NaN or infinities.

    Raises
    ------
    InputError
        If a field is unknown, missing, of the wrong type or out of range.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    def __init__(self, **values: Any) -> None:
        try:
            super().__init__(**values)
        except ValidationError as error:
            raise InputError.from_validation(error, tuple(type(self).model_fields)) from None

    def replace(self, **changes: Any) -> Self:
        """Return a copy with some fields changed, checked like a new one."""
        return type(self)(**{**dict(self), **changes})
