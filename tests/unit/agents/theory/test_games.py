"""Forms of a multi-swarm game (section 1.1)."""

import networkx as nx
import numpy as np
import pytest

from kswarms.agents.common.errors import InputError
from kswarms.agents.theory import games
from kswarms.agents.theory.games import MET, NATURE, OWN, NormalForm, zero_sum
from kswarms.agents.theory.swarms import is_zero_sum_difference

ACTIONS = ("flight", "fight")
DILEMMA = NormalForm(ACTIONS, ACTIONS, np.array([[3, 0], [5, 1]]), np.array([[3, 5], [0, 1]]))
PENNIES = zero_sum(ACTIONS, ACTIONS, np.array([[1, -1], [-1, 1]]))
SKEWED = zero_sum(ACTIONS, ("flight", "fight", "wait"), np.array([[2, -1, 0], [0, 4, 0.5]]))


def test_zero_sum_and_general_sum_are_distinguished() -> None:
    assert PENNIES.is_zero_sum()
    assert SKEWED.is_zero_sum()
    assert not DILEMMA.is_zero_sum()
    nearly = SKEWED.met.copy()
    nearly[1, 2] += 1e-6
    assert not NormalForm(SKEWED.rows, SKEWED.columns, SKEWED.own, nearly).is_zero_sum()


def test_a_game_with_a_potential_and_one_without() -> None:
    # Deviating from (3, 3) gains 2, from (0, 5) and (5, 0) gains 1.
    potential = DILEMMA.potential()
    assert potential is not None
    assert potential.tolist() == [[0, 2], [2, 3]]
    assert PENNIES.potential() is None
    assert SKEWED.potential() is None
    assert games.is_potential(potential + 7.0, [DILEMMA.own, DILEMMA.met])
    assert not games.is_potential(DILEMMA.own, [DILEMMA.own, DILEMMA.met])


def test_a_potential_of_three_players() -> None:
    shared = np.arange(12.0).reshape(2, 3, 2) ** 2
    # Terms that do not depend on the own action have no effect.
    payoffs = [shared + np.arange(6.0).reshape(1, 3, 2), shared - np.arange(4.0).reshape(2, 1, 2), shared]
    potential = games.exact_potential(payoffs)
    assert potential is not None
    assert np.array_equal(potential, shared - shared[0, 0, 0])
    payoffs[2] = shared + np.arange(2.0) * np.arange(3.0).reshape(1, 3, 1)
    assert games.exact_potential(payoffs) is None


@pytest.mark.parametrize("payoffs", [[[1.0, 2.0]], [[1.0, np.nan], [0.0, 1.0]]])
def test_payoffs_must_fill_the_matrix(payoffs: list[list[float]]) -> None:
    with pytest.raises(InputError, match=r"met=.*must have a payoff for each row and column"):
        NormalForm(ACTIONS, ACTIONS, np.zeros((2, 2)), np.array(payoffs))


@pytest.mark.parametrize("actions", [("flight", "flight"), ()])
def test_names_of_actions_are_unique(actions: tuple[str, ...]) -> None:
    with pytest.raises(InputError, match=r"columns=.*must be distinct action names"):
        NormalForm(ACTIONS, actions, np.zeros((2, len(actions))), np.zeros((2, len(actions))))


def test_payoffs_do_not_change() -> None:
    own = np.ones((2, 2))
    form = zero_sum(ACTIONS, ACTIONS, own)
    own[0, 0] = 5.0
    assert form.own[0, 0] == 1.0
    with pytest.raises(ValueError, match="read-only"):
        form.own[0, 0] = 5.0


def test_nature_draws_a_swarm_and_both_players_act_simultaneously() -> None:
    tree = games.extensive_form({1: DILEMMA, 2: SKEWED}, {1: 0.25, 2: 0.75})
    assert nx.is_arborescence(tree)
    assert [tree.nodes[node]["player"] for node in ((), (2,), (2, "fight"))] == [NATURE, OWN, MET]
    assert tree.edges[(), (2,)] == {"action": "S2", "chance": 0.75}
    assert tree.nodes[2, "fight", "flight"]["payoffs"] == (0.0, 0.0)
    assert tree.nodes[2, "flight", "fight"]["payoffs"] == (-1.0, 1.0)
    leaves = [node for node in tree if not tree.out_degree(node)]
    assert len(leaves) == 4 + 6
    # The robot met knows the swarm but not the other's action.
    sets = nx.get_node_attributes(tree, "information")
    assert sets[2, "flight"] == sets[2, "fight"] != sets[1, "flight"]
    assert sets[(1,)] != sets[(2,)]


