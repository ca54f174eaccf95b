"""The clock: SimPy's environment, in control periods."""

import heapq
from collections import defaultdict
from collections.abc import Iterator
from heapq import heappush
from typing import Any

import simpy
from simpy.core import SimTime
from simpy.events import Event

Queue = list[Any]
"""A heap of entries, each of which consists of a time, a priority, a number and an event."""


class Clock(simpy.Environment):
    """SimPy's environment, with less work for the timers of robots.

    Many timers end at the same instant. Sorting all of them into one queue would take as long as their
    effects. An instant after the next waking of the motion process therefore has a queue of its own, which
    becomes a part of SimPy's queue when this waking is scheduled. The order of the events is that of SimPy.

    Attributes
    ----------
    queue : list
        SimPy's queue. ``push(queue, (time, priority, next(order), event))`` is the same as
        ``schedule(event, priority, time - now)``.
    later : dict of int to list
        The queue of each instant after the next waking, for the same use; `queue_of` has those of all times.
    order : iterator of int
        Numbers of events.
    """

    def __init__(self) -> None:
        super().__init__()
        self.queue: Queue = self._queue
        self.later: defaultdict[int, Queue] = defaultdict(list)
        self._waking = 0  # time of the next waking of the motion process
        self.order: Iterator[int] = self._eid
        self.push = heappush
        self._due: Queue | None = None  # timers of the next waking while `_steps` is active

    def queue_of(self, time: int) -> Queue:
        """Return the queue of an instant."""
        return self.later[time] if time > self._waking else self.queue

    def release(self, time: int) -> None:
        """Move the queue of `time`, the next waking of the motion process, to SimPy's queue."""
        self._waking = time
        entries = self.later.pop(time, None)
        if entries is not None:
            if self._due is None:
                self._take(entries)
            else:
                self._due = entries

    def release_all(self) -> None:
        """Move the queues of all instants to SimPy's queue."""
        for time in sorted(self.later):
            self.release(time)

    def run(self, until: SimTime | Event | None = None) -> Any:
        """Run as SimPy's environment does. Each event is processed by `step` only if `step` was replaced."""
        if "step" in vars(self):
            return super().run(until)
        self.step, self._due = self._steps, []  # type: ignore[method-assign]
        try:
            return super().run(until)
        finally:
            del self.step
            entries, self._due = self._due, None
            self._take(entries)

    def _steps(self) -> None:
        """Process events until one of them stops the simulation."""
        queue, step = self._queue, super().step
        while True:
            entries = self._due
            if entries:
                self._due = []
                if queue[0] > entries[-1]:  # the timers come first: the same as `step` for each
                    self._now = entries[0][0]
                    for _, _, _, timer in entries:
                        callbacks, timer.callbacks = timer.callbacks, None
                        for callback in callbacks:
                            callback(timer)
                else:
                    self._take(entries)
            step()

    def _take(self, entries: Queue) -> None:
        for entry in entries:
            heapq.heappush(self._queue, entry)  # `push` is for new events
