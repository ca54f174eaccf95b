"""Bodies of robots."""

import math

import pytest

from kswarms.agents.body import BODIES, KREMBOT, KREMBOT_SIM, SENSORS, Body
from kswarms.agents.common.errors import InputError


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
def test_invalid_bodies_are_refused(field: str, value: float) -> None:
    with pytest.raises(InputError, match=f"^{field}="):
        Body(**{"name": "b", "radius": 0.1, "sensor_range": 0.5, "top_speed": 0.2, field: value})
