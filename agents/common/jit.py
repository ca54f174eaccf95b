"""The decorator of every compiled function, and what keeps its cache honest.

Numba caches a compiled function, beside its source or where it is told to, and compiles it anew when that one
file changes. A function that was compiled into its caller can change without the caller's file, so all cached
code that is older than any source of the packages with kernels is dropped on import.
"""

import contextlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

from numba import njit

_Function = TypeVar("_Function", bound=Callable[..., Any])


def compiled(function: _Function) -> _Function:
    """Compile a function of numbers and arrays with numba, and cache the machine code on disk.

    Division by zero gives infinities and NaN as in numpy; nothing else about floating point is relaxed. A
    compiled function allocates nothing, so that numba need not count who holds which array: counting took a
    tenth of a game.
    """
    compile_it = njit(cache=True, error_model="numpy", _nrt=False)(function)  # type: ignore[call-overload]  # not in its stubs
    _drop_stale_code(Path(compile_it._cache.cache_path))
    return cast(_Function, compile_it)


@cache
def _drop_stale_code(directory: Path) -> None:
    """Drop what is cached in a directory of numba's, once in a process."""
    root = Path(__file__).resolve().parents[2]
    sources = [path for package in ("agents", "model") for path in (root / package).rglob("*.py")]
    newest = max(path.stat().st_mtime for path in sources)
    for cached in directory.glob("*.nb[ic]"):
        # Another process may drop it first, or the installation be read-only.
        with contextlib.suppress(OSError):
            if cached.stat().st_mtime < newest:
                cached.unlink()
