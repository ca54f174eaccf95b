"""Networks, jams, the emergence of policies and heat maps, on conflicts whose answers are known."""

import math
from pathlib import Path

import networkx as nx
import numpy as np
import pandas as pd
import pytest
from matplotlib.collections import LineCollection

from kswarms.agents.common.errors import InputError
from kswarms.analysis.figures import emergence, networks
from kswarms.analysis.figures import heat_maps as maps
from kswarms.analysis.figures.files import encode
from kswarms.analysis.results import records
from kswarms.model.description.arena import build_arena
from tests.helpers.result_rows import MET, conflict, robots


def test_a_pair_is_an_edge_with_what_either_began() -> None:
    network = networks.meeting_network(MET)
    assert dict(network.nodes(data="swarm")) == {0: 1, 1: 1, 2: 2, 3: 2}
    assert {(a, b): data for a, b, data in network.edges(data=True)} == {
        (0, 1): {"meetings": 1, "time": 1.0, "kind": "intra"},
        (0, 2): {"meetings": 2, "time": 5.0, "kind": "inter"},
        (2, 3): {"meetings": 1, "time": 2.0, "kind": "intra"},
    }


def test_a_network_is_of_one_game() -> None:
    with pytest.raises(InputError, match="conflicts='2 runs': must be of one game"):
        networks.meeting_network(pd.concat([MET, MET.assign(run="b")]))
    network = networks.meeting_network(MET.drop(columns="run"))  # a DataCollector's table names none
    assert network.number_of_edges() == 3


def test_mixing_counts_each_pair_from_either_side() -> None:
    network = networks.meeting_network(MET)
    assert networks.mixing_matrix(network, "time").tolist() == [[2, 5], [5, 4]]
    assert networks.mixing_matrix(network, "meetings").tolist() == [[2, 2], [2, 2]]
    assert networks.mixing_matrix(network, None).tolist() == [[2, 1], [1, 2]]


def test_a_network_in_numbers() -> None:
    told = networks.describe(networks.meeting_network(MET))
    assert told == {
        "robots": 4,
        "pairs": 3,
        "met": 0.5,
        "meetings": 4,
        "time": 8.0,
        "inter": pytest.approx(10 / 16),
        "degree": 1.5,
        "strength": 4.0,
        "assortativity": pytest.approx(1 / 3),
        "assortativity_time": pytest.approx(
            (6 / 16 - (7 / 16) ** 2 - (9 / 16) ** 2) / (1 - (7 / 16) ** 2 - (9 / 16) ** 2)
        ),
        "chance": pytest.approx(-1 / 3),
    }


def test_assortativity_of_pairs_is_that_of_networkx_and_that_of_all_with_all_is_chance() -> None:
    draws = np.random.default_rng(2)
    network = nx.gnp_random_graph(20, 0.3, seed=4)
    for robot in network:
        network.nodes[robot]["swarm"] = 1 + robot % 3
    for a, b in network.edges:
        network.edges[a, b].update(time=float(draws.uniform()), meetings=1, kind="inter")
    told = networks.describe(network)
    assert told["assortativity"] == pytest.approx(nx.attribute_assortativity_coefficient(network, "swarm"))
    everybody = nx.complete_graph(20)
    nx.set_node_attributes(everybody, dict(network.nodes(data="swarm")), "swarm")
    expected = nx.attribute_assortativity_coefficient(everybody, "swarm")
    assert told["chance"] == pytest.approx(expected)
    assert expected < 0


def test_one_swarm_has_no_assortativity() -> None:
    alone = MET.assign(swarm=1, opponent_swarm=1)
    told = networks.describe(networks.meeting_network(alone))
    assert math.isnan(told["assortativity"])
    assert told["inter"] == 0


def test_jams_are_robots_linked_at_one_moment() -> None:
    over_time = networks.jams(MET)
    assert over_time["time"].tolist() == list(range(10))
    #       0: 0–2 | 1: 0–2 twice | 2: 2–0 | 3: 2–0 and 0–1 | 4 … 7: nobody | 8, 9: 2–3
    assert over_time["largest"].tolist() == [2, 2, 2, 3, 0, 0, 0, 0, 2, 2]
    assert over_time["jams"].tolist() == [0, 0, 0, 1, 0, 0, 0, 0, 0, 0]
    assert over_time["jammed"].tolist() == [0, 0, 0, 3, 0, 0, 0, 0, 0, 0]


def test_jams_at_finer_moments_of_a_later_phase() -> None:
    late = MET.assign(start=MET["start"] + 3000.1)
    over_time = networks.jams(late, every=0.1)
    jammed = over_time[over_time["jammed"] == 3]["time"]
    assert jammed.min() == pytest.approx(3003.1)
    assert jammed.max() == pytest.approx(3004.0)
    assert over_time["time"].iloc[0] == pytest.approx(3000.1)
    assert len(over_time) == 100


