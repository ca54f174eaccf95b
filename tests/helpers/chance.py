"""Random samples of a known distribution, and a test of counts."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy import stats


def normal_samples(count: int, seeds: int, mean: float = 0.0) -> Iterator[NDArray[np.float64]]:
    draws = np.random.default_rng(0)
    for _ in range(count):
        yield draws.normal(loc=mean, size=seeds)


def is_plausible(share: float, hits: int, count: int, slack: float = 0.0) -> bool:
    """Return whether `hits` of `count` agree with `share` ± `slack` (binomial, 99.9 %)."""
    low, _ = stats.binom.interval(0.999, count, share - slack)
    _, high = stats.binom.interval(0.999, count, min(1.0, share + slack))
    return bool(low <= hits <= high)
