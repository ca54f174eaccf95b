"""Profile of games: CPU time by phase, and the time of the kernel by function.

Run ``python -m benchmarks.profile``. Phases are sampled: a timer interrupts the process at equal intervals of
CPU time, and the call stack of Python tells the phase. The functions of the kernel are measured by the
processor's cycle counter: `advance` is compiled again with a counter around each function that takes arrays
of the game. Both use the present code of the package.
"""

import inspect
import signal
import time
import types
from collections import Counter
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, Final

import numba
import numpy as np
from llvmlite import ir
from numba.core import types as numba_types
from numba.extending import intrinsic

from benchmarks.bench import print_table
from benchmarks.games import Plan
from kswarms.agents.robot import state
from kswarms.model.kernel import arrays, kernel

PLANS: Final = (Plan("avoid,attack", 50), Plan("attack,inter-learner", 50, learning=3000.0))
_INT: Final = ir.IntType(64)
_CLOCK: Final = "kswarms.agents.robot.clock"
"""Module with the loop of SimPy's environment."""
_EVERY: Final = 0.001
"""Least interval between two samples (s of CPU time); the operating system may make it longer."""


def phase_of(stack: Sequence[tuple[str, str]]) -> str:
    """Return the phase of a call stack: module and function of each frame, the innermost first."""
    functions = [function for _, function in stack]
    module = stack[0][0]
    if "play" not in functions:
        return "set-up"
    stack = [frame for frame in stack if frame[0] != _CLOCK]
    if module == _CLOCK or module.startswith("simpy"):
        inside = any(name.startswith("kswarms.agents") for name, _ in stack)
        return "SimPy: calls by robots" if inside else "SimPy: loop"
    if any(name.startswith(("kswarms.agents.learning", "kswarms.agents.policies")) for name, _ in stack):
        return "learning and policies"
    if "_decide" in functions:
        place = functions.index("_decide")
        return f"decision: {functions[place - 1].strip('_') if place else 'dispatch'}"
    # The robot's function that SimPy calls at the end of a timeout is the outermost one of `agents`.
    robots = [function for name, function in stack if name.startswith("kswarms.agents")]
    if robots:
        return f"timeout: {robots[-1].strip('_')}"
    return "kernel" if module.startswith("kswarms.model") else "other"


@contextmanager
def sampling(samples: Counter[str]) -> Iterator[None]:
    """Count samples by phase in the context."""

    def take(_: int, frame: types.FrameType | None) -> None:
        stack = []
        while frame is not None:
            stack.append((frame.f_globals.get("__name__", ""), frame.f_code.co_name))
            frame = frame.f_back
        samples[phase_of(stack)] += 1

    previous = signal.signal(signal.SIGPROF, take)
    signal.setitimer(signal.ITIMER_PROF, _EVERY, _EVERY)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, previous)


def phases(plan: Plan, seeds: Sequence[int], seconds: float) -> list[list[str]]:
    """Play games for some CPU time; return rows: phase, CPU time of a game (ms), share (%)."""
    samples: Counter[str] = Counter()
    games, start = 0, time.process_time()
    with sampling(samples):
        while time.process_time() < start + seconds:
            plan.model(seeds[games % len(seeds)]).play()
            games += 1
    total = 1e3 * (time.process_time() - start) / games
    rows = [
        [phase, f"{total * count / samples.total():.1f}", f"{100 * count / samples.total():.1f}"]
        for phase, count in samples.most_common()
    ]
    return [*rows, ["sum", f"{total:.1f}", "100.0"]]


@intrinsic  # type: ignore[untyped-decorator]
def _cycles(_: Any) -> Any:
    """Return the cycle counter of the processor."""

    def generate(_: Any, builder: Any, *__: Any) -> Any:
        name = "llvm.readcyclecounter"
        known = builder.module.globals.get(name)
        return builder.call(known or ir.Function(builder.module, ir.FunctionType(_INT, []), name), [])

    return numba_types.int64(), generate


@intrinsic  # type: ignore[untyped-decorator]
def _exchange(_: Any, address: Any, value: Any) -> Any:
    """Write a number to an address and return the number that was there."""

    def generate(_: Any, builder: Any, __: Any, values: Any) -> Any:
        place = builder.inttoptr(values[0], _INT.as_pointer())
        before = builder.load(place)
        builder.store(values[1], place)
        return before

    return numba_types.int64(numba_types.int64, numba_types.int64), generate


