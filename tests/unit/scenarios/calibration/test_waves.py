"""Waves on a toy model whose compatible region is known."""

from collections import Counter

import numpy as np
import pytest

from kswarms.agents.common.arrays import Floats
from kswarms.agents.common.errors import InputError
from kswarms.scenarios.calibration.waves import Sampling, Wave, sample

CENTRE, HALF = np.array([0.3, 0.75]), np.array([0.1, 0.05])
"""Two stages, each met in an interval of one coordinate. The compatible region is a rectangle in a cube."""
NOISE = 0.01


def play(positions: Floats, wave: int, stage: int) -> Floats:
    """Two noisy outputs; the second does not matter."""
    noise = np.random.default_rng((wave, stage)).normal(scale=NOISE, size=(len(positions), 2))
    return np.column_stack([positions[:, stage - 1], positions[:, 2]]) + noise


def judge_of(stage: int) -> object:
    return lambda outputs: np.abs(outputs[:, :1] - CENTRE[stage - 1]) / HALF[stage - 1]


STAGES = [judge_of(1), judge_of(2)]


def waves_of(settings: Sampling, seen: Counter[tuple[int, int]] | None = None) -> list[Wave]:
    def count(positions: Floats, wave: int, stage: int) -> Floats:
        if seen is not None:
            seen[wave, stage] += len(positions)
        return play(positions, wave, stage)

    return list(sample(3, count, STAGES, settings))  # type: ignore[arg-type]


def test_compatible_positions_cover_the_known_region_evenly() -> None:
    *_, last = waves_of(Sampling(size=500, tries=300, waves=4))
    compatible = last.positions[last.implausibility.max(axis=1) <= 1]
    assert len(compatible) > 200
    region = compatible[:, :2] - CENTRE
    assert (np.abs(region) <= HALF + 5 * NOISE).all()
    uniform = HALF / np.sqrt(3)
    assert (np.abs(region.mean(axis=0)) < 4 * uniform / np.sqrt(len(compatible)) + NOISE).all()
    assert region.std(axis=0) == pytest.approx(uniform, rel=0.2)
    # The third coordinate does not matter, so it keeps its prior.
    assert compatible[:, 2].mean() == pytest.approx(0.5, abs=0.05)
    assert compatible[:, 2].std() == pytest.approx(1 / np.sqrt(12), rel=0.1)


def test_a_wave_that_has_learned_plays_mostly_compatible_positions() -> None:
    first, second, *_ = waves_of(Sampling(size=10_000, tries=100, waves=2))
    shares = [(wave.implausibility.max(axis=1) <= 1).sum() / 100 for wave in (first, second)]
    assert shares[0] < 0.1  # the region has 1 / 50 of the volume
    assert shares[1] > 0.7


def test_the_sample_ends_with_enough_compatible_positions_or_at_the_last_wave() -> None:
    waves = waves_of(Sampling(size=60, tries=64, waves=20))
    found = [int((wave.implausibility.max(axis=1) <= 1).sum()) for wave in waves]
    assert sum(found) >= 60 > sum(found[:-1])
    assert len(waves) < 5
    assert len(waves_of(Sampling(size=10_000, tries=16, waves=3))) == 3


def test_a_position_far_from_the_targets_of_a_stage_plays_no_games_of_the_next() -> None:
    seen: Counter[tuple[int, int]] = Counter()
    waves = waves_of(Sampling(size=10_000, tries=64, waves=2, factor=1.5), seen)
    for number, wave in enumerate(waves):
        assert wave.passed == (64, seen[number, 2], len(wave.positions))
        assert seen[number, 1] == 64
        assert wave.implausibility.shape == (len(wave.positions), 2)
        assert wave.implausibility.max() <= 1.5 * (1 if number else 2)
    assert 64 > seen[0, 2] > 0


def test_without_a_known_position_near_the_targets_the_nearest_are_played() -> None:
    def far(positions: Floats, wave: int, stage: int) -> Floats:
        return positions[:, :1]

    waves = list(
        sample(1, far, [lambda outputs: 1 + 10 * outputs], Sampling(size=10, tries=4, waves=3, factor=100))
    )
    assert [wave.passed[0] for wave in waves] == [4, 4, 4]
    assert waves[0].positions.max() > 0.1
    assert waves[2].positions.max() <= waves[0].positions.min()


def test_the_waves_are_the_same_each_time() -> None:
    settings = Sampling(size=10_000, tries=32, waves=3)
    for one, other in zip(waves_of(settings), waves_of(settings), strict=True):
        assert one.positions.tobytes() == other.positions.tobytes()
        assert one.implausibility.tobytes() == other.implausibility.tobytes()


@pytest.mark.parametrize(("field", "value"), [("size", 1), ("tries", 1), ("waves", 0), ("factor", 0.9)])
def test_values_out_of_range_are_refused(field: str, value: float) -> None:
    with pytest.raises(InputError, match=f"^{field}={value}: must be greater than or equal to"):
        Sampling(**{field: value})
