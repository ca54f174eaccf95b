"""Events of the model on SimPy's clock, and their order at one instant."""

import gc
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Final

from simpy.events import Event

from kswarms.agents.robot.clock import Clock

BEFORE_TIMEOUTS: Final = 0
"""SimPy priority of samples and of the end of the game; timeouts have priority 1."""
AFTER_TIMEOUTS: Final = 2
"""SimPy priority of the motion process."""


class Instant(Event):
    """Reusable event with an explicit priority, `BEFORE_TIMEOUTS` or `AFTER_TIMEOUTS`.

    `time` is the time at which it was scheduled last (periods).
    """

    env: Clock

    def __init__(self, env: Clock, priority: int, callback: Callable[[Event], None]) -> None:
        super().__init__(env)
        self._ok = True
        self._value = None
        self._priority = priority
        self._callbacks = [callback]  # SimPy drops the list from the event, but does not change it
        self.time = 0

    def schedule_at(self, time: int) -> None:
        """Schedule the event at a time (periods), not in the past; it must not be scheduled already."""
        self.time = time
        self.callbacks = self._callbacks
        clock = self.env
        clock.push(clock.queue, (time, self._priority, next(clock.order), self))


@contextmanager
def rare_garbage_collection(objects: int) -> Iterator[None]:
    """Collect cyclic garbage only after the number of objects has grown by `objects`.

    Nearly all objects of a game live until its end. Searching them for garbage at the default threshold takes
    half of the time of a large game.
    """
    before = gc.get_threshold()
    if before[0] > 0:  # 0 turns automatic collection off
        gc.set_threshold(max(before[0], objects), *before[1:])
    try:
        yield
    finally:
        gc.set_threshold(*before)
