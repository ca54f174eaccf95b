"""Time utilities and their estimates, against their definitions (sections 1.3, 1.4)."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kswarms.agents.actions import AWAY, TOWARDS
from kswarms.agents.learning.rewards import WLU, IndividualUtility, SingleSwarmWLU
from kswarms.agents.theory import times
from kswarms.agents.theory.estimates import (
    estimated_wlu,
    identical_swarms_wlu,
    kappa,
    program_weight,
    program_weight_of_equals,
    sigma,
)
from kswarms.agents.theory.swarms import opponents_utility
from kswarms.agents.theory.times import Crowd, Interaction
from kswarms.agents.theory.wlu import effect_on_own_swarm, wlu_by_parts

seconds = st.floats(0, 600)
weights = st.floats(0.1, 10)
interactions = st.builds(Interaction, seconds, seconds, weights, weights)
some = st.lists(interactions, max_size=6)
crowds = st.builds(Crowd, st.integers(0, 8), st.integers(0, 8), *[weights] * 6).filter(
    lambda c: c.n_k + c.n_m > 0
)


def near(value: float, *sizes: float) -> object:
    return pytest.approx(value, rel=1e-9, abs=1e-9 * (1 + sum(map(abs, sizes))))


# Time as utility.


@given(interactions, interactions)
def test_a_pair_of_opponents_is_zero_sum(one: Interaction, other: Interaction) -> None:
    assert times.pair_utility(one, other) == opponents_utility(times.pair_utility(other, one))
    assert times.inter_utility(one, [other]) == near(times.pair_utility(one, other), *one, *other)


@given(some, some)
def test_two_groups_that_meet_are_zero_sum(ours: list[Interaction], theirs: list[Interaction]) -> None:
    one = [times.inter_utility(robot, theirs) for robot in ours]
    other = [times.inter_utility(robot, ours) for robot in theirs]
    assert sum(one) == near(-sum(other), *one, *other)


@given(interactions, some)
def test_the_utility_of_a_meeting_is_the_sum_over_pairs(own: Interaction, others: list[Interaction]) -> None:
    pairs = [times.pair_utility(own, other) for other in others]
    size = sum(abs(times.time_utility(*other)) + 1e4 for other in others)
    assert times.inter_utility(own, others) == near(sum(pairs), size)
    absent = sum(times.absence_utility_of_one(other) for other in others)
    assert times.absence_utility_of_swarm(others) == near(absent)
    present = sum(times.time_utility(*other) for other in others)
    assert times.presence_utility_of_own_swarm(others) == near(present, size)
    assert times.intra_utility(len(others), *own) == near(len(others) * times.time_utility(*own))


@given(interactions, st.integers(0, 8), st.lists(some, max_size=3))
def test_a_mixed_meeting_is_the_sum_over_swarms(
    own: Interaction, n_k: int, opponents: list[list[Interaction]]
) -> None:
    together = [other for swarm in opponents for other in swarm]
    mixed = times.mixed_utility(own, n_k, *opponents)
    assert mixed == near(times.mixed_utility(own, n_k, together), 1e4 * len(together))


@given(interactions, some, some)
def test_the_wlu_of_times_equals_theorem_13(
    own: Interaction, mates: list[Interaction], opponents: list[Interaction]
) -> None:
    parts = (
        times.intra_utility(len(mates), *own),
        times.inter_utility(own, opponents),
        effect_on_own_swarm(
            times.presence_utility_of_own_swarm(mates), times.absence_utility_of_swarm(mates)
        ),
        times.absence_utility_of_swarm(opponents),
    )
    assert times.approximate_wlu(own, mates, opponents) == near(wlu_by_parts(*parts), *parts, 1e5)


@given(crowds, seconds, seconds)
def test_the_wlu_of_equal_times(crowd: Crowd, t_a: float, t_p: float) -> None:
    own = Interaction(t_a, t_p, crowd.alpha_i, crowd.beta_i)
    mates = [Interaction(t_a, t_p, crowd.alpha_k, crowd.beta_k)] * crowd.n_k
    opponents = [Interaction(t_a, t_p, crowd.alpha_m, crowd.beta_m)] * crowd.n_m
    of_times = times.approximate_wlu(own, mates, opponents)
    equal = times.wlu_of_equal_times(crowd, t_a, t_p)
    assert equal == near(of_times, 1e5)
    assert times.wlu_per_robot_met(crowd, t_a, t_p) == near(equal / (crowd.n_k + crowd.n_m), 1e5)


@given(st.lists(st.tuples(weights, weights), min_size=1, max_size=5), interactions, seconds, seconds)
def test_with_equal_times_only_the_means_of_weights_matter(
    theirs: list[tuple[float, float]], own: Interaction, t_a: float, t_p: float
) -> None:
    opponents = [Interaction(t_a, t_p, alpha, beta) for alpha, beta in theirs]
    alpha, beta = (sum(values) / len(theirs) for values in zip(*theirs, strict=True))
    crowd = Crowd(0, len(theirs), own.alpha, own.beta, alpha_m=alpha, beta_m=beta)
    of_times = times.approximate_wlu(Interaction(t_a, t_p, own.alpha, own.beta), [], opponents)
    assert times.wlu_of_equal_times(crowd, t_a, t_p) == near(of_times, 1e5)


# Estimates that a robot can compute.

met = st.tuples(st.integers(0, 8), st.integers(0, 8)).filter(any)


@given(met, seconds, seconds, weights, weights)
def test_identical_swarms_wlu(
    n: tuple[int, int], t_a: float, t_p: float, alpha: float, beta: float
) -> None:
    crowd = Crowd(*n, alpha, beta, alpha, beta, alpha, beta)
    exact = identical_swarms_wlu(*n, t_a, t_p, alpha, beta)
    assert exact == near(times.wlu_per_robot_met(crowd, t_a, t_p) / beta, 1e5)
    assert WLU().of(0.0, t_p, 8, TOWARDS, True, 1) == near(t_p)


@given(met, weights, weights, st.floats(0.1, 2.9))
def test_the_program_weight(n: tuple[int, int], alpha: float, beta: float, b: float) -> None:
    crowd = Crowd(*n, alpha, beta, alpha, beta, alpha, beta_m=b * beta)
    exact = program_weight(*n, b)
    assert exact == near(times.gamma(crowd) / (sum(n) * beta), 100)
    assert program_weight_of_equals(b) == near(program_weight(n[0] + 1, n[0] + 1, b))


@given(st.integers(1, 8), seconds, seconds, weights, weights, weights)
def test_the_wlu_of_a_single_swarm(
    n_k: int, t_a: float, t_p: float, alpha_i: float, alpha_k: float, beta: float
) -> None:
    crowd = Crowd(n_k, 0, alpha_i, beta, alpha_k, beta)
    exact = times.wlu_of_equal_times(crowd, t_a, t_p) / (8 * beta)
    reward = SingleSwarmWLU(kappa=kappa(alpha_i, alpha_k, beta))
    assert reward.of(t_a, t_p, n_k, AWAY, False, 1) == near(exact, 1e6)
    assert times.delta(crowd) / (n_k * beta) == near(-kappa(alpha_i, alpha_k, beta), 1e3)


@given(seconds, seconds, st.integers(0, 8), st.sampled_from((AWAY, TOWARDS)), st.booleans(), st.floats(0, 1))
def test_rewards_equal_the_equations(
    t_a: float, t_p: float, n_active: int, direction: int, inter: bool, size: float
) -> None:
    sensed = (t_a, t_p, n_active, direction, inter, 1)
    sign = sigma(inter, direction)
    assert WLU(delta=size).of(*sensed) == estimated_wlu(1.0, t_a, t_p, n_active, sign, size)
    assert (
        WLU(delta=size, b=7 / 6).of(*sensed)
        == estimated_wlu(11 / 12, *sensed[:3], sign, size)
        == near(11 / 12 * t_p + sign * n_active / 8 * size * t_a, t_p, t_a)
    )
    assert IndividualUtility(delta=size).of(*sensed) == near(n_active / 8 * (t_p - size * t_a), t_p, t_a)
