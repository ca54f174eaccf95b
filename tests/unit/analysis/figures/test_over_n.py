"""Figures over the number of robots."""

from pathlib import Path

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PathCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from kswarms.agents.common.errors import InputError
from kswarms.analysis.colours import SWARM_COLOURS
from kswarms.analysis.figures.files import encode
from kswarms.analysis.figures.over_n import figure_of, pucks_over_n, sud_over_n, time_shares, write_figures
from kswarms.analysis.measures.quantities import TIME_SHARES, shown_quantities
from tests.helpers.legends import legend_texts
from tests.helpers.result_rows import DENSITIES, runs_of


def curves(axes: Axes) -> dict[str, Line2D]:
    """Return the curves by their names in the legend."""
    handles, labels = axes.get_legend_handles_labels()
    return dict(zip(labels, handles, strict=True))


def heights(line: Line2D) -> list[float]:
    return [float(value) for value in np.asarray(line.get_ydata())]


def points(axes: Axes) -> list[np.ndarray]:
    """Return the single seeds (n, value) of each curve."""
    drawn = [each for each in axes.collections if isinstance(each, PathCollection)]
    return [np.asarray(each.get_offsets()) for each in drawn]


def legend_title(figure: Figure) -> str:
    return figure.legends[0].get_title().get_text()


def test_swarms_have_the_line_styles_of_the_source() -> None:
    (axes,) = pucks_over_n(runs_of("fig-x", swarms=(1, 2, 3)), "fig-x").axes
    forms = {
        label: (line.get_color(), line.get_linestyle(), line.get_marker(), line.get_markerfacecolor())
        for label, line in curves(axes).items()
    }
    green, red, blue, *_ = SWARM_COLOURS
    assert forms == {
        "S1: avoid": (green, "--", "o", "white"),
        "S2: attack": (red, "--", "o", red),
        "S3: aggressive": (blue, "-.", "^", blue),
    }


def test_a_curve_is_the_mean_over_the_seeds_of_its_scenario() -> None:
    runs = pd.concat([runs_of("fig-x"), runs_of("fig-y").assign(pucks=0)])
    (axes,) = pucks_over_n(runs, "fig-x").axes
    assert heights(curves(axes)["S1: avoid"]) == [16, 26, 36]
    assert heights(curves(axes)["S2: attack"]) == [26, 36, 46]


def test_each_seed_is_a_point_near_its_density() -> None:
    (axes,) = pucks_over_n(runs_of("fig-x"), "fig-x").axes
    of_s1, of_s2 = points(axes)
    assert sorted(of_s1[:, 1]) == [15, 15, 17, 17, 25, 25, 27, 27, 35, 35, 37, 37]
    assert set(of_s1[:, 0]).isdisjoint(of_s2[:, 0])
    for seeds in (of_s1, of_s2):
        assert np.abs(seeds[:, 0] - np.repeat(DENSITIES, 4)).max() <= 1


def test_a_band_is_an_interval_of_the_mean_and_ignores_the_order_of_rows() -> None:
    runs = runs_of("fig-x", seeds=8)
    runs["pucks"] += np.random.default_rng(3).integers(0, 9, len(runs))
    bands = []
    for shuffled in (runs, runs.sample(frac=1, random_state=1)):
        (axes,) = pucks_over_n(shuffled.sort_values("swarm", kind="stable"), "fig-x").axes
        band = next(drawn for drawn in axes.collections if isinstance(drawn, PolyCollection))
        bands.append(np.asarray(band.get_paths()[0].vertices))
    assert np.array_equal(bands[0], bands[1])
    at_6 = runs[(runs["n"] == 6) & (runs["swarm"] == 1)]["pucks"]
    edges = bands[0][bands[0][:, 0] == 6][:, 1]
    assert at_6.min() < edges.min() < at_6.mean() < edges.max() < at_6.max()


def test_each_condition_of_one_swarm_has_a_curve() -> None:
    figure = pucks_over_n(runs_of("fig-x", swarms=(1,), conditions=("flight 50 ms", "fight")), "fig-x")
    (axes,) = figure.axes
    assert legend_texts(figure) == ["flight 50 ms", "fight"]
    assert heights(curves(axes)["fight"]) == [116, 126, 136]
    assert len({line.get_color() for line in curves(axes).values()}) == 2


