"""Figures of choices, values and preferences."""

import numpy as np

from kswarms.analysis.figures.emergence import choices_figure, preferences_figure, values_figure
from tests.helpers.legends import legend_texts
from tests.helpers.result_rows import learning_conflicts, robots


def test_choices_and_q_are_drawn_with_a_panel_for_each_bandit() -> None:
    figure = choices_figure(learning_conflicts(), "t")
    assert figure.axes[0].get_title() == "S2 against S1"
    assert legend_texts(figure) == ["fight"]  # the other share is the rest
    figure = values_figure(learning_conflicts(), "t")
    assert legend_texts(figure) == ["fight", "flight"]
    assert figure.axes[0].get_ylabel() == "Q (reward per second)"
    within = learning_conflicts().assign(q=0.3)
    titles = [axes.get_title() for axes in values_figure(within).axes]
    assert titles == ["S1 against S2", "S2 against S1", "within S2"]


def test_three_actions_are_all_drawn() -> None:
    rows = learning_conflicts()
    rows.loc[2, "action"] = "wait"
    assert legend_texts(choices_figure(rows)) == ["fight", "flight", "wait"]


def test_an_action_has_the_same_colour_in_all_panels() -> None:
    rows = learning_conflicts()
    rows.loc[rows["robot"] == 2, ["swarm", "action"]] = [1, "wait"]
    figure = values_figure(rows.assign(q=0.3))
    colours = [{line.get_label(): line.get_color() for line in axes.lines} for axes in figure.axes]
    assert sorted(legend_texts(figure)) == ["fight", "flight", "wait"]
    for name in legend_texts(figure):
        assert len({panel[name] for panel in colours if name in panel}) == 1


def test_preferences_are_drawn_robot_by_robot() -> None:
    (axes,) = preferences_figure(robots(("a", "b")), "t").axes
    assert axes.get_title() == "S2 against S1; best: fight 50%, flight 50%"
    fight, flight = (np.asarray(drawn.get_offsets()) for drawn in axes.collections)
    assert fight.tolist() == [[0, 0.2], [1, 0.2]]
    assert flight.tolist() == [[0, 0.1], [2, 0.3], [1, 0.1], [3, 0.3]]
