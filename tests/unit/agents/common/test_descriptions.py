"""Validated data and errors of invalid input: one line with field, value and rule."""

import math
import pickle
from typing import Any

import pytest

from kswarms.agents.actions import AWAY, TOWARDS, Action
from kswarms.agents.common.descriptions import FrozenModel
from kswarms.agents.common.errors import InputError


class Nested(FrozenModel):
    """A nested description."""

    action: Action
    weights: tuple[float, ...] = ()


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"duration": 0}, "duration=0: must be greater than or equal to 0.000001"),
        ({"duration": 1e308}, "duration=1e+308: must be less than or equal to 1000000000"),
        ({"duration": -1.5}, "duration=-1.5: must be greater than or equal"),
        ({"duration": math.nan}, "duration=nan: must be a finite number"),
        ({"duration": math.inf}, "duration=inf: must be a finite number"),
        ({"duration": "soon"}, "duration='soon': must be a number"),
        ({"direction": 0}, "direction=0: must be -1 or 1"),
        *[({"name": name}, f"name={name!r}: ") for name in ("", "a+b", " pad ", "a,b", "x()", "f:X", "a\n")],
        ({"speed": 3}, "speed=3: unknown field; allowed: name, direction, duration"),
    ],
)
def test_invalid_actions_are_refused(values: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError) as refusal:
        Action(**{"name": "flight", "direction": AWAY, "duration": 1.0, **values})
    assert str(refusal.value).startswith(message)


def test_a_missing_field_is_named() -> None:
    with pytest.raises(InputError, match=r"^direction=None: is required$"):
        Action(name="flight", duration=1.0)  # type: ignore[call-arg]


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"action": {"name": "x", "direction": 1, "duration": -1}}, "action.duration=-1: must be greater"),
        ({"action": 7}, "action=7: "),
        ({"weights": [1.0, "much"]}, "weights.1='much': must be a number"),
    ],
)
def test_a_nested_field_has_a_dotted_name(values: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError) as refusal:
        Nested(**{"action": Action(name="flight", direction=AWAY, duration=1.0), **values})
    assert str(refusal.value).startswith(message)
    assert "\n" not in str(refusal.value)


def test_models_are_immutable_values() -> None:
    flight = Action(name="flight", direction=AWAY, duration=1.0)
    assert flight == Action(name="flight", direction=AWAY, duration=1.0)
    assert hash(flight) == hash(flight.replace())
    assert flight.replace(duration=2.0) == Action(name="flight", direction=AWAY, duration=2.0)
    assert flight.duration == 1.0
    with pytest.raises(InputError, match="duration=0"):
        flight.replace(duration=0)
    with pytest.raises(ValueError, match="frozen"):
        flight.duration = 3.0  # type: ignore[misc]
    assert pickle.loads(pickle.dumps(flight)) == flight


def test_errors_can_be_pickled() -> None:
    error: InputError = pickle.loads(pickle.dumps(InputError("n", -3, "must be ≥ 1")))
    assert type(error) is InputError
    assert (error.field, error.value, error.allowed) == ("n", -3, "must be ≥ 1")
    assert str(error) == "n=-3: must be ≥ 1"


def test_directions_are_those_of_equation_5_5() -> None:
    assert (TOWARDS, AWAY) == (1, -1)