def test_two_jams_at_once_are_two() -> None:
    both = pd.DataFrame([conflict(0, 1, 0), conflict(1, 2, 0), conflict(3, 4, 0), conflict(5, 4, 0)])
    over_time = networks.jams(both)
    assert over_time[["jams", "jammed", "largest"]].to_numpy().tolist() == [[2, 6, 3]] * 2


def test_jams_refuse_what_has_no_answer() -> None:
    with pytest.raises(InputError, match="every=0: must be above 0"):
        networks.jams(MET, every=0)
    with pytest.raises(InputError, match="must hold at least one conflict"):
        networks.jams(MET.head(0))


def test_the_network_is_drawn_with_a_line_for_each_pair_and_its_time_in_the_matrix() -> None:
    figure = networks.network_figure(networks.meeting_network(MET), "title")
    circle, matrix, colours = figure.axes
    lines = sum(
        len(drawn.get_segments()) for drawn in circle.collections if isinstance(drawn, LineCollection)
    )
    assert lines == 3
    (image,) = matrix.images
    assert image.get_array()[0].tolist() == [None, 1.0, 5.0, None]  # robot 0 met 1 and 2
    assert [label.get_text() for label in matrix.get_xticklabels()] == ["S1", "S2"]
    assert "(s)" in colours.get_ylabel()
    legend = [text.get_text() for text in figure.legends[0].get_texts()]
    assert legend == ["intra-swarm meetings", "inter-swarm meetings", "S1", "S2"]
    assert encode(figure, "png")


def test_a_network_of_one_pair_can_be_drawn() -> None:
    assert encode(networks.network_figure(networks.meeting_network(MET.head(1))), "svg")


def test_jams_are_drawn_over_time() -> None:
    (axes,) = networks.jams_figure(networks.jams(MET)).axes
    assert axes.get_xlabel() == "time (s)"
    assert [text.get_text() for text in axes.figure.legends[0].get_texts()] == [
        "in jams of 3 or more",
        "in the largest cluster",
    ]


def learning() -> pd.DataFrame:
    """Robot 2 fights S1 from 10 s on, robot 3 never; Q(fight) of 2 rises to 2; S1 does not learn."""
    rows = [conflict(0, 2, 0.0, phase="learning", action="fight")]
    for second in range(20):
        action = "fight" if second >= 10 else "flight"
        rows.append(
            conflict(2, 0, second, phase="learning", action=action, q=second / 10 if second >= 10 else 0.1)
        )
        rows.append(conflict(3, 1, second, phase="learning", q=0.5))
    rows.append(conflict(3, 2, 5.0, phase="learning", action="fight"))  # within: no bandit of theirs
    rows.append(conflict(2, 0, 25.0))  # the measured game: no learning
    return pd.DataFrame(rows)


def test_only_what_a_bandit_decided_while_learning_counts() -> None:
    rows = emergence.learning_conflicts(learning())
    assert len(rows) == 40
    assert set(zip(rows["swarm"], rows["opponent_swarm"], strict=True)) == {(2, 1)}
    with pytest.raises(InputError, match="must be of a game with a learner"):
        emergence.learning_conflicts(MET)


def test_choices_of_the_swarm_and_of_each_robot() -> None:
    swarm = emergence.choices(learning())
    fights = swarm[swarm["action"] == "fight"]
    assert fights[fights["time"] < 9.5]["share"].tolist() == [0.0] * 10
    assert fights[fights["time"] > 9.5]["share"].tolist() == pytest.approx([0.5] * 10)
    by_robot = emergence.choices(learning(), by=["robot"])
    last = by_robot[(by_robot["action"] == "fight") & (by_robot["time"] > 18)]
    assert last.set_index("robot")["share"].to_dict() == {2: 1.0, 3: 0.0}


def test_q_is_the_last_value_by_then_and_absent_before_the_first_trial() -> None:
    q = emergence.values(learning())
    fight = q[(q["robot"] == 2) & (q["action"] == "fight")].sort_values("time")
    assert fight["time"].min() > 9
    assert fight["q"].iloc[-1] == pytest.approx(1.9)
    flight = q[(q["robot"] == 2) & (q["action"] == "flight")]
    assert set(flight["q"]) == {0.1}  # kept after it was chosen no more
    assert flight["time"].max() == fight["time"].max()


def test_choices_and_q_are_drawn_with_a_panel_for_each_bandit() -> None:
    (axes,) = emergence.choices_figure(learning(), "t").axes
    assert axes.get_title() == "S2 against S1"
    assert [text.get_text() for text in axes.figure.legends[0].get_texts()] == [
        "fight"
    ]  # the other is the rest
    (axes,) = emergence.values_figure(learning(), "t").axes
    assert [text.get_text() for text in axes.figure.legends[0].get_texts()] == ["fight", "flight"]
    assert axes.get_ylabel() == "Q (reward a second)"
    within = learning().assign(q=0.3)
    titles = [axes.get_title() for axes in emergence.values_figure(within).axes]
    assert titles == ["S1 against S2", "S2 against S1", "S2 within itself"]


