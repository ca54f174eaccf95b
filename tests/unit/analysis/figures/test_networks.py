"""Figures of the network of conflicts and of jams."""

from matplotlib.collections import LineCollection

from kswarms.analysis.figures.files import encode
from kswarms.analysis.figures.networks import jams_figure, network_figure
from kswarms.analysis.measures.networks import jams, meeting_network
from tests.helpers.legends import legend_texts
from tests.helpers.result_rows import MET


def test_the_network_has_a_line_for_each_pair_and_the_matrix_has_its_time() -> None:
    figure = network_figure(meeting_network(MET), "title")
    circle, matrix, colours = figure.axes
    lines = [drawn.get_segments() for drawn in circle.collections if isinstance(drawn, LineCollection)]
    assert sum(map(len, lines)) == 3
    (image,) = matrix.images
    assert image.get_array()[0].tolist() == [None, 1.0, 5.0, None]  # robot 0 met 1 and 2
    assert [label.get_text() for label in matrix.get_xticklabels()] == ["S1", "S2"]
    assert "(s)" in colours.get_ylabel()
    assert legend_texts(figure) == ["intra-swarm meetings", "inter-swarm meetings", "S1", "S2"]
    assert encode(figure, "png")


def test_networks_of_one_pair_and_without_time_can_be_drawn() -> None:
    assert encode(network_figure(meeting_network(MET.head(1))), "svg")
    assert encode(network_figure(meeting_network(MET.assign(t_a=0.0))), "svg")


def test_jams_are_drawn_over_time() -> None:
    figure = jams_figure(jams(MET))
    assert figure.axes[0].get_xlabel() == "time (s)"
    assert legend_texts(figure) == ["in jams of 3 or more", "in the largest cluster"]
