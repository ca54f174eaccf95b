"""Figures of one game from a model's own DataCollector, and pictures as bytes."""

from pathlib import Path

import pandas as pd
import pytest
from matplotlib.figure import Figure

from kswarms.agents.common.errors import InputError
from kswarms.analysis.colours import SWARM_COLOURS
from kswarms.analysis.figures import emergence, networks
from kswarms.analysis.figures import heat_maps as maps
from kswarms.analysis.figures.files import encode, encode_all, save
from kswarms.analysis.figures.over_time import pucks_over_time, sud_over_time, time_share_over_time
from kswarms.analysis.measures.networks import jams, meeting_network
from kswarms.model.foraging import ForagingModel


@pytest.fixture(scope="module")
def model() -> ForagingModel:
    played = ForagingModel(
        n=8, policies="avoid,inter-learner", learning=60, duration=60, seed=1, record="model,conflicts"
    )
    played.play()
    return played


@pytest.mark.parametrize(
    ("draw", "column", "label"),
    [
        (pucks_over_time, "pucks", "pucks deposited by the swarm"),
        (sud_over_time, "sud", "SUD (pucks)"),
        (time_share_over_time, "share_a", "share of time in conflict so far"),
    ],
)
def test_a_game_over_its_time(model: ForagingModel, draw: type, column: str, label: str) -> None:
    samples = model.datacollector.get_model_vars_dataframe()
    (axes,) = draw(samples, "one game").axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("time (s)", label)
    handles, names = axes.get_legend_handles_labels()
    assert names == ["S1", "S2"]
    for k, line in enumerate(handles):
        assert line.get_xdata().tolist() == samples["time"].tolist()
        assert line.get_ydata().tolist() == samples[f"{column}_{k + 1}"].tolist()
    assert [line.get_color() for line in handles] == list(SWARM_COLOURS[:2])


def test_samples_without_the_columns() -> None:
    with pytest.raises(InputError, match=r"samples=\['time'\]: must have the columns time and pucks_1"):
        pucks_over_time(pd.DataFrame({"time": [0.0]}))


def test_the_conflicts_of_a_datacollector_are_drawn_like_those_of_a_file(model: ForagingModel) -> None:
    conflicts = model.datacollector.get_table_dataframe("conflicts")
    network = meeting_network(conflicts)
    assert set(network) <= set(range(8))
    assert jams(conflicts)["largest"].max() <= 8
    figures = (
        networks.network_figure(network),
        emergence.choices_figure(conflicts),
        emergence.values_figure(conflicts),
        maps.heat_maps(conflicts, places=model.arena),
    )
    assert all(encode(figure, "png").startswith(b"\x89PNG") for figure in figures)


def figure() -> Figure:
    drawing = Figure(figsize=(2, 1))
    drawing.subplots().plot([1, 2], [3, 4])
    return drawing


def test_a_picture_is_the_same_bytes_in_either_format() -> None:
    assert encode(figure(), "svg") == encode(figure(), "svg")
    assert encode(figure(), "png") == encode(figure(), "png")
    assert b"<svg" in encode(figure(), "svg")
    with pytest.raises(InputError, match="format='gif': must be one of png, svg"):
        encode(figure(), "gif")


def test_the_smallest_format_is_known() -> None:
    picture = encode_all(figure())
    assert (picture.width, picture.height) == (192, 96)
    other = {"png": "svg", "svg": "png"}[picture.smallest]
    assert len(picture.files[picture.smallest]) <= len(picture.files[other])


def test_a_figure_is_saved_by_the_suffix_of_its_file(tmp_path: Path) -> None:
    save(figure(), tmp_path / "figures" / "a.SVG")
    assert (tmp_path / "figures" / "a.SVG").read_bytes() == encode(figure(), "svg")
    with pytest.raises(InputError, match="format='jpg'"):
        save(figure(), tmp_path / "a.jpg")
