"""How a figure over the number of robots is drawn: its page, its curves and their forms.

A curve is the mean over the seeds, its band the 95 % bootstrap interval of that mean, and light points
are the single seeds. Swarms have the form of the source: S1 green, dashed, open circles; S2 red, dashed,
filled circles; a third swarm blue, dash-dotted, triangles.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import pairwise
from textwrap import fill

import pandas as pd
import seaborn as sns
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from agents.calls import split_outside

_BOOTSTRAP_SEED = 0
_MOST_TICKS = 16
# Robots: seeds are drawn at most a quarter of this from their density, however far the next one is.
_WIDEST_GAP = 4


@dataclass(frozen=True)
class Form:
    """How a curve is drawn: matplotlib's names of a colour, a line style and a marker."""

    colour: str
    line: str
    marker: str
    filled: bool = True


SWARM_FORMS = (
    Form("green", "--", "o", filled=False),
    Form("red", "--", "o"),
    Form("blue", "-.", "^"),
    Form("darkorange", ":", "s"),
    Form("purple", "-", "D"),
    Form("saddlebrown", "-.", "v"),
)
CONDITION_COLOURS = tuple(sns.color_palette("colorblind").as_hex())
CONDITION_MARKERS = "os^DvPX"


@dataclass(frozen=True)
class Curve:
    """The rows of one curve, its name in the legend and its form."""

    label: str
    rows: pd.DataFrame
    form: Form


def curves_of(rows: pd.DataFrame) -> list[Curve]:
    """Split the rows of a scenario into curves.

    One condition gives a curve for each swarm in the source's form. Several give a curve for each condition
    and swarm: the condition has the colour, the swarm (if there are several) the line and the marker.
    """
    conditions = list(dict.fromkeys(rows["condition"]))
    several_swarms = len(set(rows["swarm"])) > 1
    curves = []
    for index, condition in enumerate(conditions):
        of_condition = rows[rows["condition"] == condition]
        for swarm in sorted(set(of_condition["swarm"])):
            of_curve = of_condition[of_condition["swarm"] == swarm]
            label = f"S{swarm}: {', '.join(dict.fromkeys(map(_brief, of_curve['policy'])))}"
            form = SWARM_FORMS[(swarm - 1) % len(SWARM_FORMS)]
            if len(conditions) > 1:
                colour = CONDITION_COLOURS[index % len(CONDITION_COLOURS)]
                if several_swarms:
                    label = f"{condition or '–'}, {label}"
                    form = Form(colour, form.line, form.marker, form.filled)
                else:
                    label = condition or label
                    form = Form(colour, "-", CONDITION_MARKERS[index % len(CONDITION_MARKERS)])
            curves.append(Curve(label, of_curve, form))
    return curves


def _brief(policy: str) -> str:
    """Return a policy without its arguments and the path of its file, which are too long for a legend."""
    return "+".join(part.partition("(")[0].rpartition(":")[2] for part in split_outside(policy, "+"))


def draw_curves(axes: Axes, curves: Sequence[Curve], quantity: str) -> None:
    """Draw a column of the curves' rows over `n`, with the interval of its mean and the seeds as points."""
    densities = sorted({n for curve in curves for n in curve.rows["n"]})
    gap = min([_WIDEST_GAP, *(right - left for left, right in pairwise(densities))])
    for index, curve in enumerate(curves):
        form, rows = curve.form, curve.rows
        # Side by side, or the seeds of one curve would hide those of another.
        shift = gap * 0.5 * ((index + 0.5) / len(curves) - 0.5)
        seeds = rows["seed"].nunique()
        if seeds > 1:
            # Hundreds of seeds, of which many share a value, need a lighter touch than twenty.
            alpha = min(0.25, max(0.05, 5 / seeds))
            axes.scatter(rows["n"] + shift, rows[quantity], s=9, color=form.colour, alpha=alpha, linewidths=0)
        sns.lineplot(
            x=rows["n"].to_numpy(),
            y=rows[quantity].to_numpy(),
            ax=axes,
            errorbar=("ci", 95),
            sort=True,  # by value too: the bootstrap then does not depend on the order of rows
            seed=_BOOTSTRAP_SEED,
            label=curve.label,
            legend=False,
            color=form.colour,
            linestyle=form.line,
            marker=form.marker,
            markersize=6,
            markerfacecolor=form.colour if form.filled else "white",
            markeredgecolor=form.colour,
        )
    if len(densities) <= _MOST_TICKS:
        axes.set_xticks(densities)
    axes.set_xlim(densities[0] - 0.6 * gap, densities[-1] + 0.6 * gap)
    axes.set_xlabel("number of robots in all, N")


def scale_from_zero(axes: Axes, values: pd.Series) -> None:
    """Let the vertical axis begin at 0, with room for whole markers at either end."""
    top = values.max() or 1.0
    axes.set_ylim(-0.02 * top, 1.06 * top)


@contextmanager
def page(rows: pd.DataFrame, heading: str, width: float = 7.5) -> Iterator[Figure]:
    """Open a figure with a heading; when the caller has drawn its axes, put the legend below them.

    Parameters
    ----------
    rows : pandas.DataFrame
        The rows shown; the legend says how many seeds they have.
    heading : str
        Title of the figure, broken into lines where it is long.
    width : float
        Inches.
    """
    with (
        sns.axes_style("whitegrid", rc={"grid.color": "0.9"}),
        sns.plotting_context("notebook", font_scale=0.9),
    ):
        figure = Figure(figsize=(width, 5.0), layout="constrained")
        figure.suptitle(fill(heading, width=int(10 * width), break_on_hyphens=False))
        yield figure
        handles, labels = figure.axes[0].get_legend_handles_labels()
        figure.legend(
            handles,
            labels,
            title=_seeds(rows),
            loc="outside lower center",
            ncols=min(len(labels), 3),
            handlelength=3.5,
        )


def _seeds(rows: pd.DataFrame) -> str:
    counts = rows.groupby(["condition", "n"])["seed"].nunique()
    low, high = counts.min(), counts.max()
    if high == 1:
        return "one seed"
    seeds = f"{low} to {high}" if low < high else f"{high}"
    return f"mean of {seeds} seeds, band: its 95 % interval, points: single seeds"
