"""Durations in control periods."""

import pytest

from kswarms.agents.robot.controller import Controller


@pytest.mark.parametrize(
    ("seconds", "period", "periods"),
    [
        (1.0, 0.1, 10),
        (0.3, 0.1, 3),  # 0.3 / 0.1 is a little less than 3,
        (0.14, 0.02, 7),  # and 0.14 / 0.02 a little more than 7
        (0.33, 0.03, 11),
        (0.05, 0.05, 1),
        (0.31, 0.1, 4),
        (1e-12, 0.1, 1),
        (600.0, 0.1, 6000),
        (36_000.0, 0.05, 720_000),
    ],
)
def test_durations_are_rounded_up_to_whole_periods(seconds: float, period: float, periods: int) -> None:
    controller = Controller(period, 0.3, 6.7, 1.5, 1.0, 0.1, 0.0, 0.085, 0.3, escape_away=False)
    assert controller.periods(seconds) == periods
