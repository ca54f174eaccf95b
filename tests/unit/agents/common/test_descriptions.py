"""Actions, bodies and errors of invalid input: one line with field, value and rule."""

import math
import pickle
from typing import Any

import pytest

from kswarms.agents.actions import AWAY, TOWARDS, Action
from kswarms.agents.body import BODIES, KREMBOT, KREMBOT_SIM, SENSORS, Body
from kswarms.agents.common.descriptions import Checked
from kswarms.agents.common.errors import InputError
from kswarms.agents.robot.controller import Controller


class Nested(Checked):
    """A nested description."""

    action: Action
    weights: tuple[float, ...] = ()


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"duration": 0}, "duration=0: must be greater than 0"),
        ({"duration": 1e308}, "duration=1e+308: must be less than or equal to 1000000000"),
        ({"duration": -1.5}, "duration=-1.5: must be greater than 0"),
        ({"duration": math.nan}, "duration=nan: must be a finite number"),
        ({"duration": math.inf}, "duration=inf: must be a finite number"),
        ({"duration": "soon"}, "duration='soon': must be a valid number"),
        ({"direction": 0}, "direction=0: must be -1 or 1"),
        *[({"name": name}, f"name={name!r}: ") for name in ("", "a+b", " pad ", "a,b", "x()", "f:X", "a\n")],
        ({"speed": 3}, "speed=3: no such field; there are name, direction, duration"),
    ],
)
def test_an_action_refuses(values: dict[str, Any], message: str) -> None:
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
        ({"weights": [1.0, "much"]}, "weights.1='much': must be a valid number"),
    ],
)
def test_a_nested_field_has_a_dotted_name(values: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError) as refusal:
        Nested(**{"action": Action(name="flight", direction=AWAY, duration=1.0), **values})
    assert str(refusal.value).startswith(message)
    assert "\n" not in str(refusal.value)


def test_descriptions_are_values() -> None:
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


def test_the_two_scales_of_the_krembot() -> None:
    assert SENSORS == 8
    assert (KREMBOT_SIM.radius, KREMBOT_SIM.sensor_range, KREMBOT_SIM.top_speed) == (0.085, 0.667, 0.25)
    assert (KREMBOT.radius, KREMBOT.sensor_range, KREMBOT.top_speed) == (0.0325, 0.2551, 0.25)
    assert KREMBOT_SIM.sensing_scale == 1.0
    assert KREMBOT.sensing_scale == pytest.approx(0.0325 / 0.085)
    # The range in the small scale is that of the large scale, reduced like every sensing distance.
    assert KREMBOT.sensor_range == pytest.approx(KREMBOT.sensing_scale * KREMBOT_SIM.sensor_range, rel=1e-3)


def test_bodies_are_found_by_name() -> None:
    assert {name: body.name for name, body in BODIES.items()} == {name: name for name in BODIES}
    assert (BODIES["krembot-sim"], BODIES["krembot"]) == (KREMBOT_SIM, KREMBOT)


@pytest.mark.parametrize("field", ["radius", "sensor_range", "top_speed"])
@pytest.mark.parametrize("value", [0, -0.1, math.nan])
def test_a_body_refuses(field: str, value: float) -> None:
    with pytest.raises(InputError, match=f"^{field}="):
        Body(**{"name": "b", "radius": 0.1, "sensor_range": 0.5, "top_speed": 0.2, field: value})


@pytest.mark.parametrize(
    ("seconds", "period", "periods"),
    [
        (1.0, 0.1, 10),
        (0.3, 0.1, 3),  # 0.3 / 0.1 is a little less than 3,
        (0.14, 0.02, 7),  # and 0.14 / 0.02 a little more than 7
        (0.33, 0.03, 11),
        (0.05, 0.05, 1),
        (0.31, 0.1, 4),
        (0.05, 0.1, 1),
        (1e-12, 0.1, 1),
        (600.0, 0.1, 6000),
        (36_000.0, 0.05, 720_000),
    ],
)
def test_durations_are_whole_periods_rounded_up(seconds: float, period: float, periods: int) -> None:
    controller = Controller(
        period=period,
        turn_step=0.3,
        leg_mean=6.7,
        wander_turn=1.5,
        half=1.0,
        wall_reach=0.1,
        wall_half_angle=0.0,
        radius=0.085,
        active_range=0.3,
        escape_away=False,
    )
    assert controller.periods(seconds) == periods