def test_conditions_of_several_swarms_have_the_markers_of_the_swarms() -> None:
    figure = pucks_over_n(runs_of("fig-x", conditions=("", "delta=0.1")), "fig-x")
    *_, first, second = names = legend_texts(figure)
    assert names == ["–, S1: avoid", "–, S2: attack", "delta=0.1, S1: avoid", "delta=0.1, S2: attack"]
    (axes,) = figure.axes
    open_marker, filled = curves(axes)[first], curves(axes)[second]
    assert open_marker.get_markerfacecolor() == "white"
    assert filled.get_markerfacecolor() == filled.get_color() == open_marker.get_color()


def test_the_legend_omits_the_arguments_of_a_policy() -> None:
    for policy, name in (
        ("""avoid+inter-learner(reward="wlu(delta=0.1, b=1.5)", rule='ucb')""", "avoid+inter-learner"),
        ("far/away/my_file.py:Cautious(note='a:b')", "Cautious"),
    ):
        runs = runs_of("fig-x").replace({"policy": {"attack": policy}})
        assert legend_texts(pucks_over_n(runs, "fig-x")) == ["S1: avoid", f"S2: {name}"]


def test_the_figure_has_axis_labels_a_title_and_the_number_of_seeds() -> None:
    runs = runs_of("fig-x")
    figure = pucks_over_n(runs, "fig-x", "a title that is far too long for one line of the figure " * 2)
    (axes,) = figure.axes
    assert axes.get_xlabel() == "number of robots in all, N"
    assert axes.get_ylabel() == "pucks deposited by the swarm"
    assert figure.get_suptitle().startswith("fig-x: a title")
    assert max(map(len, figure.get_suptitle().splitlines())) <= 75
    hyphens = pucks_over_n(runs, "fig-x", "an inter-learner " * 8).get_suptitle()
    assert not any(line.endswith("inter-") for line in hyphens.splitlines())
    assert legend_title(figure).startswith("mean of 4 seeds")
    assert list(axes.get_xticks()) == [6, 16, 26]
    fewer = runs[(runs["n"] != 6) | (runs["seed"] == 0)]
    assert legend_title(pucks_over_n(fewer, "fig-x")).startswith("mean of 1 to 4 seeds")
    assert pucks_over_n(runs, "fig-x").get_suptitle() == "fig-x"


def test_a_single_density_has_bars_as_intervals() -> None:
    figure = pucks_over_n(runs_of("fig-x", densities=[20], seeds=8), "fig-x")
    bars = [drawn for drawn in figure.axes[0].collections if isinstance(drawn, LineCollection)]
    ends = [sorted(segment[:, 1]) for drawn in bars for segment in drawn.get_segments()]
    assert [low < mean < high for (low, high), mean in zip(ends, (30, 40), strict=True)] == [True, True]


def test_a_single_seed_without_pucks_can_be_drawn() -> None:
    figure = pucks_over_n(runs_of("fig-x", densities=[20], seeds=1).assign(pucks=0), "fig-x")
    (axes,) = figure.axes
    assert legend_title(figure) == "one seed"
    assert points(axes) == []
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    assert left < 20 < right
    assert low < 0 < high


def test_matplotlib_chooses_the_ticks_of_many_densities() -> None:
    (axes,) = pucks_over_n(runs_of("fig-x", densities=range(2, 82, 2), seeds=2), "fig-x").axes
    assert len(axes.get_xticks()) < 20


def test_time_shares_have_a_panel_for_each_kind_of_conflict() -> None:
    figure = time_shares(runs_of("fig-6.3"), "fig-6.3")
    assert [axes.get_title() for axes in figure.axes] == ["total", "inter-swarm", "intra-swarm"]
    for axes, first, second in zip(figure.axes, (0.075, 0.05, 0.025), (0.15, 0.1, 0.05), strict=True):
        assert heights(curves(axes)["S1: avoid"]) == pytest.approx([first] * 3)
        assert heights(curves(axes)["S2: attack"]) == pytest.approx([second] * 3)
    assert figure.axes[0].get_ylabel() == "share of time, T(a) / (T(a) + T(p))"
    assert legend_texts(figure) == ["S1: avoid", "S2: attack"]


