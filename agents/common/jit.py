"""Compilation of functions with numba, with a cache on disk.

Numba recompiles a cached function when its source file changes, but not when a called function changes in
another file. Cached code that is older than any source of agents and model is therefore deleted on import.
"""

import contextlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

from numba import njit

_Function = TypeVar("_Function", bound=Callable[..., Any])


def compiled(function: _Function) -> _Function:
    """Compile a function of numbers and arrays with numba and cache the machine code.

    Division by zero gives infinities and NaN as in numpy. Compiled functions must not allocate arrays, since
    numba's reference counting is off, which saves a tenth of a game's time.
    """
    dispatcher = njit(cache=True, error_model="numpy", _nrt=False)(function)  # type: ignore[call-overload]  # not in its stubs
    _delete_stale_code(Path(dispatcher._cache.cache_path))
    return cast(_Function, dispatcher)


@cache
def _delete_stale_code(directory: Path) -> None:
    """Delete stale machine code from a cache directory, once per process."""
    root = Path(__file__).resolve().parents[2]
    sources = [path for package in ("agents", "model") for path in (root / package).rglob("*.py")]
    newest = max(path.stat().st_mtime for path in sources)
    for cached in directory.glob("*.nb[ic]"):
        # Another process may delete it first, or the installation may be read-only.
        with contextlib.suppress(OSError):
            if cached.stat().st_mtime < newest:
                cached.unlink()
