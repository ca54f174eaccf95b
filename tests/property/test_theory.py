"""The theory against its own definitions, on generated games (sections 1.1 to 1.4)."""

from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from agents.actions import AWAY, TOWARDS
from agents.rewards import WLU, IndividualUtility, SingleSwarmWLU
from agents.theory.estimates import (
    estimated_wlu,
    identical_swarms_wlu,
    kappa,
    program_weight,
    program_weight_of_equals,
    sigma,
)
from agents.theory.games import (
    NormalForm,
    extensive_form,
    fold,
    is_potential,
    is_zero_sum_between,
    polymatrix,
    zero_sum,
)
from agents.theory.games import swarm_payoffs as polymatrix_payoffs
from agents.theory.swarms import (
    Floats,
    dummy_utility,
    is_zero_sum_difference,
    opponents_utility,
    player_utilities,
    sum_of_differences,
    swarm_utilities,
    swarm_utility_difference,
    utility_between,
)
from agents.theory.swarms import is_zero_sum_between as utilities_cancel
from agents.theory.times import (
    Crowd,
    Interaction,
    absent_to_one,
    absent_to_swarm,
    approximate_wlu,
    delta,
    gamma,
    inter_utility,
    intra_utility,
    mixed_utility,
    pair_utility,
    present_to_own_swarm,
    time_utility,
    wlu_of_equal_times,
    wlu_per_robot_met,
)
from agents.theory.wlu import (
    effect_on_opponents,
    effect_on_own_swarm,
    sud_by_parts,
    sud_without,
    wlu_by_parts,
    wonderful_life_utility,
)

ACTIONS = 2


class Meetings(NamedTuple):
    """A game in which each two players meet once, every payoff a whole number, so that sums are exact.

    `payoff[i, j, a_i, a_j]` is what i has from j: anything within a swarm, the opposite of what j has from i
    between swarms. `absent[i, j]` is what j has in place of i if i is not there.
    """

    swarm_of: list[int]
    payoff: Floats
    absent: Floats

    def utilities(self, profile: list[int], without: int | None = None) -> Floats:
        """Return u_i^m, shape (N, K); of nobody for who is not there."""
        u = np.zeros((len(self.swarm_of), max(self.swarm_of) + 1))
        for i in range(len(self.swarm_of)):
            for j, swarm in enumerate(self.swarm_of):
                if i in (j, without):
                    continue
                here = self.payoff[i, j, profile[i], profile[j]]
                u[i, swarm] += self.absent[j, i] if j == without else here
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
def meetings(draw: st.DrawFn, most_swarms: int = 4) -> Meetings:
    k = draw(st.integers(2, most_swarms))
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
seconds = st.floats(0, 600)
weights = st.floats(0.1, 10)
interactions = st.builds(Interaction, seconds, seconds, weights, weights)
some = st.lists(interactions, max_size=6)
crowds = st.builds(Crowd, st.integers(0, 8), st.integers(0, 8), *[weights] * 6).filter(
    lambda c: c.n_k + c.n_m > 0
)


def near(value: float, *sizes: float) -> object:
    return pytest.approx(value, rel=1e-9, abs=1e-9 * (1 + sum(map(abs, sizes))))


# Swarms.


@given(totals)
def test_differences_sum_to_two_less_k_times_the_utilities(utilities: list[int]) -> None:
    differences = [swarm_utility_difference(utilities, k) for k in range(len(utilities))]
    assert sum(differences) == sum_of_differences(utilities) == (2 - len(utilities)) * sum(utilities)
    assert is_zero_sum_difference([utilities]) == (sum(differences) == 0)


@given(st.lists(st.tuples(seconds, seconds), min_size=1))
def test_the_differences_of_any_two_swarms_cancel(outcomes: list[tuple[float, float]]) -> None:
    assert is_zero_sum_difference(outcomes)
    for outcome in outcomes:
        assert swarm_utility_difference(outcome, 0) == near(-swarm_utility_difference(outcome, 1), *outcome)