def test_three_actions_are_all_drawn() -> None:
    rows = learning()
    rows.loc[2, "action"] = "wait"
    figure = emergence.choices_figure(rows)
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["fight", "flight", "wait"]


def test_preferences_leave_out_arms_that_were_never_tried() -> None:
    rows = emergence.preferences(robots())
    assert rows[["robot", "action", "q", "learned"]].to_numpy().tolist() == [
        [2, "flight", 0.1, False],
        [2, "fight", 0.2, True],
        [3, "flight", 0.3, True],
    ]
    assert len(emergence.preferences(robots(("a", "b")))) == 6
    with pytest.raises(InputError, match="must be of a game with a learner"):
        emergence.preferences(robots()[:1])


def test_preferences_are_drawn_robot_by_robot() -> None:
    (axes,) = emergence.preferences_figure(robots(("a", "b")), "t").axes
    assert axes.get_title() == "S2 against S1; best: fight 50%, flight 50%"
    fight, flight = (np.asarray(drawn.get_offsets()) for drawn in axes.collections)
    assert fight.tolist() == [[0, 0.2], [1, 0.2]]
    assert flight.tolist() == [[0, 0.1], [2, 0.3], [1, 0.1], [3, 0.3]]


PLACED = pd.DataFrame(
    [
        conflict(0, 2, 0, x=-0.99, y=-0.99),
        conflict(0, 2, 1, x=-0.99, y=-0.99, action="fight"),
        conflict(0, 2, 2, x=0.99, y=-0.99, run="b"),
        conflict(0, 2, 2, x=0.99, y=0.42, run="b"),
    ]
)


def test_density_counts_conflicts_of_a_game_by_cell_from_below_left() -> None:
    counts = maps.density(PLACED)
    assert counts.shape == (40, 40)
    assert counts.sum() == 2
    assert (counts[0, 0], counts[0, 39], counts[28, 39]) == (1, 0.5, 0.5)
    assert maps.density(PLACED.drop(columns="run"))[0, 0] == 2


def test_heat_maps_of_all_and_of_each_action_share_a_scale() -> None:
    arena = build_arena("symmetric", 2, 2.0, 0.16, 0.17, 0)
    figure = maps.heat_maps(PLACED, "t", arena)
    *panels, colours = figure.axes
    assert [axes.get_title() for axes in panels] == ["all: 4", "fight: 1", "flight: 3"]
    limits = {axes.images[0].get_clim() for axes in panels}
    assert limits == {(0.5, 1.0)}
    # One game of two had the only fight: half a fight in each.
    assert panels[1].images[0].get_array().sum() == 0.5
    assert [text.get_text() for text in panels[0].texts] == ["station", "station", "S1", "S2"]
    assert colours.get_ylabel() == "conflicts begun in 5 × 5 cm, a game"
    assert encode(figure, "png")


def test_heat_map_of_one_action_without_places() -> None:
    panel, _ = maps.heat_maps(PLACED[PLACED["action"] == "flight"].drop(columns="run")).axes
    assert panel.get_title() == "all: 3"
    assert list(panel.texts) == []
    with pytest.raises(InputError, match="must hold at least one conflict"):
        maps.heat_maps(PLACED.head(0))


def test_records_are_read_of_the_runs_that_are_wanted(tmp_path: Path) -> None:
    pd.concat([MET, MET.assign(run="b")]).to_parquet(tmp_path / "conflicts.parquet")
    robots(("a", "b")).to_parquet(tmp_path / "robots.parquet")
    assert records.recorded_runs(tmp_path, records.CONFLICTS_FILE) == {"a", "b"}
    assert set(records.read_conflicts(tmp_path, ["b"])["run"]) == {"b"}
    read = records.read_robots(tmp_path, ["a"])
    assert len(emergence.preferences(read)) == 3
    assert records.recorded_runs(tmp_path / "nowhere", records.CONFLICTS_FILE) == set()


def test_records_that_cannot_be_read_or_lack_a_column(tmp_path: Path) -> None:
    path = tmp_path / "conflicts.parquet"
    path.write_bytes(b"PAR1 and no more")
    with pytest.raises(InputError, match="must be a readable Parquet file"):
        records.recorded_runs(tmp_path, records.CONFLICTS_FILE)
    MET.drop(columns=["x", "q"]).to_parquet(path)
    with pytest.raises(InputError, match="must have the missing columns x, q"):
        records.read_conflicts(tmp_path, ["a"])