def test_the_tree_folds_into_a_normal_form_for_each_swarm() -> None:
    forms = games.fold(games.extensive_form({1: DILEMMA, 2: SKEWED, 3: PENNIES}))
    assert list(forms) == [1, 2, 3]
    for form, source in zip(forms.values(), (DILEMMA, SKEWED, PENNIES), strict=True):
        assert (form.rows, form.columns) == (source.rows, source.columns)
        assert np.array_equal(form.own, source.own)
        assert np.array_equal(form.met, source.met)


def test_a_tree_with_an_observed_first_move_does_not_fold() -> None:
    tree = games.extensive_form({1: DILEMMA})
    tree.nodes[1, "fight"]["information"] = (1, MET, "saw a fight")
    with pytest.raises(InputError, match=r"S1=.*must be one information set"):
        games.fold(tree)
    tree = games.extensive_form({1: DILEMMA})
    tree.remove_node((1, "fight", "fight"))
    with pytest.raises(InputError, match=r"S1=.*must be one information set"):
        games.fold(tree)


@pytest.mark.parametrize("chances", [{1: 0.5, 2: 0.6}, {1: 1.0}, {1: 1.5, 2: -0.5}])
def test_chances_must_be_probabilities(chances: dict[int, float]) -> None:
    with pytest.raises(InputError, match="must be probabilities of the swarms"):
        games.extensive_form({1: DILEMMA, 2: PENNIES}, chances)


def test_at_least_one_swarm_is_required() -> None:
    with pytest.raises(InputError, match="must have a game for at least one swarm"):
        games.extensive_form({})


def test_the_polymatrix_game_has_loops_within_and_edges_between_swarms() -> None:
    graph = games.polymatrix({(1, 2): PENNIES, (1, 1): DILEMMA, (2, 2): DILEMMA})
    assert sorted(map(sorted, graph.edges)) == [[1, 1], [1, 2], [2, 2]]
    assert nx.number_of_selfloops(graph) == 2
    assert graph.nodes[2] == {"actions": ACTIONS}
    assert games.is_pairwise_zero_sum(graph)
    assert not games.is_pairwise_zero_sum(games.polymatrix({(1, 2): DILEMMA}))


def test_payoffs_of_swarms_that_act_as_one_player() -> None:
    graph = games.polymatrix({(1, 1): DILEMMA, (1, 2): PENNIES, (2, 2): DILEMMA})
    payoffs = games.swarm_payoffs(graph)
    assert payoffs.shape == (2, 2, 2)
    # S1 flees and S2 fights: 3 + 3 within S1 and −1 between; 1 + 1 within S2 and 1 between.
    assert payoffs[:, 0, 1].tolist() == [5.0, 3.0]
    assert is_zero_sum_difference(payoffs.reshape(2, -1).T)
    three = {(k, m): PENNIES if k < m else DILEMMA for k in (1, 2, 3) for m in (1, 2, 3) if k <= m}
    assert not is_zero_sum_difference(games.swarm_payoffs(games.polymatrix(three)).reshape(3, -1).T)
    del three[1, 1], three[2, 2], three[3, 3]
    assert is_zero_sum_difference(games.swarm_payoffs(games.polymatrix(three)).reshape(3, -1).T)


@pytest.mark.parametrize("pairs", [[(1, 2), (2, 3)], [(2, 1)], [(1, 3), (1, 1)], [(0, 1)], []])
def test_each_pair_of_swarms_has_one_game(pairs: list[tuple[int, int]]) -> None:
    with pytest.raises(InputError, match="must have one game for each pair"):
        games.polymatrix(dict.fromkeys(pairs, PENNIES))


def test_a_swarm_has_the_same_actions_in_all_games() -> None:
    with pytest.raises(InputError, match="must give swarm 2 the same actions in all games"):
        games.polymatrix({(1, 1): DILEMMA, (1, 2): SKEWED, (2, 2): DILEMMA})
