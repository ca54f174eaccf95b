"""Signals that end a command: Ctrl-C, and those of batch systems and closed terminals."""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Final

_Handler = Callable[[int, FrameType | None], None]

_ENDING: Final = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


@contextmanager
def signals_as_interrupts(arrived: list[signal.Signals]) -> Iterator[None]:
    """Raise `KeyboardInterrupt` with the signal's name for each signal, and add the signal to a list.

    Signals may arrive at any moment, so the beginning and the end of this context can raise, too.
    """

    def interrupt(number: int, _frame: FrameType | None) -> None:
        arrived.append(signal.Signals(number))
        raise KeyboardInterrupt(arrived[-1].name)

    with _handle(interrupt):
        yield


@contextmanager
def deferred_signals(notify: Callable[[], None] = lambda: None) -> Iterator[None]:
    """Defer signals to the end of the context, so that none of them interrupts it; call `notify` at once."""
    arrived: list[int] = []

    def note(number: int, _frame: FrameType | None) -> None:
        arrived.append(number)
        notify()

    with _handle(note):
        yield
    if arrived:
        signal.raise_signal(arrived[0])


@contextmanager
def _handle(handler: _Handler) -> Iterator[None]:
    """Install a handler of the signals. Ignored signals stay ignored: ``nohup`` ignores SIGHUP.

    Only the main thread handles signals; in another thread, this does nothing.
    """
    before = {}
    if threading.current_thread() is threading.main_thread():
        before = {number: signal.getsignal(number) for number in _ENDING}
    kept = (signal.SIG_IGN, None)  # None: a handler that was not installed from Python
    replaced = {number: old for number, old in before.items() if old not in kept}
    try:
        for number in replaced:
            signal.signal(number, handler)
        yield
    finally:
        for number, old in replaced.items():
            signal.signal(number, old)
