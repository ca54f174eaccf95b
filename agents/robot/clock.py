"""The clock: SimPy's environment, in control periods."""

from collections.abc import Callable, Iterator
from functools import partial
from heapq import heappush

import simpy
from simpy.events import Event


class Clock(simpy.Environment):
    """SimPy's environment; `push` schedules an event without the call of a Python function.

    ``push((time, NORMAL, next(order), event))`` is the same as ``schedule(event, NORMAL, time - now)``.
    """

    def __init__(self) -> None:
        super().__init__()
        self.push: Callable[[tuple[float, int, int, Event]], None] = partial(heappush, self._queue)
        self.order: Iterator[int] = self._eid
