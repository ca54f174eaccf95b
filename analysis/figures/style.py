"""Style of the figures over the number of robots: curves, line styles, headings and legends.

A curve is the mean over the seeds. With `detail`, a band shows the 95 % interval of the mean, and light
points show the single seeds. Line styles are those of the source: S1 green, dashed, open circles; S2 red,
dashed, filled circles; S3 blue, dash-dotted, triangles.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from itertools import pairwise
from textwrap import fill
from typing import Any, Final

import matplotlib as mpl
import pandas as pd
import seaborn as sns
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from kswarms.agents.common.quoting import for_terminal
from kswarms.analysis.colours import swarm_colour
from kswarms.analysis.measures.quantities import Curve
from kswarms.analysis.statistics.intervals import min_seeds
from kswarms.analysis.statistics.means import mean_by_group
from kswarms.analysis.text_tables import span

CONDITION_COLOURS: Final = tuple(sns.color_palette("colorblind").as_hex())
_CONDITION_MARKERS: Final = "os^DvPX"

LITERAL_TEXT: Final = {"text.parse_math": False}
"""Setting for names of users, which may contain dollar signs."""
_MAX_TICKS: Final = 16
"""Maximum number of ticks; with more densities, matplotlib chooses the ticks."""
_MAX_GAP: Final = 4
"""Maximum gap between densities (robots); single seeds are shifted by at most a quarter of the gap."""
_LONGEST_HEADING: Final = 450
_LEGEND_LINE, _LETTER = 0.75, 0.08
"""Width of the line and of a letter in a legend (inches)."""


@dataclass(frozen=True)
class LineStyle:
    """Colour, line style and marker of a curve, as matplotlib names them."""

    colour: str
    line: str
    marker: str
    filled: bool = True


_SWARM_LINES: Final = (("--", "o", False), ("--", "o"), ("-.", "^"), (":", "s"), ("-", "D"), ("-.", "v"))
"""Line style, marker and whether it is filled (default: True), by swarm."""


def swarm_style(swarm: int) -> LineStyle:
    """Return the line style of a swarm, counted from 1."""
    return LineStyle(swarm_colour(swarm), *_SWARM_LINES[(swarm - 1) % len(_SWARM_LINES)])


def condition_style(index: int, swarm: int | None = None) -> LineStyle:
    """Return the line style of a condition, counted from 0.

    With a swarm, line and marker are those of the swarm. Otherwise the line is solid, and the marker differs
    by condition.
    """
    colour = CONDITION_COLOURS[index % len(CONDITION_COLOURS)]
    if swarm is not None:
        return replace(swarm_style(swarm), colour=colour)
    return LineStyle(colour, "-", _CONDITION_MARKERS[index % len(_CONDITION_MARKERS)])


def curve_style(curve: Curve) -> LineStyle:
    """Return the line style of a curve: by condition if there are several, otherwise by swarm."""
    if curve.condition is not None:
        return condition_style(curve.condition, curve.swarm)
    assert curve.swarm is not None  # the only condition has a curve for each swarm
    return swarm_style(curve.swarm)


def draw_curves(axes: Axes, curves: Sequence[Curve], quantity: str, detail: bool = True) -> None:
    """Draw the mean of a quantity over `n`; with `detail`, also its interval and the single seeds."""
    densities = sorted({n for curve in curves for n in curve.rows["n"]})
    gap = min([_MAX_GAP, *(right - left for left, right in pairwise(densities))])
    for index, curve in enumerate(curves):
        style, rows = curve_style(curve), curve.rows
        # Shift the seeds of each curve, so that they do not hide those of another.
        shift = gap * 0.5 * ((index + 0.5) / len(curves) - 0.5)
        seeds = rows["seed"].nunique()
        points = mean_by_group(rows, ["n"], quantity)
        if seeds > 1 and detail:
            # Seeds can have equal values, so points are lighter the more seeds there are.
            alpha = min(0.25, max(0.05, 5 / seeds))
            axes.scatter(rows["n"] + shift, rows[quantity], s=9, color=style.colour, alpha=alpha, lw=0)
            axes.fill_between(points["n"], points["low"], points["high"], color=style.colour, alpha=0.2, lw=0)
            if len(points) == 1:  # the band has no width
                axes.vlines(points["n"] + shift, points["low"], points["high"], color=style.colour)
        draw_line(axes, points["n"], points["mean"], style, curve.label)
    if len(densities) <= _MAX_TICKS:
        axes.set_xticks(densities)
    axes.set_xlim(densities[0] - 0.6 * gap, densities[-1] + 0.6 * gap)
    axes.set_xlabel("number of robots in all, N")


def draw_line(axes: Axes, x: pd.Series, y: pd.Series, style: LineStyle, label: str) -> None:
    """Draw a curve with its markers."""
    axes.plot(
        x.to_numpy(),
        y.to_numpy(),
        label=label,
        color=style.colour,
        linestyle=style.line,
        marker=style.marker,
        markersize=6,
        markerfacecolor=style.colour if style.filled else "white",
        markeredgecolor=style.colour,
    )


def scale_from_zero(axes: Axes, values: pd.Series) -> None:
    """Start the vertical axis at 0, with space for the markers at both ends."""
    top = values.max() or 1.0
    axes.set_ylim(-0.02 * top, 1.06 * top)


def heading(scenario: str, title: str) -> str:
    """Return the heading of a scenario: its id and, if given, its title."""
    return f"{scenario}: {title}" if title else scenario


@contextmanager
def default_settings(changes: Mapping[Any, Any] | None = None) -> Iterator[None]:
    """Use matplotlib's default settings with some changes, then restore those of the user.

    So neither a user's `matplotlibrc` nor a notebook changes figures of the package.
    """
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(changes or {})
        yield


@contextmanager
def new_figure(title: str, width: float = 7.0, height: float = 4.9) -> Iterator[Figure]:
    """Yield a new figure with a heading, in the style of the package; width and height are in inches."""
    with (
        default_settings(LITERAL_TEXT),
        sns.axes_style("whitegrid", rc={"grid.color": "0.9"}),
        sns.plotting_context("notebook", font_scale=0.9),
    ):
        figure = Figure(figsize=(width, height), layout="constrained")
        heading_text = figure_text(title, _LONGEST_HEADING)
        figure.suptitle(fill(heading_text, width=int(10 * width), break_on_hyphens=False))
        yield figure


def figure_text(text: str, longest: int = 200) -> str:
    """Return a name as one line for a figure, with escaped control characters, cut to `longest` letters."""
    line = for_terminal(text[: longest + 1])
    return line if len(line) <= longest else f"{line[: longest - 1]}…"


def legend_below(figure: Figure, title: str = "") -> None:
    """Place one legend for all axes below them; entries with the same label appear once."""
    entries: dict[str, Any] = {}
    for axes in figure.axes:
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
            entries.setdefault(label, handle)
    width = figure.get_figwidth() - _LEGEND_LINE
    labels = [figure_text(label) for label in entries]
    column = _LEGEND_LINE + _LETTER * max(map(len, labels), default=0)
    figure.legend(
        list(entries.values()),
        [fill(label, width=int(width / _LETTER), break_on_hyphens=False) for label in labels],
        title=title,
        loc="outside lower center",
        ncols=max(1, min(len(entries), 3, int(figure.get_figwidth() / column))),
        handlelength=3.5,
    )


def seeds_legend_title(rows: pd.DataFrame, detail: bool) -> str:
    """Return the legend title: number of seeds; with `detail`, also the meaning of band and points."""
    counts = rows.groupby(["condition", "n"])["seed"].nunique()
    low, high = counts.min(), counts.max()
    if high == 1:
        return "one seed"
    mean = f"mean of {span(low, high)} seeds"
    if not detail:
        return mean
    band = ", band: its 95 % interval" if high >= min_seeds() else ""
    return f"{mean}{band}, points: single seeds"
