"""Base class of validated, immutable data."""

from typing import Any, Self, get_args

from pydantic import BaseModel, ConfigDict, ValidationError, model_validator

from kswarms.agents.common.errors import InputError


def _is_number(annotation: Any) -> bool:
    """Return whether a field takes numbers but no booleans."""
    kinds = (annotation, *get_args(annotation))
    return (int in kinds or float in kinds) and bool not in kinds


class FrozenModel(BaseModel):
    """Immutable pydantic model; an invalid, unknown or missing field, NaN or infinity raises `InputError`."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    # `/`, so that a field named self is reported as unknown.
    def __init__(self, /, **values: Any) -> None:
        try:
            super().__init__(**values)
        except ValidationError as error:
            raise InputError.from_validation(error, tuple(type(self).model_fields)) from None

    @model_validator(mode="before")
    @classmethod
    def _refuse_booleans_as_numbers(cls, values: Any) -> Any:
        # pydantic accepts true as 1, so `seeds = true` would mean one seed.
        for name, value in values.items() if isinstance(values, dict) else ():
            field = cls.model_fields.get(name)
            if isinstance(value, bool) and field is not None and _is_number(field.annotation):
                raise InputError(name, value, "must be a number")
        return values

    def replace(self, /, **changes: Any) -> Self:
        """Return a validated copy with some fields changed."""
        return type(self)(**{**dict(self), **changes})
