"""Drawings of the forms of a game: content and legibility."""

from itertools import combinations

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.transforms import Bbox

from kswarms.agents.theory.games import NormalForm, extensive_form, polymatrix, zero_sum
from kswarms.analysis.figures.game_forms import draw_extensive_form, draw_polymatrix

ACTIONS = ("flight", "fight")
WITHIN = NormalForm(ACTIONS, ACTIONS, np.array([[5.6, 5.6], [4.6, 4.6]]), np.array([[5.6, 4.6], [5.6, 4.6]]))
BETWEEN = zero_sum(ACTIONS, ACTIONS, np.array([[0.0, 12.34], [-12.34, 0.0]]))


def text_boxes(figure: Figure) -> dict[Text, Bbox]:
    """Return all drawn texts and their boxes (pixels)."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    texts = [text for axes in figure.axes for text in (*axes.texts, axes.title) if text.get_text()]
    texts += [text for legend in figure.legends for text in legend.get_texts()]
    return {text: text.get_window_extent(canvas.get_renderer()) for text in texts}


def count_lines(figure: Figure, style: str) -> int:
    return sum(line.get_linestyle() == style for line in figure.axes[0].lines)


def graph(swarms: int) -> object:
    pairs = [(k, m) for k in range(1, swarms + 1) for m in range(k, swarms + 1)]
    return polymatrix({(k, m): WITHIN if k == m else BETWEEN for k, m in pairs})


def test_the_tree_shows_actions_chances_payoffs_and_information_sets() -> None:
    figure = draw_extensive_form(extensive_form({1: WITHIN, 2: BETWEEN}, {1: 0.25, 2: 0.75}))
    texts = [text.get_text() for text in text_boxes(figure)]
    assert {"S1, p = 0.25", "S2, p = 0.75", "payoffs (own, met)"} <= set(texts)
    assert texts.count("flight") == texts.count("fight") == 2 + 4
    payoffs = [text for text in texts if text.startswith("(")]
    assert payoffs[4:] == ["(0, 0)", "(12.3, -12.3)", "(-12.3, 12.3)", "(0, 0)"]
    assert count_lines(figure, "--") == 2  # one information set with two nodes for each swarm
    assert count_lines(figure, "-") == 2 + 4 + 8


def test_the_graph_distinguishes_zero_sum_and_general_sum_games() -> None:
    figure = draw_polymatrix(graph(3))
    assert count_lines(figure, "-") == 3
    assert count_lines(figure, "--") == 3
    texts = [text.get_text() for text in text_boxes(figure)]
    assert {"S1", "S2", "S3", "zero-sum", "general-sum", "within S2", "S1 (rows), S3 (columns)"} <= set(texts)
    matrix = "flight fight flight (0, 0) (12.3, -12.3) fight (-12.3, 12.3) (0, 0)"
    assert [text.split() for text in texts if "12.3" in text] == [matrix.split()] * 3


@pytest.mark.parametrize("swarms", [1, 2, 4, 6])
def test_texts_are_inside_the_figure_and_do_not_overlap(swarms: int) -> None:
    tree = extensive_form(dict.fromkeys(range(1, swarms + 1), BETWEEN))
    for figure in (draw_extensive_form(tree), draw_polymatrix(graph(swarms))):
        texts = text_boxes(figure)
        assert len(texts) > 2
        for text, box in texts.items():
            assert Bbox.intersection(box, figure.bbox).bounds == pytest.approx(box.bounds), text.get_text()
        for (one, box), (other, next_box) in combinations(texts.items(), 2):
            assert not box.overlaps(next_box), (one.get_text(), other.get_text())
