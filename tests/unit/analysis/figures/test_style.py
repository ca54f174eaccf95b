"""Figures do not depend on a user's settings of matplotlib, nor on unusual names."""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib import cycler
from matplotlib.figure import Figure

from kswarms.agents.theory.games import NormalForm, extensive_form
from kswarms.analysis.figures.emergence import choices_figure
from kswarms.analysis.figures.files import encode
from kswarms.analysis.figures.game_forms import draw_extensive_form
from kswarms.analysis.figures.heat_maps import heat_map_figure
from kswarms.analysis.figures.over_n import figure_of
from kswarms.analysis.figures.style import figure_text
from tests.helpers.result_rows import PLACED, learning_conflicts, runs_of

SETTINGS = {
    "text.usetex": True,
    "font.size": 30.0,
    "font.family": ["no such font"],
    "savefig.dpi": 10.0,
    "savefig.bbox": "tight",
    "savefig.transparent": True,
    "figure.facecolor": "red",
    "axes.prop_cycle": cycler(color=["red"]),
    "axes.formatter.use_mathtext": True,
    "xtick.labelsize": 30.0,
    "svg.fonttype": "none",
    "path.sketch": (1.0, 1.0, 1.0),
    "lines.linewidth": 9.0,
}
FORM = NormalForm(("flight", "fight"), ("flight", "fight"), np.zeros((2, 2)), np.zeros((2, 2)))
FIGURES: dict[str, Callable[[], Figure]] = {
    "curves": lambda: figure_of(runs_of("fig-6.1a", seeds=2), "fig-6.1a", "A title"),
    "heat map": lambda: heat_map_figure(PLACED, "places"),
    "choices": lambda: choices_figure(learning_conflicts(), "choices"),
    "extensive form": lambda: draw_extensive_form(extensive_form({1: FORM})),
}


@pytest.mark.parametrize("draw", FIGURES.values(), ids=FIGURES)
def test_settings_of_a_user_neither_change_a_figure_nor_are_changed(draw: Callable[[], Figure]) -> None:
    expected = encode(draw(), "svg")
    with mpl.rc_context(SETTINGS):
        before = dict(mpl.rcParams)
        assert encode(draw(), "svg") == expected
        assert dict(mpl.rcParams) == before


@pytest.mark.parametrize("name", [r"$\frac$", "$", "a_b^c {", "\\n", "%", "x" * 5000])
def test_any_name_can_be_drawn(name: str) -> None:
    runs = runs_of(name, swarms=(2,), densities=[6], seeds=1, conditions=[name, "b"])
    assert encode(figure_of(runs, name, f"{name}\u202e\x1b\ud800"), "svg")


def test_a_text_of_a_figure_is_one_line_of_limited_length() -> None:
    assert figure_text("N = 5, Δ") == "N = 5, Δ"
    assert figure_text("a\n\x1b[2J") == "a\\n\\x1b[2J"
    assert figure_text("x" * 5000) == "x" * 199 + "…"


@pytest.mark.slow
def test_an_unknown_backend_does_not_stop_the_command_line(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "kswarms.scenarios.cli", "report", str(tmp_path)]
    environment = os.environ | {"MPLBACKEND": "nonsense"}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "must be a directory that holds runs.parquet" in done.stderr
    assert len(done.stderr.splitlines()) == 1
