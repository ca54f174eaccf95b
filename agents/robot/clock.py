"""The clock: SimPy's environment, in control periods."""

from collections.abc import Callable, Iterator
from functools import partial
from heapq import heappush

import simpy
from simpy.events import Event


class Clock(simpy.Environment):
    """SimPy's environment, with access to its queue that saves calls of Python functions.

    ``push((time, NORMAL, next(order), event))`` is the same as ``schedule(event, NORMAL, time - now)``, and
    ``queue[0][0]`` is the same as ``peek()`` while an event is scheduled.
    """

    def __init__(self) -> None:
        super().__init__()
        self.queue = self._queue
        self.push: Callable[[tuple[float, int, int, Event]], None] = partial(heappush, self._queue)
        self.order: Iterator[int] = self._eid
