"""Networks and jams of conflicts with known answers."""

import math

import networkx as nx
import numpy as np
import pandas as pd
import pytest

from kswarms.agents.common.errors import InputError
from kswarms.analysis.measures.networks import describe_network, jams, meeting_network, mixing_matrix
from tests.helpers.result_rows import MET, conflict


def test_an_edge_counts_the_conflicts_that_either_robot_began() -> None:
    network = meeting_network(MET)
    assert dict(network.nodes(data="swarm")) == {0: 1, 1: 1, 2: 2, 3: 2}
    assert {(a, b): data for a, b, data in network.edges(data=True)} == {
        (0, 1): {"meetings": 1, "time": 1.0, "kind": "intra"},
        (0, 2): {"meetings": 2, "time": 5.0, "kind": "inter"},
        (2, 3): {"meetings": 1, "time": 2.0, "kind": "intra"},
    }


def test_a_network_of_several_games_is_refused() -> None:
    with pytest.raises(InputError, match="conflicts='2 runs': must be of one game"):
        meeting_network(pd.concat([MET, MET.assign(run="b")]))
    network = meeting_network(MET.drop(columns="run"))  # as in the table of a DataCollector
    assert network.number_of_edges() == 3


def test_mixing_counts_each_pair_from_both_sides() -> None:
    network = meeting_network(MET)
    assert mixing_matrix(network, "time").tolist() == [[2, 5], [5, 4]]
    assert mixing_matrix(network, "meetings").tolist() == [[2, 2], [2, 2]]
    assert mixing_matrix(network, None).tolist() == [[2, 1], [1, 2]]


def test_a_network_is_described_in_numbers() -> None:
    by_chance = (7 / 16) ** 2 + (9 / 16) ** 2
    expected = {"robots": 4, "pairs": 3, "met": 0.5, "meetings": 4, "time": 8.0, "inter": 10 / 16}
    expected |= {"degree": 1.5, "strength": 4.0, "assortativity": 1 / 3, "chance": -1 / 3}
    expected["assortativity_time"] = (6 / 16 - by_chance) / (1 - by_chance)
    assert describe_network(meeting_network(MET)) == pytest.approx(expected)


def test_assortativity_agrees_with_networkx() -> None:
    draws = np.random.default_rng(2)
    network = nx.gnp_random_graph(20, 0.3, seed=4)
    for robot in network:
        network.nodes[robot]["swarm"] = 1 + robot % 3
    for a, b in network.edges:
        network.edges[a, b].update(time=float(draws.uniform()), meetings=1, kind="inter")
    found = describe_network(network)
    assert found["assortativity"] == pytest.approx(nx.attribute_assortativity_coefficient(network, "swarm"))
    complete = nx.complete_graph(20)
    nx.set_node_attributes(complete, dict(network.nodes(data="swarm")), "swarm")
    expected = nx.attribute_assortativity_coefficient(complete, "swarm")
    assert found["chance"] == pytest.approx(expected)
    assert expected < 0


def test_one_swarm_has_no_assortativity() -> None:
    alone = MET.assign(swarm=1, opponent_swarm=1)
    found = describe_network(meeting_network(alone))
    assert math.isnan(found["assortativity"])
    assert found["inter"] == 0


def test_jams_are_robots_linked_at_the_same_moment() -> None:
    over_time = jams(MET)
    assert over_time["time"].tolist() == list(range(10))
    #       0: 0–2 | 1: 0–2 twice | 2: 2–0 | 3: 2–0 and 0–1 | 4 … 7: none | 8, 9: 2–3
    assert over_time["largest"].tolist() == [2, 2, 2, 3, 0, 0, 0, 0, 2, 2]
    assert over_time["jams"].tolist() == [0, 0, 0, 1, 0, 0, 0, 0, 0, 0]
    assert over_time["jammed"].tolist() == [0, 0, 0, 3, 0, 0, 0, 0, 0, 0]


def test_jams_can_be_sampled_at_shorter_intervals() -> None:
    late = MET.assign(start=MET["start"] + 3000.1)
    over_time = jams(late, every=0.1)
    jammed = over_time[over_time["jammed"] == 3]["time"]
    assert jammed.min() == pytest.approx(3003.1)
    assert jammed.max() == pytest.approx(3004.0)
    assert over_time["time"].iloc[0] == pytest.approx(3000.1)
    assert len(over_time) == 100


def test_separate_jams_are_counted_separately() -> None:
    both = pd.DataFrame([conflict(0, 1, 0), conflict(1, 2, 0), conflict(3, 4, 0), conflict(5, 4, 0)])
    over_time = jams(both)
    assert over_time[["jams", "jammed", "largest"]].to_numpy().tolist() == [[2, 6, 3]] * 2


def test_jams_refuse_invalid_arguments() -> None:
    with pytest.raises(InputError, match="every=0: must be a number above 0"):
        jams(MET, every=0)
    with pytest.raises(InputError, match="must hold at least one conflict"):
        jams(MET.head(0))


def test_conflicts_without_time_have_no_assortativity_by_time() -> None:
    statistics = describe_network(meeting_network(MET.assign(t_a=0.0)))
    assert statistics["time"] == 0
    assert math.isnan(statistics["inter"])
    assert math.isnan(statistics["assortativity_time"])
    with pytest.raises(InputError, match="network='no edges'"):
        describe_network(meeting_network(MET.iloc[:0]))
    with pytest.raises(InputError, match="conflicts column opponent=0: must be another robot"):
        meeting_network(MET.assign(opponent=MET["robot"]))
