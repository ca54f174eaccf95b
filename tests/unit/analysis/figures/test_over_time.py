"""Figures of one game, from a model's DataCollector."""

import pandas as pd
import pytest

from kswarms.agents.common.errors import InputError
from kswarms.analysis.colours import SWARM_COLOURS
from kswarms.analysis.figures import emergence, networks
from kswarms.analysis.figures import heat_maps as maps
from kswarms.analysis.figures.files import encode
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
def test_curves_over_time_show_the_samples(model: ForagingModel, draw: type, column: str, label: str) -> None:
    samples = model.datacollector.get_model_vars_dataframe()
    (axes,) = draw(samples, "one game").axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("time (s)", label)
    handles, names = axes.get_legend_handles_labels()
    assert names == ["S1", "S2"]
    for k, line in enumerate(handles):
        assert line.get_xdata().tolist() == samples["time"].tolist()
        assert line.get_ydata().tolist() == samples[f"{column}_{k + 1}"].tolist()
    assert [line.get_color() for line in handles] == list(SWARM_COLOURS[:2])


def test_samples_without_the_columns_are_an_error() -> None:
    with pytest.raises(InputError, match=r"samples=\['time'\]: must have the columns time and pucks_1"):
        pucks_over_time(pd.DataFrame({"time": [0.0]}))


def test_conflicts_of_a_datacollector_can_be_drawn(model: ForagingModel) -> None:
    conflicts = model.datacollector.get_table_dataframe("conflicts")
    network = meeting_network(conflicts)
    assert set(network) <= set(range(8))
    assert jams(conflicts)["largest"].max() <= 8
    figures = (
        networks.network_figure(network),
        emergence.choices_figure(conflicts),
        emergence.values_figure(conflicts),
        maps.heat_map_figure(conflicts, arena=model.arena),
    )
    assert all(encode(figure, "png").startswith(b"\x89PNG") for figure in figures)
