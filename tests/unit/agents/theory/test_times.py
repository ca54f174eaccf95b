"""Time as utility and its estimates, compared with values computed by hand (sections 1.3, 1.4)."""

import pytest

from kswarms.agents.theory import estimates, times
from kswarms.agents.theory.times import Interaction

OWN = Interaction(t_a=2.0, t_p=7.0, alpha=3.0, beta=4.0)  # 28 − 6 = 22
MATES = [Interaction(1.0, 5.0, 2.0, 3.0), Interaction(4.0, 2.0, 0.5, 1.0), Interaction(0.0, 6.0, 9.0, 2.0)]
OPPONENTS = [Interaction(3.0, 5.0, 2.0, 2.0), Interaction(2.0, 8.0, 1.0, 0.5)]
# Mates:     βT(p) 15, 2, 12; αT(a) 2, 2, 0; βT(a) 3, 4, 0.
# Opponents: βT(p) 10, 4; αT(a) 6, 2; βT(a) 6, 1.


def test_utility_within_a_swarm() -> None:
    assert times.time_utility(*OWN) == 22.0
    assert times.intra_utility(3, *OWN) == 66.0
    assert times.intra_utility(0, *OWN) == 0.0


def test_utility_between_swarms() -> None:
    assert times.pair_utility(OWN, OPPONENTS[0]) == 22.0 - 4.0
    # 2 · (28 − 7) − 2 · (6 − 4).
    assert times.inter_utility(OWN, OPPONENTS) == 38.0
    assert times.inter_utility(OWN, []) == 0.0


def test_utility_from_several_swarms() -> None:
    assert times.mixed_utility(OWN, 3, OPPONENTS) == 66.0 + 38.0
    assert times.mixed_utility(OWN, 3, OPPONENTS[:1], OPPONENTS[1:], []) == 66.0 + 18.0 + 20.0
    assert times.mixed_utility(OWN, 2) == 44.0


def test_utilities_in_absence_and_presence() -> None:
    assert times.absence_utility_of_one(MATES[0]) == 18.0
    assert times.absence_utility_of_swarm(MATES) == pytest.approx(29.0 + 7.0)
    assert times.absence_utility_of_swarm(OPPONENTS) == 14.0 + 7.0
    assert times.presence_utility_of_own_swarm(MATES) == pytest.approx(29.0 - 4.0)
    assert times.absence_utility_of_swarm([]) == times.presence_utility_of_own_swarm([]) == 0.0


def test_the_wlu_of_times_has_the_corrected_sign() -> None:
    # (3 + 2 · 2) · (28 − 6) − (4 + 7) + (2 · 8 + 7 − 14); the minus of the source would give 134.
    assert times.approximate_wlu(OWN, MATES, OPPONENTS) == pytest.approx(154.0 - 11.0 + 9.0)
    assert times.approximate_wlu(OWN, MATES, []) == pytest.approx(66.0 - 11.0)
    assert times.approximate_wlu(OWN, [], []) == 0.0


def test_the_wlu_of_equal_times() -> None:
    crowd = times.Crowd(3, 2, alpha_i=3.0, beta_i=4.0, alpha_k=2.0, beta_k=5.0, alpha_m=1.5, beta_m=0.5)
    assert times.gamma(crowd) == 7 * 4.0 - 2 * 0.5
    assert times.delta(crowd) == (2 * 0.5 - 3 * 5.0) + (4 * 1.5 - 3 * 2.0 - 7 * 3.0)
    assert times.wlu_of_equal_times(crowd, t_a=2.0, t_p=10.0) == 270.0 - 70.0
    assert times.wlu_per_robot_met(crowd, t_a=2.0, t_p=10.0) == pytest.approx(40.0)


def test_estimated_wlu_and_its_weights() -> None:
    assert estimates.estimated_wlu(0.5, t_a=2.0, t_p=6.0, n_active=4, sign=-1, delta=0.25) == 3.0 - 0.25
    assert estimates.estimated_wlu(0.5, 2.0, 6.0, 4, -1, -0.25) == 3.0 - 0.25  # Δ counts by its size
    # 5 + ((3 − 1) · 2 − 2 · 1 · 3)/(4 · 2) · 4.
    assert estimates.identical_swarms_wlu(1, 3, t_a=4.0, t_p=5.0, alpha=3.0, beta=2.0) == 4.0
    assert estimates.program_weight(1, 3, b=1.5) == 2.5 / 4
    assert estimates.program_weight_of_equals(7 / 6) == pytest.approx(11 / 12)
    assert estimates.program_weight_of_equals(1.0) == 1.0
    assert estimates.kappa(2.0, 2.0, 2.0) == 3.0
    assert estimates.kappa(1.0, 2.0, 4.0) == 1.75
