"""Heat maps of conflicts."""

import pytest

from kswarms.agents.common.errors import InputError
from kswarms.analysis.figures.files import encode
from kswarms.analysis.figures.heat_maps import heat_map_figure
from kswarms.model.description.arena import build_arena
from tests.helpers.result_rows import PLACED


def test_the_maps_of_all_conflicts_and_of_each_action_have_one_scale() -> None:
    arena = build_arena("symmetric", 2, 2.0, 0.16, 0.17, 0)
    figure = heat_map_figure(PLACED, "t", arena)
    *panels, colours = figure.axes
    assert [axes.get_title() for axes in panels] == ["all: 4", "fight: 1", "flight: 3"]
    limits = {axes.images[0].get_clim() for axes in panels}
    assert limits == {(0.5, 1.0)}
    # One game of two had the only fight: half a fight in each.
    assert panels[1].images[0].get_array().sum() == 0.5
    assert [text.get_text() for text in panels[0].texts] == ["station", "station", "S1", "S2"]
    assert colours.get_ylabel() == "conflicts per game and 5 × 5 cm"
    assert encode(figure, "png")


def test_a_single_action_without_arena_has_one_map() -> None:
    panel, _ = heat_map_figure(PLACED[PLACED["action"] == "flight"].drop(columns="run")).axes
    assert panel.get_title() == "all: 3"
    assert panel.get_xlim() == (-1.0, 1.0)
    assert list(panel.texts) == []
    with pytest.raises(InputError, match="must hold at least one conflict"):
        heat_map_figure(PLACED.head(0))


def test_maps_without_an_arena_cover_all_conflicts() -> None:
    panel, *_ = heat_map_figure(PLACED.assign(x=-3.2)).axes
    assert panel.get_xlim() == panel.get_ylim() == (-3.5, 3.5)
    assert panel.images[0].get_array().sum() == 2.0
