"""Utilities of swarms, SUD and WLU compared with values computed by hand (sections 1.1, 1.2)."""

import numpy as np
import pytest

from kswarms.agents.common.errors import InputError
from kswarms.agents.theory import swarms, wlu

# Players 0 and 1 of S1, 2 of S2, 3 of S3; columns are the swarms met.
U = [[4.0, 3.0, -1.0], [1.0, -5.0, 2.0], [2.0, 7.0, 6.0], [-1.0, -6.0, 0.0]]
SWARM_OF = [0, 0, 1, 2]


def test_utilities_add_up() -> None:
    assert swarms.player_utilities(U).tolist() == [6.0, -2.0, 15.0, -7.0]
    assert swarms.swarm_utilities(swarms.player_utilities(U), SWARM_OF, 3).tolist() == [4.0, 15.0, -7.0]
    assert swarms.swarm_utilities([1.0, 2.0], [2, 2], 4).tolist() == [0.0, 0.0, 3.0, 0.0]
    assert swarms.utility_between(U, SWARM_OF).tolist() == [[5, -2, 1], [2, 7, 6], [-1, -6, 0]]


def test_zero_sum_between_swarms_is_recognized() -> None:
    assert swarms.opponents_utility(3.5) == -3.5
    assert swarms.is_zero_sum_between(U, SWARM_OF)
    for player, swarm in ((0, 1), (2, 2), (3, 0)):
        other = np.array(U)
        other[player, swarm] += 1e-3
        assert not swarms.is_zero_sum_between(other, SWARM_OF)
        # Utility within a swarm is no loss of others.
        other = np.array(U)
        other[player, SWARM_OF[player]] += 1.0
        assert swarms.is_zero_sum_between(other, SWARM_OF)


def test_the_difference_of_three_swarms() -> None:
    totals = [4.0, 15.0, -7.0]
    assert [swarms.swarm_utility_difference(totals, k) for k in range(3)] == [-4.0, 18.0, -26.0]
    assert swarms.sum_of_differences(totals) == -12.0
    assert isinstance(swarms.swarm_utility_difference([3, 4], 0), int)


def test_differences_cancel_for_two_swarms_but_not_for_three() -> None:
    assert swarms.is_zero_sum_difference([[5.0, 3.0], [2.0, -9.0]])
    assert not swarms.is_zero_sum_difference([[4.0, 15.0, -7.0]])
    assert not swarms.is_zero_sum_difference([[4.0, 3.0, -7.0], [4.0, 3.0, -6.0]])
    assert swarms.is_zero_sum_difference([[4.0, 3.0, -7.0], [1.0, 1.0, -2.0]])
    assert not swarms.is_zero_sum_difference([[5.0], [3.0]])  # the SUD of a single swarm is its utility


def test_a_dummy_swarm_makes_only_constant_sum_games_zero_sum() -> None:
    assert swarms.dummy_utility([[4.0, 15.0, -7.0], [12.0, 0.0, 0.0]]) == -12.0
    with pytest.raises(InputError, match=r"utilities=\[12.0, 11.0\]: must have the same sum"):
        swarms.dummy_utility([[4.0, 15.0, -7.0], [11.0, 0.0, 0.0]])


def test_wonderful_life_utility_equals_values_computed_by_hand() -> None:
    # Swarm k: ρ and i; swarm m: j. i gets 2 from ρ and 5 from j; ρ gets 3 from i and −1 from j.
    # Without ρ, i gets 4 instead of 2, and j gets 6 instead of 1.
    u_i, u_rho, others_intra = (2.0, 5.0), (3.0, -1.0), 0.0
    own_intra, own_inter = u_i[0] + u_rho[0], u_i[1] + u_rho[1]
    sud = wlu.sud_by_parts(own_intra, others_intra, own_inter)
    totals = [own_intra + own_inter, others_intra - own_inter]
    assert sud == swarms.swarm_utility_difference(totals, 0) == 13.0
    phi = wlu.effect_on_own_swarm(present=2.0, absent=4.0)
    assert phi == -2.0
    assert wlu.effect_on_opponents(u_rho[1]) == 1.0
    without = wlu.sud_without(u_i[0], others_intra, u_i[1], phi, absent=6.0)
    assert without == swarms.swarm_utility_difference([4.0 + 5.0, -5.0 + 6.0], 0) == 8.0
    assert wlu.wonderful_life_utility(sud, without) == 5.0
    assert wlu.wlu_by_parts(*u_rho, phi, absent=6.0) == 5.0
