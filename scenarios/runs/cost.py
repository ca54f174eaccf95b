"""Estimate of the CPU time of a run."""

from typing import Final

ROBOT_SECOND: Final = 5e-6
"""CPU time per robot and second of play, at a control period of 0.1 s (s)."""
ROBOT_SECONDS_PER_PUCK: Final = 300.0
"""Play per puck, in games that end at a number of pucks (robot-seconds)."""


def cpu_seconds(n: int, learning: float, duration: float, puck_limit: int | None, period: float) -> float:
    """Estimate the CPU time of a run (s): proportional to robots × seconds of play.

    Parameters
    ----------
    n : int
        Robots in all.
    learning, duration : float
        Durations of the learning and of the measured game (s).
    puck_limit : int, optional
        Number of pucks that ends the game.
    period : float
        Control period (s).
    """
    if puck_limit is not None:
        duration = min(duration, puck_limit * ROBOT_SECONDS_PER_PUCK / n)
    return ROBOT_SECOND * n * (learning + duration) * (0.1 / period)
