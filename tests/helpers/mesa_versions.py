"""Differences between the versions of Mesa, for tests of what it reports."""

import inspect
from collections.abc import Sequence
from typing import Any, Final

import mesa

HAS_RNG: Final = "rng" in inspect.signature(mesa.batch_run).parameters
"""Whether this is Mesa 3.5, which labels samples with their times and repeats runs with `rng`."""


def sample_labels(times: Sequence[float]) -> list[Any]:
    """Return the labels (``Step``) of samples at some times (s)."""
    return list(times) if HAS_RNG else list(range(len(times)))


def repetitions(number: int) -> dict[str, Any]:
    """Return the argument of `mesa.batch_run` that repeats each run."""
    return {"rng": [None] * number} if HAS_RNG else {"iterations": number}
