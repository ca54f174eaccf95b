"""Utilities of swarms, SUD and WLU against their definitions, on generated games (sections 1.1, 1.2)."""

from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from kswarms.agents.common.arrays import Floats
from kswarms.agents.theory.games import (
    NormalForm,
    extensive_form,
    fold,
    is_pairwise_zero_sum,
    is_potential,
    polymatrix,
    swarm_payoffs,
    zero_sum,
)
from kswarms.agents.theory.swarms import (
    dummy_utility,
    is_zero_sum_between,
    is_zero_sum_difference,
    player_utilities,
    sum_of_differences,
    swarm_utilities,
    swarm_utility_difference,
    utility_between,
)
from kswarms.agents.theory.wlu import (
    effect_on_opponents,
    effect_on_own_swarm,
    sud_by_parts,
    sud_without,
    wlu_by_parts,
    wonderful_life_utility,
)

ACTIONS = 2


class Meetings(NamedTuple):
    """A game in which each pair of players meets once. Payoffs are integers, so that sums are exact.

    `payoff[i, j, a_i, a_j]` is the utility of player i from meeting j; between swarms, it is the negative of
    the utility of j. `absent[i, j]` replaces the utility of j from meeting i if i is absent.
    """

    swarm_of: list[int]
    payoff: Floats
    absent: Floats

    def utilities(self, profile: list[int], without: int | None = None) -> Floats:
        """Return u_i^m, shape (N, K); zeros for an absent player."""
        u = np.zeros((len(self.swarm_of), max(self.swarm_of) + 1))
        for i in range(len(self.swarm_of)):
            for j, swarm in enumerate(self.swarm_of):
                if i in (j, without):
                    continue
                present = self.payoff[i, j, profile[i], profile[j]]
                u[i, swarm] += self.absent[j, i] if j == without else present
        return u

    def totals(self, profile: list[int], without: int | None = None) -> list[float]:
        """Return U_Sk of each swarm."""
        u = self.utilities(profile, without)
        return [float(value) for value in swarm_utilities(player_utilities(u), self.swarm_of, u.shape[1])]

    def sud(self, profile: list[int], swarm: int, without: int | None = None) -> float:
        return swarm_utility_difference(self.totals(profile, without), swarm)

    def wlu(self, profile: list[int], player: int) -> float:
        """Return W by its definition, Eq. 3.9."""
        swarm = self.swarm_of[player]
        return wonderful_life_utility(self.sud(profile, swarm), self.sud(profile, swarm, without=player))


@st.composite
def meetings(draw: st.DrawFn, max_swarms: int = 4) -> Meetings:
    k = draw(st.integers(2, max_swarms))
    extra = draw(st.lists(st.integers(0, k - 1), min_size=1, max_size=3))
    swarm_of = [*range(k), *extra]
    n = len(swarm_of)
    whole = st.integers(-9, 9)
    payoff = draw(arrays(np.int64, (n, n, ACTIONS, ACTIONS), elements=whole)).astype(float)
    for i in range(n):
        for j in range(i):
            if swarm_of[i] != swarm_of[j]:
                payoff[i, j] = -payoff[j, i].T
    absent = draw(arrays(np.int64, (n, n), elements=whole)).astype(float)
    return Meetings(swarm_of, payoff, absent)


profiles = st.lists(st.integers(0, ACTIONS - 1), min_size=7, max_size=7)
totals = st.lists(st.integers(-10_000, 10_000), min_size=1, max_size=6)
utilities_of_two = st.tuples(st.floats(-600, 600), st.floats(-600, 600))


# Swarms.


@given(totals)
def test_differences_sum_to_two_minus_k_times_the_utilities(utilities: list[int]) -> None:
    differences = [swarm_utility_difference(utilities, k) for k in range(len(utilities))]
    assert sum(differences) == sum_of_differences(utilities) == (2 - len(utilities)) * sum(utilities)
    assert is_zero_sum_difference([utilities]) == (sum(differences) == 0)


@given(st.lists(utilities_of_two, min_size=1))
def test_the_differences_of_any_two_swarms_cancel(outcomes: list[tuple[float, float]]) -> None:
    assert is_zero_sum_difference(outcomes)
    for outcome in outcomes:
        assert swarm_utility_difference(outcome, 0) == pytest.approx(-swarm_utility_difference(outcome, 1))


@given(st.integers(2, 5), st.integers(-999, 999), st.data())
def test_a_dummy_swarm_makes_a_constant_sum_game_zero_sum(
    swarms: int, constant: int, data: st.DataObject
) -> None:
    others = arrays(np.int64, (4, swarms - 1), elements=st.integers(-999, 999))
    outcomes = data.draw(others).astype(float)
    outcomes = np.column_stack([outcomes, constant - outcomes.sum(axis=1)])
    closed = np.column_stack([outcomes, np.full(len(outcomes), dummy_utility(outcomes))])
    assert not closed.sum(axis=1).any()
    assert is_zero_sum_difference(closed)
    assert is_zero_sum_difference(outcomes) == (swarms == 2 or constant == 0)


