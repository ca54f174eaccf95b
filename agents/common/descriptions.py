"""Base class of every description: immutable data, checked once, at the edge."""

from typing import Any, Self, get_args

from pydantic import BaseModel, ConfigDict, ValidationError, model_validator

from kswarms.agents.common.errors import InputError


def _is_number(annotation: Any) -> bool:
    """Tell whether a field takes numbers, maybe among other things, but no truth values."""
    kinds = (annotation, *get_args(annotation))
    return (int in kinds or float in kinds) and bool not in kinds


class Checked(BaseModel):
    """Frozen data without unknown fields, NaN or infinities.

    Raises
    ------
    InputError
        If a field is unknown, missing, of the wrong type or out of range.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    # `/`, so that a user's field of the name self is one that there is not.
    def __init__(self, /, **values: Any) -> None:
        try:
            super().__init__(**values)
        except ValidationError as error:
            raise InputError.from_validation(error, tuple(type(self).model_fields)) from None

    @model_validator(mode="before")
    @classmethod
    def _no_truth_for_numbers(cls, values: Any) -> Any:
        # pydantic takes true for 1, so `seeds = true` would be played as one game.
        for name, value in values.items() if isinstance(values, dict) else ():
            field = cls.model_fields.get(name)
            if isinstance(value, bool) and field is not None and _is_number(field.annotation):
                raise InputError(name, value, "must be a number")
        return values

    def replace(self, /, **changes: Any) -> Self:
        """Return a copy with some fields changed, checked like a new one."""
        return type(self)(**{**dict(self), **changes})