class CycleCounter:
    """A compiled function, compiled again with counters around the functions that it calls.

    Parameters
    ----------
    function : callable
        Function compiled with numba.
    kinds : collection of type
        Functions with a parameter of these types are counted, and no others.

    Attributes
    ----------
    names : list of str
        Counted functions.
    function : callable
        The function with counters.
    """

    def __init__(self, function: Any, kinds: Collection[type]) -> None:
        self._root = function
        self._kinds = kinds
        self._made: dict[Any, Any] = {}
        self.names: list[str] = []
        self._counts = np.zeros(200, dtype=np.int64)
        """Cycles of called functions, then cycles and calls of each counted function."""
        self.function = self._instrument(function)

    @property
    def cycles(self) -> Any:
        """Cycles of each function, without those of the counted functions that it calls."""
        return self._counts[1 : 2 * len(self.names) : 2]

    @property
    def calls(self) -> Any:
        """Calls of each function."""
        return self._counts[2 : 2 * len(self.names) + 1 : 2]

    def _instrument(self, function: Any) -> Any:
        """Compile a function, and the compiled functions that it calls, with counters."""
        if function not in self._made:
            source = function.py_func
            callees = {
                key: self._instrument(value)
                for key, value in source.__globals__.items()
                if key in source.__code__.co_names and hasattr(value, "py_func")
            }
            clone = types.FunctionType(source.__code__, {**source.__globals__, **callees}, source.__name__)
            compiled = self._compile(clone)
            kinds = [parameter.annotation for parameter in inspect.signature(source).parameters.values()]
            # The machine code of a function with `*arguments` cannot be called with separate arguments.
            if function is not self._root and any(kind in self._kinds for kind in kinds):
                self.names.append(f"{source.__module__.rpartition('.')[2]}.{source.__name__}")
                compiled = self._count(compiled, 2 * len(self.names) - 1)
            self._made[function] = compiled
        return self._made[function]

    def _count(self, function: Any, place: int) -> Any:
        inner, cycles, calls = (self._counts.ctypes.data + 8 * k for k in (0, place, place + 1))

        def counted(*arguments: Any) -> Any:
            before = _exchange(inner, 0)
            start = _cycles()
            result = function(*arguments)
            passed = _cycles() - start
            own = passed - _exchange(inner, before + passed)
            _exchange(cycles, own + _exchange(cycles, 0))
            _exchange(calls, 1 + _exchange(calls, 0))
            return result

        return self._compile(counted)

    @staticmethod
    def _compile(function: Callable[..., Any]) -> Any:
        return numba.njit(error_model="numpy", _nrt=False)(function)  # type: ignore[call-overload]


def kernel_functions(counter: CycleCounter, plan: Plan, repetitions: int) -> list[list[str]]:
    """Play a game with counters; return rows: function, calls, share of the kernel's cycles (%).

    The repetition with the fewest cycles counts: the cycles of other processes are counted, too.
    """
    original = kernel.advance
    kernel.advance = counter.function
    try:
        counts = []
        for _ in range(repetitions):
            model = plan.model(0)
            counter.cycles[:] = 0
            model.play()
            counts.append(counter.cycles.copy())
    finally:
        kernel.advance = original
    cycles = min(counts, key=np.sum)
    calls = counter.calls // repetitions
    order = np.argsort(-cycles)
    return [[counter.names[k], f"{calls[k]:,}", f"{100 * cycles[k] / cycles.sum():.1f}"] for k in order]


def main(seeds: int = 5, seconds: float = 10.0) -> None:
    """Print the profiles of games, sampled for some CPU time each."""
    counter = CycleCounter(kernel.advance, (arrays.Memory, arrays.Work, arrays.Pairs, state.Bodies))
    for plan in PLANS:
        plan.model(0).play()  # loads the compiled code
        what = f"{plan.policies.replace(',', ' / ')}, N = {plan.n}"
        rows = phases(plan, range(seeds), seconds)
        note = "kernel: with the loop that calls it"
        print_table(f"CPU time of a game by phase: {what}", ["phase", "ms", "%"], rows, note)
        counter.calls[:] = 0
        rows = kernel_functions(counter, plan, 5)
        note = "without the functions of this table that it calls"
        print_table(f"Kernel by function: {what}", ["function", "calls", "%"], rows, note)


if __name__ == "__main__":
    main()
