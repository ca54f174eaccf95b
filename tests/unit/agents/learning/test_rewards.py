"""Rewards compared with values computed by hand (Eqs. 5.4, 5.5, 6.2, 6.3, 7.1, 7.2, section 6.3.5)."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kswarms.agents.actions import AWAY, TOWARDS
from kswarms.agents.common.errors import InputError
from kswarms.agents.learning.rewards import WLU, IndividualUtility, Reward, SingleSwarmWLU
from kswarms.agents.theory.estimates import sigma

SECONDS = st.floats(0, 600)
ACTIVE = st.integers(0, 8)
CASES = [(inter, direction) for inter in (True, False) for direction in (TOWARDS, AWAY)]
SIGNS = {(True, TOWARDS): +1, (True, AWAY): -1, (False, TOWARDS): -1, (False, AWAY): +1}


def of(
    reward: Reward,
    t_a: float,
    t_p: float,
    n_active: int = 8,
    direction: int = TOWARDS,
    inter: bool = True,
    opponent: int = 1,
) -> float:
    return reward.of(t_a, t_p, n_active, direction, inter, opponent)


@pytest.mark.parametrize(("case", "sign"), SIGNS.items())
def test_the_sign_of_equation_5_5(case: tuple[bool, int], sign: int) -> None:
    assert sigma(*case) == sign


@pytest.mark.parametrize(
    ("inter", "direction", "expected"),
    # T(p) = 5 s, half of the sensors active, Δ = 1/8, T(a) = 2 s: 5 ± 4/8 · 1/8 · 2.
    [(True, TOWARDS, 5.125), (True, AWAY, 4.875), (False, TOWARDS, 4.875), (False, AWAY, 5.125)],
)
def test_wlu_of_identical_swarms(inter: bool, direction: int, expected: float) -> None:
    assert of(WLU(), t_a=2.0, t_p=5.0, n_active=4, direction=direction, inter=inter) == expected
    assert WLU() == WLU(delta=0.125, b=1.0)


@pytest.mark.parametrize(("n_active", "expected"), [(0, 0.0), (1, 0.05), (3, 0.15), (8, 0.4)])
def test_wlu_counts_the_active_sensors_of_eight(n_active: int, expected: float) -> None:
    # n'/8 · 0.2 · 2 s
    assert of(WLU(delta=0.2), t_a=2.0, t_p=0.0, n_active=n_active) == pytest.approx(expected, abs=1e-15)


def test_wlu_of_the_disadvantaged_is_eleven_twelfths_of_the_program() -> None:
    reward = WLU(delta=0.145, b=7 / 6)
    assert of(reward, t_a=0.0, t_p=12.0) == pytest.approx(11.0, abs=1e-12)
    # 11/12 · 6 − 8/8 · 0.145 · 2; the term of the action has no b.
    assert of(reward, t_a=2.0, t_p=6.0, direction=AWAY) == pytest.approx(5.21, abs=1e-12)


@given(st.floats(0.1, 2.9), st.integers(1, 40), SECONDS)
def test_the_estimated_wlu_is_exact_for_equal_numbers_met(b: float, each: int, t_p: float) -> None:
    exact = (each + (2 - b) * each) / (2 * each) * t_p  # Eq. 7.1 with n_k = n_m
    assert of(WLU(b=b), t_a=0.0, t_p=t_p) == pytest.approx(exact, abs=1e-9)


@given(SECONDS, SECONDS, ACTIVE, st.sampled_from(CASES), st.floats(0, 1), st.floats(0.1, 2.9))
def test_wlu_is_linear_in_both_times(
    t_a: float, t_p: float, n_active: int, case: tuple[bool, int], delta: float, b: float
) -> None:
    reward = WLU(delta=delta, b=b)
    expected = (3 - b) / 2 * t_p + n_active / 8 * SIGNS[case] * delta * t_a
    inter, direction = case
    assert of(reward, t_a, t_p, n_active, direction, inter) == pytest.approx(expected, abs=1e-9)


def test_each_opponent_can_have_its_own_delta_and_advantage() -> None:
    reward = WLU(delta={1: 0.02, 3: 0.5}, b={3: 2.0})
    assert of(reward, t_a=10.0, t_p=0.0, opponent=1) == pytest.approx(0.2)
    assert of(reward, t_a=10.0, t_p=0.0, opponent=2) == pytest.approx(1.25)  # not named: 0.125
    assert of(reward, t_a=10.0, t_p=0.0, opponent=3) == pytest.approx(5.0)
    assert [of(reward, t_a=0.0, t_p=8.0, opponent=m) for m in (1, 2, 3)] == [8.0, 8.0, 4.0]


def test_a_number_for_delta_or_b_holds_for_all_opponents() -> None:
    reward = WLU(delta=1, b=2)  # whole numbers are numbers too
    assert {of(reward, t_a=1.0, t_p=4.0, opponent=m) for m in range(1, 9)} == {3.0}


@pytest.mark.parametrize(("inter", "direction"), CASES)
def test_individual_utility_does_not_depend_on_the_sign(inter: bool, direction: int) -> None:
    # 2/8 · 6 − 2/8 · 0.125 · 4
    assert of(IndividualUtility(), 4.0, 6.0, 2, direction, inter) == 1.375
    assert of(IndividualUtility(delta=0.5), 4.0, 6.0, 2, direction, inter) == 1.0


@given(SECONDS, SECONDS, ACTIVE, st.floats(0, 1))
def test_individual_utility_with_the_constant_half(
    t_a: float, t_p: float, n_active: int, delta: float
) -> None:
    half = IndividualUtility(delta=delta, half=True)
    assert of(half, t_a, t_p, n_active) == pytest.approx(0.5 * t_p - 0.5 * delta * t_a, abs=1e-9)
    eighths = IndividualUtility(delta=delta)
    assert of(eighths, t_a, t_p, 4) == pytest.approx(of(half, t_a, t_p, n_active), abs=1e-9)


@pytest.mark.parametrize("direction", [TOWARDS, AWAY])
def test_wlu_of_a_single_swarm(direction: int) -> None:
    # 4/8 · (5 − 3 · 2), whatever the action
    assert of(SingleSwarmWLU(), 2.0, 5.0, 4, direction, inter=False) == -0.5
    assert SingleSwarmWLU() == SingleSwarmWLU(kappa=3.0)
    # κ = (α + ᾱ + β)/β of α = ᾱ = 2β
    assert of(SingleSwarmWLU(kappa=5.0), 2.0, 5.0, 4, direction, inter=False) == -2.5


OUT_OF_RANGE = {
    (WLU, "delta"): (-0.001, 1.001),
    (WLU, "b"): (0.0, 3.0),
    (IndividualUtility, "delta"): (-0.001, 1.001, {1: 0.1}),
    (IndividualUtility, "half"): (0.7,),
    (SingleSwarmWLU, "kappa"): (-0.001,),
}


@pytest.mark.parametrize(("argument", "values"), OUT_OF_RANGE.items())
def test_values_out_of_range_are_refused(
    argument: tuple[type[Reward], str], values: tuple[object, ...]
) -> None:
    reward, field = argument
    for value in values:
        with pytest.raises(InputError, match="must be") as caught:
            reward(**{field: value})
        assert (caught.value.field, caught.value.value) == (field, value)


@pytest.mark.parametrize("field", ["delta", "b"])
@pytest.mark.parametrize(
    ("value", "allowed"),
    [(5.0, "less than"), (-1.0, "greater than"), (float("nan"), "finite"), ("much", "valid number")],
)
def test_values_out_of_range_for_one_opponent_are_refused(field: str, value: object, allowed: str) -> None:
    with pytest.raises(InputError) as caught:
        WLU(**{field: {1: 0.1, 3: value}})
    assert caught.value.field.startswith(field)
    assert repr(value) in str(caught.value)
    assert allowed in caught.value.allowed


@given(SECONDS, SECONDS, ACTIVE, st.sampled_from(CASES), st.integers(1, 3))
def test_the_weights_give_the_same_reward(
    t_a: float, t_p: float, n_active: int, case: tuple[bool, int], opponent: int
) -> None:
    inter, direction = case
    reward = WLU(delta={1: 0.3}, b={2: 0.7})
    weights = reward.linear_weights(direction, inter, opponent)
    assert weights is not None
    expected = reward.of(t_a, t_p, n_active, direction, inter, opponent)
    assert weights[0] * t_p + weights[1][n_active] * t_a == expected


def test_a_subclass_with_its_own_reward_has_no_weights() -> None:
    class Doubled(WLU):
        def of(
            self, t_a: float, t_p: float, n_active: int, direction: int, inter: bool, opponent: int
        ) -> float:
            return 2.0 * super().of(t_a, t_p, n_active, direction, inter, opponent)

    assert Doubled().linear_weights(TOWARDS, True, 1) is None
    assert WLU().linear_weights(TOWARDS, True, 1) is not None
    assert IndividualUtility().linear_weights(TOWARDS, True, 1) is None