@given(meetings(), profiles)
def test_utilities_between_swarms_cancel(game: Meetings, profile: list[int]) -> None:
    u = game.utilities(profile)
    between = utility_between(u, game.swarm_of)
    assert is_zero_sum_between(u, game.swarm_of)
    assert sum(game.totals(profile)) == np.trace(between)
    u[0, 1] += 1.0
    assert not is_zero_sum_between(u, game.swarm_of)


# Wonderful Life Utility.


@given(meetings(), profiles, st.data())
def test_theorem_13_equals_the_definition(game: Meetings, profile: list[int], data: st.DataObject) -> None:
    swarm_of = np.array(game.swarm_of)
    player = data.draw(st.integers(0, len(swarm_of) - 1))
    k = swarm_of[player]
    u = game.utilities(profile)
    own, mates = swarm_of == k, (swarm_of == k) & (np.arange(len(swarm_of)) != player)
    inter = np.arange(u.shape[1]) != k
    from_player = np.array(
        [game.payoff[j, player, profile[j], profile[player]] for j in range(len(swarm_of))]
    )
    absent = game.absent[player]
    assert from_player[~own].sum() == effect_on_opponents(u[player][inter].sum())
    phi = effect_on_own_swarm(from_player[mates].sum(), absent[mates].sum())
    others_intra = sum(u[j, swarm_of[j]] for j in np.flatnonzero(~own))
    sud = sud_by_parts(u[own, k].sum(), others_intra, u[own][:, inter].sum())
    without = sud_without(u[mates, k].sum(), others_intra, u[mates][:, inter].sum(), phi, absent[~own].sum())
    assert sud == game.sud(profile, k)
    assert without == game.sud(profile, k, without=player)
    by_parts = wlu_by_parts(u[player, k], u[player][inter].sum(), phi, absent[~own].sum())
    assert by_parts == wonderful_life_utility(sud, without) == game.wlu(profile, player)


@given(meetings(), profiles, st.data())
def test_a_unilateral_change_has_the_same_effect_on_wlu_and_sud(
    game: Meetings, profile: list[int], data: st.DataObject
) -> None:
    player = data.draw(st.integers(0, len(game.swarm_of) - 1))
    k = game.swarm_of[player]
    other = profile.copy()
    other[player] = 1 - profile[player]
    change = game.sud(other, k) - game.sud(profile, k)
    assert game.wlu(other, player) - game.wlu(profile, player) == change


@given(meetings(max_swarms=2), profiles)
def test_sud_is_a_potential_of_wlu_but_not_of_the_own_utility(game: Meetings, profile: list[int]) -> None:
    members = [i for i, swarm in enumerate(game.swarm_of) if swarm == 0]
    shape = (ACTIONS,) * len(members)
    sud, wlu, own = np.zeros(shape), np.zeros((len(members), *shape)), np.zeros((len(members), *shape))
    for actions in np.ndindex(shape):
        at = profile.copy()
        for i, action in zip(members, actions, strict=True):
            at[i] = action
        sud[actions] = game.sud(at, 0)
        utilities = player_utilities(game.utilities(at))
        for m, i in enumerate(members):
            wlu[(m, *actions)] = game.wlu(at, i)
            own[(m, *actions)] = utilities[i]
    assert is_potential(sud, list(wlu))
    # For a swarm of one robot, W changes by 2 u_ρ^m and its own utility by u_ρ^m.
    if len(members) == 1:
        assert is_potential(sud, list(own)) == (np.ptp(own[0]) == 0)


# Forms of the game.

forms = arrays(np.int64, (2, 3), elements=st.integers(-9, 9)).map(
    lambda own: zero_sum(("flight", "fight"), ("flight", "fight", "wait"), own)
)


@given(st.dictionaries(st.integers(1, 6), forms, min_size=1, max_size=4))
def test_fold_is_the_inverse_of_extensive_form(games: dict[int, NormalForm]) -> None:
    folded = fold(extensive_form(games))
    assert list(folded) == list(games)
    for swarm, form in folded.items():
        assert np.array_equal(form.own, games[swarm].own)
        assert form.is_zero_sum()


@given(forms)
def test_swarms_that_only_meet_each_other_are_zero_sum(form: NormalForm) -> None:
    graph = polymatrix({(1, 2): form})
    assert is_pairwise_zero_sum(graph)
    assert not swarm_payoffs(graph).sum(axis=0).any()