@given(st.integers(2, 5), st.integers(-999, 999), st.data())
def test_a_dummy_swarm_closes_a_game_of_constant_sum(swarms: int, constant: int, data: st.DataObject) -> None:
    others = arrays(np.int64, (4, swarms - 1), elements=st.integers(-999, 999))
    outcomes = data.draw(others).astype(float)
    outcomes = np.column_stack([outcomes, constant - outcomes.sum(axis=1)])
    closed = np.column_stack([outcomes, np.full(len(outcomes), dummy_utility(outcomes))])
    assert not closed.sum(axis=1).any()
    assert is_zero_sum_difference(closed)
    assert is_zero_sum_difference(outcomes) == (swarms == 2 or constant == 0)


@given(meetings(), profiles)
def test_what_swarms_have_from_each_other_cancels(game: Meetings, profile: list[int]) -> None:
    u = game.utilities(profile)
    between = utility_between(u, game.swarm_of)
    assert utilities_cancel(u, game.swarm_of)
    assert sum(game.totals(profile)) == np.trace(between)
    u[0, 1] += 1.0
    assert not utilities_cancel(u, game.swarm_of)


# Wonderful Life Utility.


@given(meetings(), profiles, st.data())
def test_theorem_13_is_the_definition(game: Meetings, profile: list[int], data: st.DataObject) -> None:
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
def test_a_player_alone_changes_its_wlu_as_much_as_sud(
    game: Meetings, profile: list[int], data: st.DataObject
) -> None:
    player = data.draw(st.integers(0, len(game.swarm_of) - 1))
    k = game.swarm_of[player]
    other = profile.copy()
    other[player] = 1 - profile[player]
    change = game.sud(other, k) - game.sud(profile, k)
    assert game.wlu(other, player) - game.wlu(profile, player) == change


@given(meetings(most_swarms=2), profiles)
def test_sud_is_a_potential_of_wlu_and_for_a_lone_player_not_of_its_utility(
    game: Meetings, profile: list[int]
) -> None:
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
    # A swarm of one: W changes by 2 u_ρ^m, its own utility by u_ρ^m.
    if len(members) == 1:
        assert is_potential(sud, list(own)) == (np.ptp(own[0]) == 0)


# Time as utility.


@given(interactions, interactions)
def test_a_pair_of_opponents_is_zero_sum(one: Interaction, other: Interaction) -> None:
    assert pair_utility(one, other) == opponents_utility(pair_utility(other, one))
    assert inter_utility(one, [other]) == near(pair_utility(one, other), *one, *other)


@given(some, some)
def test_two_groups_that_meet_are_zero_sum(ours: list[Interaction], theirs: list[Interaction]) -> None:
    one = [inter_utility(robot, theirs) for robot in ours]
    other = [inter_utility(robot, ours) for robot in theirs]
    assert sum(one) == near(-sum(other), *one, *other)


@given(interactions, some)
def test_meeting_many_is_meeting_each(own: Interaction, others: list[Interaction]) -> None:
    pairs = [pair_utility(own, other) for other in others]
    size = sum(abs(time_utility(*other)) + 1e4 for other in others)
    assert inter_utility(own, others) == near(sum(pairs), size)
    assert absent_to_swarm(others) == near(sum(absent_to_one(other) for other in others))
    assert present_to_own_swarm(others) == near(sum(time_utility(*other) for other in others), size)
    assert intra_utility(len(others), *own) == near(len(others) * time_utility(*own))


@given(interactions, st.integers(0, 8), st.lists(some, max_size=3))
def test_a_mixed_meeting_is_the_sum_over_swarms(
    own: Interaction, n_k: int, opponents: list[list[Interaction]]
) -> None:
    together = [other for swarm in opponents for other in swarm]
    mixed = mixed_utility(own, n_k, *opponents)
    assert mixed == near(mixed_utility(own, n_k, together), 1e4 * len(together))


@given(interactions, some, some)
def test_the_wlu_of_times_is_theorem_13(
    own: Interaction, mates: list[Interaction], opponents: list[Interaction]
) -> None:
    parts = (
        intra_utility(len(mates), *own),
        inter_utility(own, opponents),
        effect_on_own_swarm(present_to_own_swarm(mates), absent_to_swarm(mates)),
        absent_to_swarm(opponents),
    )
    assert approximate_wlu(own, mates, opponents) == near(wlu_by_parts(*parts), *parts, 1e5)


