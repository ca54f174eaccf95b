"""Comparisons of two samples, on data with known answers."""

import math

import numpy as np
import pytest
from scipy import stats
from statsmodels.stats.power import TTestPower

from kswarms.agents.common.errors import InputError
from kswarms.analysis.statistics import comparisons
from kswarms.analysis.statistics.comparisons import (
    additional_seeds,
    adjust_p_values,
    compare_independent,
    compare_paired,
    effect_size,
)
from kswarms.analysis.statistics.intervals import Interval
from tests.helpers.chance import is_plausible, normal_samples


@pytest.fixture
def _p_values_only(monkeypatch: pytest.MonkeyPatch) -> None:
    """Leave out the interval of a paired comparison, which takes most of its time."""
    monkeypatch.setattr(comparisons, "bootstrap_interval", lambda *_, **_options: Interval(0.0, 0.0, 0.0))


@pytest.mark.slow
@pytest.mark.usefixtures("_p_values_only")
def test_a_true_null_hypothesis_is_rejected_in_about_5_percent_of_cases() -> None:
    # The part that both share cancels in the difference.
    count, draws = 400, np.random.default_rng(1)
    rejected = 0
    for shared in normal_samples(count, seeds=12):
        first, second = shared + draws.normal(size=12), shared + draws.normal(size=12)
        rejected += compare_paired(first, second).p_value <= 0.05
    assert is_plausible(0.05, rejected, count), rejected / count


@pytest.mark.slow
@pytest.mark.usefixtures("_p_values_only")
def test_a_known_effect_is_found_with_the_stated_power() -> None:
    size, seeds, count = 0.8, 14, 300
    power = float(TTestPower().power(effect_size=size, nobs=seeds, alpha=0.05))
    assert 0.7 < power < 0.85
    found = sum(
        compare_paired(sample, np.zeros(seeds)).p_value <= 0.05
        for sample in normal_samples(count, seeds, mean=size)
    )
    assert is_plausible(power, found, count), (found / count, power)


def test_a_paired_comparison_matches_a_calculation_by_hand() -> None:
    first, second = np.array([3.0, 5.0, 4.0, 6.0, 8.0, 7.0]), np.array([2.0, 3.0, 3.0, 4.0, 5.0, 6.0])
    compared, differences = compare_paired(first, second), first - second
    assert compared.seeds == 6
    assert compared.difference.estimate == pytest.approx(differences.mean())
    assert compared.d_z == pytest.approx(differences.mean() / differences.std(ddof=1))
    # Two of the 2⁶ swaps are as extreme.
    assert compared.p_value == pytest.approx(2 / 64)
    assert compared.cliffs_delta == pytest.approx(np.sign(np.subtract.outer(first, second)).mean())
    equal = compare_paired([1.0] * 6, [1.0] * 6)
    assert (equal.p_value, equal.d_z, equal.cliffs_delta) == (1.0, 0.0, 0.0)


def test_a_constant_difference_is_an_infinite_effect() -> None:
    assert effect_size([2.0, 2.0]) == math.inf
    assert effect_size([-2.0, -2.0]) == -math.inf
    assert effect_size([0.0, 0.0]) == 0.0


@pytest.mark.parametrize(
    ("first", "second", "complaint"),
    [
        ([1.0, 2.0], [1.0], r"second=\(1,\): must have the shape \(2,\), one value for each seed"),
        ([[1.0]], [[1.0]], "one value for each seed"),
        ([1.0], [2.0], "seeds=1: must be at least 2"),
    ],
)
def test_invalid_pairs_are_refused(first: list[float], second: list[float], complaint: str) -> None:
    with pytest.raises(InputError, match=complaint):
        compare_paired(first, second)


def test_corrections_match_a_calculation_by_hand() -> None:
    p_values = [0.01, 0.04, 0.03, 0.5]
    assert adjust_p_values(p_values) == pytest.approx([0.04, 0.09, 0.09, 0.5])
    corrected = adjust_p_values(p_values, "benjamini-hochberg")
    assert corrected == pytest.approx([0.04, 4 / 3 * 0.04, 4 / 3 * 0.04, 0.5])
    assert adjust_p_values([]) == []


def test_invalid_p_values_and_methods_are_refused() -> None:
    with pytest.raises(InputError, match=r"p_values=1\.5: must be between 0 and 1"):
        adjust_p_values([0.5, 1.5])
    with pytest.raises(InputError, match="method='none': must be one of holm, benjamini-hochberg"):
        adjust_p_values([0.5], "none")  # type: ignore[arg-type]


@pytest.mark.parametrize("d_z", [0.1, 0.5, 2.0])
def test_the_additional_seeds_have_the_power(d_z: float) -> None:
    sample = next(normal_samples(1, seeds=3))
    sample = (sample - sample.mean()) / sample.std(ddof=1) + d_z
    more = additional_seeds(sample, power=0.8)
    assert more is not None
    powers = [TTestPower().power(d_z, 3 + seeds, 0.05) for seeds in (more - 1, more)]
    assert powers[0] < 0.8 <= powers[1]


def test_additional_seeds_are_0_for_enough_seeds_and_none_without_effect() -> None:
    assert additional_seeds([5.0, 5.1, 4.9, 5.0]) == 0
    assert additional_seeds([5.0, 5.0]) == additional_seeds([50.0, 50.1, 49.9, 50.0], confidence=0.995) == 0
    assert additional_seeds([1.0, -1.0]) is None


def test_an_invalid_power_and_a_single_seed_are_refused() -> None:
    with pytest.raises(InputError, match=r"power=1\.0: must be between 0 and 1"):
        additional_seeds([1.0, 2.0], power=1.0)
    with pytest.raises(InputError, match="seeds=1: must be at least 2"):
        additional_seeds([1.0])


def test_independent_samples_have_welchs_interval() -> None:
    first, second = [20.0, 31.0, 25.0, 28.0], [26.0, 22.0, 24.0]
    expected = stats.ttest_ind(first, second, equal_var=False).confidence_interval(0.9)
    found = compare_independent(first, second, confidence=0.9)
    assert (found.estimate, found.low, found.high) == pytest.approx((2.0, expected.low, expected.high))
    assert compare_independent([3.0] * 3, [1.0] * 2) == Interval(2.0, 2.0, 2.0)
    alone = compare_independent([3.0], [1.0, 2.0])
    assert (alone.estimate, math.isnan(alone.low)) == (1.5, True)
