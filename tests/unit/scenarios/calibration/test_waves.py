"""Waves on a toy model whose posterior is known."""

import itertools
from collections import Counter

import numpy as np
import pytest

from kswarms.agents.common.arrays import Floats
from kswarms.agents.common.errors import InputError
from kswarms.scenarios.calibration.waves import Sampling, Wave, sample

CENTRE, HALF = np.array([0.3, 0.75]), np.array([0.1, 0.05])
"""Two stages, each met in an interval of one coordinate. The posterior is uniform in the rectangle."""


def judge(positions: Floats, wave: int, stage: int) -> Floats:
    return np.asarray(np.abs(positions[:, stage - 1] - CENTRE[stage - 1]) / HALF[stage - 1])


def waves_of(settings: Sampling, seen: Counter[int] | None = None) -> list[Wave]:
    def count(positions: Floats, wave: int, stage: int) -> Floats:
        if seen is not None:
            seen[stage] += len(positions)
        return judge(positions, wave, stage)

    return list(sample(2, 2, count, settings))


def test_the_last_wave_has_the_known_posterior() -> None:
    waves = waves_of(Sampling(size=600, batch=256, tries=100_000))
    last = waves[-1]
    assert last.factor == 1.0
    assert len(last.positions) >= 600
    assert (np.abs(last.positions - CENTRE) <= HALF).all()
    assert last.weights.sum() == pytest.approx(1)
    mean = last.weights @ last.positions
    deviation = np.sqrt(last.weights @ (last.positions - mean) ** 2)
    effective = 1 / (last.weights**2).sum()
    assert effective > 300
    uniform = HALF / np.sqrt(3)
    assert (np.abs(mean - CENTRE) < 4 * uniform / np.sqrt(effective)).all()
    assert deviation == pytest.approx(uniform, rel=0.15)


def test_factors_fall_to_1_by_the_median_of_what_was_accepted() -> None:
    waves = waves_of(Sampling(size=40, tries=10_000, factor=4.0))
    assert waves[0].factor == 4.0
    for before, after in itertools.pairwise(waves):
        assert after.factor == max(1.0, float(np.median(before.implausibility)))
        assert before.implausibility.max() <= before.factor
    assert waves[-1].factor == 1.0


def test_a_rejected_position_is_not_judged_at_later_stages() -> None:
    seen: Counter[int] = Counter()
    (wave, *_) = waves_of(Sampling(size=40, tries=10_000, waves=1), seen)
    assert seen == {1: wave.tried, 2: wave.passed[0]}
    assert wave.tried > wave.passed[0] > wave.passed[1] == len(wave.positions)
    both = [judge(wave.positions, 0, stage) for stage in (1, 2)]
    assert wave.implausibility == pytest.approx(np.maximum(*both))


def test_the_waves_are_the_same_each_time() -> None:
    settings = Sampling(size=20, tries=5000)
    for one, other in zip(waves_of(settings), waves_of(settings), strict=True):
        assert one.positions.tobytes() == other.positions.tobytes()
        assert one.weights.tobytes() == other.weights.tobytes()


def test_too_few_positions_end_the_sample() -> None:
    (wave,) = waves_of(Sampling(size=40, batch=8, tries=20, factor=1.0))
    assert wave.tried == 20
    assert len(wave.positions) < 40


@pytest.mark.parametrize(
    ("field", "value"), [("size", 1), ("batch", 0), ("tries", 1), ("waves", 0), ("factor", 0.9)]
)
def test_values_out_of_range_are_refused(field: str, value: float) -> None:
    with pytest.raises(InputError, match=f"^{field}={value}: must be greater than or equal to"):
        Sampling(**{field: value})
