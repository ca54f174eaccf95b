"""Estimate of the CPU time of a run."""

from typing import Final

ROBOT_SECOND: Final = 5e-6
"""CPU time per robot and second of play, at a control period of 0.1 s (s)."""
ROBOT_SECONDS_PER_PUCK: Final = 300.0
"""Play per puck, in games that end at a number of pucks (robot-seconds)."""


def cpu_seconds(n: int, learning: float, duration: float, puck_limit: int | None, period: float) -> float:
    """Estimate the CPU time of a run (s): proportional to robots × periods of play.

    The parameters are the number of robots, the durations of learning and game (s), the number of pucks that
    ends the game, and the control period (s).
    """
    if puck_limit is not None:
        duration = min(duration, puck_limit * ROBOT_SECONDS_PER_PUCK / n)
    return ROBOT_SECOND * n * (learning + duration) * (0.1 / period)
