"""The model's own events on SimPy's clock, and their place among the events of one instant."""

from collections.abc import Callable
from typing import Final

import simpy
from simpy.events import Event

BEFORE_TIMEOUTS: Final = 0
"""SimPy priority of the end of the game, as of the ends of `Environment.run`; timeouts have 1."""
AFTER_TIMEOUTS: Final = 2
"""SimPy priority of the motion process."""


class Instant(Event):
    """An event that only happens, at a given priority among the events of its instant, and may do so again.

    Parameters
    ----------
    env : simpy.Environment
        The clock.
    priority : int
        0 comes before timeouts, 2 after them.
    callback : callable
        What is called with the event.
    """

    def __init__(self, env: simpy.Environment, priority: int, callback: Callable[[Event], None]) -> None:
        super().__init__(env)
        self._ok = True
        self._value = None
        self._priority = priority
        self._callback = callback

    def happen_in(self, delay: int) -> None:
        """Schedule it, `delay` periods from now; it must have happened if it was scheduled before."""
        self.callbacks = [self._callback]
        self.env.schedule(self, self._priority, delay)  # type: ignore[arg-type]  # SimPy names only two of them
