"""The free parameters, their presets, and how they are read from text (section 2.7, the ARGoS reference)."""

import math
import re
from typing import Any

import pytest

from kswarms.agents.common.errors import InputError
from kswarms.model.description.parameters import Parameters
from kswarms.model.description.presets import PRESETS, parse_parameters, text_of

FITTED, ARGOS = PRESETS["fitted"], PRESETS["argos"]

DOCUMENTED = {
    "period": 0.1,
    "conflict_distance": 0.1718,
    "front_half_angle": math.radians(62.5),
    "flight_duration": 1.619,
    "fight_duration": 1.0,
    "turning_rate": 2.96,
    "flight_range": 0.46,
    "active_range": 0.2467,
    "leg_mean": 6.7,
    "wander_turn": math.radians(86),
    "wall_distance": 0.06,
    "station_radius": 0.16,
    "base_radius": 0.17,
    "base_range": 0.82,
    "push_share": 0.0,
    "preempt": False,
}

# The push share is fitted to the ARGoS file; the rest is given with it, as is the friction of the engine.
ARGOS_VALUES = {
    "period": 0.1,
    "conflict_distance": 0.10,
    "front_half_angle": math.radians(67.5),
    "flight_duration": 1.0,
    "fight_duration": 1.0,
    "turning_rate": math.pi / 0.8,
    "flight_range": 0.667,
    "leg_mean": 3.0,
    "wander_turn": math.radians(120),
    "wall_distance": 0.10,
    "wall_half_angle": math.pi / 4,
    "wall_escape": "away",
    "station_radius": 0.12,
    "base_radius": 0.12,
    "base_range": 0.667,
    "friction": 0.7,
    "push_share": 1.0,
    "clearance": 0.01,
    "wall_clearance": 0.005,
    "preempt": False,
}


@pytest.mark.parametrize(
    ("preset", "values"), [(FITTED, DOCUMENTED), (ARGOS, ARGOS_VALUES)], ids=["fitted", "argos"]
)
def test_a_preset_has_the_documented_values(preset: Parameters, values: dict[str, Any]) -> None:
    found = {name: getattr(preset, name) for name in values}
    numbers = {name: value for name, value in values.items() if isinstance(value, float)}
    assert {name: found[name] for name in numbers} == pytest.approx(numbers, rel=1e-4)
    assert {name: found[name] for name in values.keys() - numbers} == {
        name: values[name] for name in values.keys() - numbers
    }


def test_the_standard_actions_have_the_parameters_durations() -> None:
    flight, fight = FITTED.replace(flight_duration=2.5, fight_duration=0.5).actions()
    assert (flight.name, flight.direction, flight.duration) == ("flight", -1, 2.5)
    assert (fight.name, fight.direction, fight.duration) == ("fight", 1, 0.5)


@pytest.mark.parametrize(
    ("text", "parameters"),
    [
        ("fitted", FITTED),
        ("argos", ARGOS),
        ("  argos ", ARGOS),
        ("fitted,friction=0.3", FITTED.replace(friction=0.3)),
        ("fitted, friction = 0.3 , preempt=true", FITTED.replace(friction=0.3, preempt=True)),
        ("argos, wall_escape=clear, leg_mean=1e1", ARGOS.replace(wall_escape="clear", leg_mean=10.0)),
    ],
)
def test_parameters_are_parsed_from_text(text: str, parameters: Parameters) -> None:
    assert parse_parameters(text) == parameters


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "parameters='': must begin with one of fitted, argos"),
        ("fit", "parameters='fit': must begin with one of fitted, argos"),
        ("friction=0.3", "parameters='friction=0.3': must begin with one of"),
        ("fitted,", "parameters='': after the preset, must be name=value"),
        ("fitted, friction", "parameters='friction': after the preset, must be name=value"),
        ("fitted, mu=0.3", "mu=0.3: unknown field; allowed: period, conflict_distance,"),
        ("fitted, self=1", "self=1.0: unknown field; allowed: period, conflict_distance,"),
        ("fitted, friction=0.1, friction=0.2", "parameters.friction='0.2': must be given once"),
        ("fitted, conflict_distance=1e300", "conflict_distance=1e+300: must be less than or equal to"),
        ("fitted, friction=much", "friction='much': must be a number"),
        ("fitted, friction=-0.1", "friction=-0.1: must be greater than or equal to 0"),
        ("fitted, friction=nan", "friction=nan: must be a finite number"),
        ("fitted, preempt=perhaps", "preempt='perhaps': must be a valid boolean"),
        ("fitted, wall_escape=up", "wall_escape='up': must be 'clear' or 'away'"),
    ],
)
def test_an_invalid_text_is_refused(text: str, message: str) -> None:
    with pytest.raises(InputError) as refusal:
        parse_parameters(text)
    assert str(refusal.value).startswith(message)
    assert "\n" not in str(refusal.value)