@given(crowds, seconds, seconds)
def test_the_wlu_of_equal_times(crowd: Crowd, t_a: float, t_p: float) -> None:
    own = Interaction(t_a, t_p, crowd.alpha_i, crowd.beta_i)
    mates = [Interaction(t_a, t_p, crowd.alpha_k, crowd.beta_k)] * crowd.n_k
    opponents = [Interaction(t_a, t_p, crowd.alpha_m, crowd.beta_m)] * crowd.n_m
    of_times = approximate_wlu(own, mates, opponents)
    equal = wlu_of_equal_times(crowd, t_a, t_p)
    assert equal == near(of_times, 1e5)
    assert wlu_per_robot_met(crowd, t_a, t_p) == near(equal / (crowd.n_k + crowd.n_m), 1e5)


@given(st.lists(st.tuples(weights, weights), min_size=1, max_size=5), interactions, seconds, seconds)
def test_equal_times_ask_for_means_of_weights_alone(
    theirs: list[tuple[float, float]], own: Interaction, t_a: float, t_p: float
) -> None:
    opponents = [Interaction(t_a, t_p, alpha, beta) for alpha, beta in theirs]
    alpha, beta = (sum(values) / len(theirs) for values in zip(*theirs, strict=True))
    crowd = Crowd(0, len(theirs), own.alpha, own.beta, alpha_m=alpha, beta_m=beta)
    of_times = approximate_wlu(Interaction(t_a, t_p, own.alpha, own.beta), [], opponents)
    assert wlu_of_equal_times(crowd, t_a, t_p) == near(of_times, 1e5)


# What a robot can compute.

met = st.tuples(st.integers(0, 8), st.integers(0, 8)).filter(any)


@given(met, seconds, seconds, weights, weights)
def test_identical_swarms(n: tuple[int, int], t_a: float, t_p: float, alpha: float, beta: float) -> None:
    crowd = Crowd(*n, alpha, beta, alpha, beta, alpha, beta)
    exact = identical_swarms_wlu(*n, t_a, t_p, alpha, beta)
    assert exact == near(wlu_per_robot_met(crowd, t_a, t_p) / beta, 1e5)
    assert WLU().of(0.0, t_p, 8, TOWARDS, True, 1) == near(t_p)


@given(met, weights, weights, st.floats(0.1, 2.9))
def test_the_opponents_advantage(n: tuple[int, int], alpha: float, beta: float, b: float) -> None:
    crowd = Crowd(*n, alpha, beta, alpha, beta, alpha, beta_m=b * beta)
    exact = program_weight(*n, b)
    assert exact == near(gamma(crowd) / (sum(n) * beta), 100)
    assert program_weight_of_equals(b) == near(program_weight(n[0] + 1, n[0] + 1, b))


@given(st.integers(1, 8), seconds, seconds, weights, weights, weights)
def test_a_swarm_that_is_alone(
    n_k: int, t_a: float, t_p: float, alpha_i: float, alpha_k: float, beta: float
) -> None:
    crowd = Crowd(n_k, 0, alpha_i, beta, alpha_k, beta)
    exact = wlu_of_equal_times(crowd, t_a, t_p) / (8 * beta)
    reward = SingleSwarmWLU(kappa=kappa(alpha_i, alpha_k, beta))
    assert reward.of(t_a, t_p, n_k, AWAY, False, 1) == near(exact, 1e6)
    assert delta(crowd) / (n_k * beta) == near(-kappa(alpha_i, alpha_k, beta), 1e3)


@given(seconds, seconds, st.integers(0, 8), st.sampled_from((AWAY, TOWARDS)), st.booleans(), st.floats(0, 1))
def test_rewards_are_the_equations(
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


# Forms of the game.

forms = arrays(np.int64, (2, 3), elements=st.integers(-9, 9)).map(
    lambda own: zero_sum(("flight", "fight"), ("flight", "fight", "wait"), own)
)


@given(st.dictionaries(st.integers(1, 6), forms, min_size=1, max_size=4))
def test_a_tree_folds_into_the_games_it_was_made_of(games: dict[int, NormalForm]) -> None:
    folded = fold(extensive_form(games))
    assert list(folded) == list(games)
    for swarm, form in folded.items():
        assert np.array_equal(form.own, games[swarm].own)
        assert form.is_zero_sum()


@given(forms)
def test_swarms_that_only_meet_each_other_are_zero_sum(form: NormalForm) -> None:
    graph = polymatrix({(1, 2): form})
    assert is_zero_sum_between(graph)
    assert not polymatrix_payoffs(graph).sum(axis=0).any()
