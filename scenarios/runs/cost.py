"""What a run costs, roughly: it tells long runs from short ones, and how long a study will take."""

from typing import Final

ROBOT_SECOND: Final = 5e-6
"""CPU time of a robot and second of play, at a control period of 0.1 s (s)."""
PUCK: Final = 300.0
"""Robot-seconds in which a puck is gathered."""


def cpu_seconds(n: int, learning: float, duration: float, puck_limit: int | None, period: float) -> float:
    """Estimate the CPU time of a run (s): proportional to robots × seconds played.

    Parameters
    ----------
    n : int
        Robots in all.
    learning, duration : float
        Of the game (s).
    puck_limit : int, optional
        Pucks that end the game; then it is taken to last as long as they take.
    period : float
        Control period (s).
    """
    if puck_limit is not None:
        duration = min(duration, puck_limit * PUCK / n)
    return ROBOT_SECOND * n * (learning + duration) * (0.1 / period)