MAY_BE_ZERO = {"friction", "push_share", "gamma", "clearance", "wall_clearance", "wall_half_angle"}
NUMBERS = [name for name, field in Parameters.model_fields.items() if field.annotation is float]


@pytest.mark.parametrize("name", NUMBERS)
@pytest.mark.parametrize("value", [-1.0, math.nan, math.inf, "x", None])
def test_a_number_out_of_range_is_refused(name: str, value: object) -> None:
    with pytest.raises(InputError, match=f"^{name}="):
        Parameters(**{name: value})


@pytest.mark.parametrize("name", NUMBERS)
def test_zero_is_refused_if_it_is_out_of_range(name: str) -> None:
    if name in MAY_BE_ZERO:
        assert getattr(Parameters(**{name: 0.0}), name) == 0.0
    else:
        with pytest.raises(InputError, match=f"^{name}=0.0: must be greater than "):
            Parameters(**{name: 0.0})


@pytest.mark.parametrize(
    ("name", "value"),
    [
        *[("push_share", 1.01), ("front_half_angle", 3.2), ("wander_turn", 3.2), ("wall_half_angle", 1.6)],
        *[("flight_duration", 1.1e9), ("fight_duration", 1.1e9), ("leg_mean", 1.1e9)],
        *[
            ("clearance", 10_001.0),
            ("wall_clearance", 10_001.0),
            ("station_radius", 1e5),
            ("base_radius", 1e5),
        ],
        *[("turning_rate", 1e308), ("turning_rate", 1001.0), ("friction", 1e308), ("friction", 10.1)],
    ],
)
def test_a_number_above_its_range_is_refused(name: str, value: float) -> None:
    with pytest.raises(InputError, match=f"^{name}={re.escape(str(value))}: must be less than"):
        Parameters(**{name: value})


@pytest.mark.parametrize(
    ("name", "value", "least"),
    [
        *[
            ("period", 9e-7, "0.000001"),
            ("leg_mean", 1e-308, "0.000001"),
            ("flight_duration", 9e-7, "0.000001"),
        ],
        *[
            ("turning_rate", 1e-320, "0.001"),
            ("front_half_angle", 1e-9, "0.001"),
            ("wander_turn", 9e-4, "0.001"),
        ],
        *[
            ("station_radius", 1e-9, "0.0001"),
            ("base_radius", 5e-324, "0.0001"),
            ("base_range", 9e-5, "0.0001"),
        ],
    ],
)
def test_a_number_below_its_range_is_refused(name: str, value: float, least: str) -> None:
    with pytest.raises(InputError) as refusal:
        Parameters(**{name: value})
    assert str(refusal.value) == f"{name}={value}: must be greater than or equal to {least}"


@pytest.mark.parametrize(
    "text", ["fitted", "argos", "fitted, friction=0.3, preempt=True", "argos, wall_escape=clear"]
)
def test_the_shortest_text_of_parameters(text: str) -> None:
    assert text_of(parse_parameters(text)) == text
