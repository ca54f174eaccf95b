"""Compilation of functions with numba, with a cache on disk.

Numba recompiles a cached function when its source file changes, but not when a called function changes in
another file. The names of cache files therefore contain a digest of everything that machine code depends on:
all sources of agents and model, the versions of Python, numba and numpy, and the processor.
"""

import contextlib
import hashlib
import logging
import multiprocessing
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, Final, TypeVar, cast

import numba
import numpy as np
from llvmlite.binding import get_host_cpu_name
from numba.core.caching import FunctionCache, IndexDataCacheFile
from numba.core.codegen import get_host_cpu_features

_Function = TypeVar("_Function", bound=Callable[..., Any])

_SOURCES: Final = Path(__file__).resolve().parents[2]
_CONFIG: Final[Any] = numba.config
_MAX_FILES: Final = 300
"""Maximum number of cache files in a directory, at least those of five digests; older ones are deleted."""


def compiled(function: _Function) -> _Function:
    """Compile a function of numbers and arrays with numba and cache the machine code.

    Division by zero gives infinities and NaN as in numpy. Compiled functions must not allocate arrays, since
    numba's reference counting is off, which saves a tenth of a game's time. With ``NUMBA_DISABLE_JIT=1`` the
    function stays as it is.
    """
    dispatcher: Any = _dispatcher(function)
    if not _CONFIG.DISABLE_JIT:
        try:
            dispatcher._cache = _Cache(function)
        except RuntimeError:  # numba finds no writable directory
            _warn_uncached()
    return cast(_Function, dispatcher)


def compiled_inner(function: _Function) -> _Function:
    """Compile a function that only compiled functions call; a call from Python ends the process.

    It has neither the code for calls from Python nor a cache, which halves the time of all compilation. It is
    inlined: a call would copy the pointers and lengths of all arrays.
    """
    return _dispatcher(function, no_cpython_wrapper=True, forceinline=True)


def _dispatcher(function: _Function, **options: bool) -> _Function:
    compile_by = numba.njit(error_model="numpy", _nrt=False, no_cfunc_wrapper=True, **options)  # type: ignore[call-overload]  # not in its stubs
    return cast(_Function, compile_by(function))


class _Cache(FunctionCache):
    """Cache of one function. Files that cannot be read or written are the same as missing ones."""

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)  # type: ignore[no-untyped-call]
        name = f"{function.__module__.rpartition('.')[2]}.{function.__qualname__}-{_digest()}"
        self._cache_file = IndexDataCacheFile(self.cache_path, name, _digest())

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return the machine code of a signature, or None."""
        code = None
        try:
            code = super().load_overload(sig, target_context)  # type: ignore[no-untyped-call]
        except Exception:  # noqa: BLE001  # a damaged file raises any error of pickle
            with contextlib.suppress(OSError):
                self.flush()  # type: ignore[no-untyped-call]
        if code is None:
            _announce_compilation()
        return code

    def save_overload(self, sig: Any, data: Any) -> None:
        """Save machine code and delete the oldest files of the directory."""
        try:
            super().save_overload(sig, data)  # type: ignore[no-untyped-call]
        except OSError:
            _warn_uncached()
        with contextlib.suppress(OSError):  # another process may delete the same files
            files = Path(self.cache_path).glob("*.nb[ic]")
            for path in sorted(files, key=lambda path: path.stat().st_mtime, reverse=True)[_MAX_FILES:]:
                path.unlink()


@cache
def _digest() -> str:
    """Return a digest of everything that the machine code depends on."""
    versions = (sys.version, numba.__version__, np.__version__, str(_CONFIG.OPT), _CONFIG.BOUNDSCHECK)
    processor = (_CONFIG.CPU_NAME, _CONFIG.CPU_FEATURES, get_host_cpu_name(), get_host_cpu_features())
    digest = hashlib.sha256(repr((versions, processor)).encode())
    for path in sorted(
        path for package in ("agents", "model") for path in (_SOURCES / package).rglob("*.py")
    ):
        source = path.read_bytes()
        digest.update(f"{path.relative_to(_SOURCES)} {len(source)} ".encode())
        digest.update(source)
    return digest.hexdigest()[:16]


@cache
def _announce_compilation() -> None:
    """Log one line on a terminal, in the main process only."""
    if sys.stderr is not None and sys.stderr.isatty() and multiprocessing.parent_process() is None:
        logging.getLogger(__name__).warning("kswarms: compiling once, for up to half a minute")


@cache
def _warn_uncached() -> None:
    """Log one line, in the main process only."""
    if multiprocessing.parent_process() is None:
        logging.getLogger(__name__).warning(
            "kswarms: no writable directory for machine code, so each process compiles it; "
            "NUMBA_CACHE_DIR can name one"
        )