def test_sud_is_drawn_for_the_second_swarm_by_condition() -> None:
    runs = runs_of("fig-7.10", swarms=(1, 2, 3), conditions=("avoid", "delta=0.1"))
    figure = sud_over_n(runs, "fig-7.10")
    (axes,) = figure.axes
    assert legend_texts(figure) == ["avoid", "delta=0.1"]
    assert heights(curves(axes)["avoid"]) == [-14, -4, 6]
    assert axes.get_ylabel() == "SUD of S2 (pucks)"
    (of_s3,) = sud_over_n(runs, "fig-7.10", swarm=3).axes
    assert heights(curves(of_s3)["avoid"]) == [-24, -14, -4]


@pytest.mark.parametrize("draw", [pucks_over_n, time_shares, sud_over_n])
def test_a_scenario_without_runs_is_an_error(draw: type) -> None:
    with pytest.raises(InputError, match=r"scenario='fig-6\.9': must be one of fig-x, fig-y"):
        draw(pd.concat([runs_of("fig-y"), runs_of("fig-x")]), "fig-6.9")


def test_an_unknown_swarm_is_an_error() -> None:
    with pytest.raises(InputError, match=r"swarm=2: must be one of 1 in fig-6\.15"):
        sud_over_n(runs_of("fig-6.15", swarms=(1,)), "fig-6.15")


@pytest.mark.slow
def test_write_figures_writes_each_scenario_with_runs_and_keeps_settings(tmp_path: Path) -> None:
    settings = dict(mpl.rcParams)
    runs = pd.concat([runs_of("fig-6.1a"), runs_of("fig-6.3"), runs_of("fig-7.10"), runs_of("fig-7.12")])
    runs.to_parquet(tmp_path / "runs.parquet")
    paths = write_figures(tmp_path, tmp_path / "figures", ["fig-7.10", "fig-6.3", "fig-7.1", "fig-6.1a"])
    assert paths == [tmp_path / "figures" / f"{name}.png" for name in ("fig-7.10", "fig-6.3", "fig-6.1a")]
    assert set(paths) == set((tmp_path / "figures").iterdir())
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in paths)
    assert dict(mpl.rcParams) == settings
    assert plt.get_fignums() == []


@pytest.mark.parametrize(
    ("scenarios", "shown", "label"),
    [
        ("6.2 6.4a 6.15", ("pucks",), "pucks deposited by the swarm"),
        ("6.3", TIME_SHARES, "share of time"),
        ("6.10a 6.10b 6.12 6.14 7.4 7.6 7.8 7.10 7.11 7.19", ("sud",), "SUD of S2 (pucks)"),
    ],
)
def test_the_figure_of_a_scenario_shows_the_quantity_of_the_source(
    scenarios: str, shown: tuple[str, ...], label: str
) -> None:
    for scenario in (f"fig-{number}" for number in scenarios.split()):
        figure = figure_of(runs_of(scenario), scenario, "its title")
        assert figure.axes[0].get_ylabel().startswith(label)
        assert figure.get_suptitle() == f"{scenario}: its title"
        assert shown_quantities(scenario) == shown


def test_without_detail_a_figure_shows_only_means() -> None:
    figure = pucks_over_n(runs_of("fig-x"), "fig-x", detail=False)
    (axes,) = figure.axes
    assert list(axes.collections) == []
    assert heights(curves(axes)["S1: avoid"]) == [16, 26, 36]
    assert curves(axes)["S1: avoid"].get_color() == SWARM_COLOURS[0]
    assert legend_title(figure) == "mean of 4 seeds"


@pytest.mark.parametrize("length", [10, 40, 120])
def test_the_legend_is_not_wider_than_the_figure(length: int) -> None:
    conditions = [f"{letter} " * (length // 2) for letter in "abcd"]
    figure = pucks_over_n(runs_of("fig-x", swarms=(1,), conditions=conditions), "fig-x")
    encode(figure, "png")
    box = figure.legends[0].get_window_extent()
    assert 0 <= box.x0 < box.x1 <= figure.bbox.width
