"""The result of a run: its outcome or its failure."""

import platform
import traceback
from dataclasses import dataclass, field
from functools import cache
from importlib import metadata
from typing import Any, Self

from kswarms.scenarios.runs.run import Run


@cache
def environment() -> str:
    """Return the versions and the machine on which the bytes of results may depend.

    Releases of Python that differ in their last number compute equal numbers. Those of numpy and numba may
    compute others, and so may another kind of processor.
    """
    python = ".".join(platform.python_version_tuple()[:2])
    libraries = [f"{name} {metadata.version(name)}" for name in ("numpy", "numba")]
    return ", ".join((f"Python {python}", *libraries, platform.machine()))


@dataclass(frozen=True)
class Outcome:
    """The results of a game; `kswarms.agents.common.columns` describes the columns."""

    swarms: list[dict[str, Any]]
    """A row of ``runs.parquet`` for each swarm, without the columns from ``run`` to ``seed``."""
    policies: list[dict[str, Any]]
    """Rows of ``policies.parquet``, without the same columns; empty if no swarm learns."""
    records: dict[str, dict[str, Any]]
    """The columns of each recorded table, lists or arrays, by name of the table and of the column."""
    environment: str = field(default_factory=environment)
    """The `environment` of the process that played the run."""


@dataclass(frozen=True)
class Failure:
    """The error of a run in one line, and its traceback (empty if there is none)."""

    error: str
    trace: str = ""

    @classmethod
    def of(cls, error: BaseException) -> Self:
        """Describe an exception."""
        line = " ".join(f"{type(error).__name__}: {error}".split())
        return cls(line, "".join(traceback.format_exception(error)))


Result = tuple[Run, Outcome | Failure, float]
"""A run, its outcome or failure, and its CPU time (s)."""
