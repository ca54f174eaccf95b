"""How a figure over the number of robots is drawn: its page, its curves and their forms.

A curve is the mean over the seeds, its band the 95 % bootstrap interval of that mean, and light points
are the single seeds. Swarms have the form of the source: S1 green, dashed, open circles; S2 red, dashed,
filled circles; a third swarm blue, dash-dotted, triangles. `SAFE` keeps lines and markers and changes the
colours to some that the colour-blind tell apart; `SOURCE` leaves out bands and points.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from itertools import pairwise
from textwrap import fill
from typing import Final

import matplotlib as mpl
import pandas as pd
import seaborn as sns
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from kswarms.agents.user_code.syntax import split_outside
from kswarms.analysis.statistics.means import summary
from kswarms.analysis.text_tables import span

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


@dataclass(frozen=True)
class Look:
    """How figures look.

    Attributes
    ----------
    safe : bool
        Whether swarms have colours that the colour-blind tell apart, in place of the source's green and red.
    detail : bool
        Whether intervals and single seeds are drawn, or the means alone, as in the source.
    """

    safe: bool = False
    detail: bool = True

    def of_swarm(self, swarm: int) -> Form:
        """Return the form of a swarm, from 1."""
        index = (swarm - 1) % len(SWARM_FORMS)
        form = SWARM_FORMS[index]
        return replace(form, colour=SAFE_COLOURS[index]) if self.safe else form


DETAILED: Final = Look()
"""Intervals and seeds, in the source's colours."""
SOURCE: Final = Look(detail=False)
"""The source's own form."""
SAFE: Final = Look(safe=True)
"""Intervals and seeds, in colours that the colour-blind tell apart."""

SWARM_FORMS = (
    Form("green", "--", "o", filled=False),
    Form("red", "--", "o"),
    Form("blue", "-.", "^"),
    Form("darkorange", ":", "s"),
    Form("purple", "-", "D"),
    Form("saddlebrown", "-.", "v"),
)
# Okabe and Ito's.
SAFE_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#E69F00", "#CC79A7", "#56B4E9")
CONDITION_COLOURS = tuple(sns.color_palette("colorblind").as_hex())
CONDITION_MARKERS = "os^DvPX"


@dataclass(frozen=True)
class Curve:
    """The rows of one curve, its name in the legend and its form."""

    label: str
    rows: pd.DataFrame
    form: Form


def curves_of(rows: pd.DataFrame, look: Look = DETAILED) -> list[Curve]:
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
            label = f"S{swarm}: {', '.join(dict.fromkeys(map(brief, of_curve['policy'])))}"
            form = look.of_swarm(swarm)
            if len(conditions) > 1:
                label = f"{condition or '–'}, {label}" if several_swarms else condition or label
                form = form_of_condition(index, form if several_swarms else None)
            curves.append(Curve(label, of_curve, form))
    return curves


def form_of_condition(index: int, of_swarm: Form | None = None) -> Form:
    """Return the form of a condition, from 0: its colour, with line and marker of a swarm if one is given."""
    colour = CONDITION_COLOURS[index % len(CONDITION_COLOURS)]
    if of_swarm is not None:
        return replace(of_swarm, colour=colour)
    return Form(colour, "-", CONDITION_MARKERS[index % len(CONDITION_MARKERS)])


def brief(policy: str) -> str:
    """Return a policy without its arguments and the path of its file, which are too long for a legend."""
    return "+".join(part.partition("(")[0].rpartition(":")[2] for part in split_outside(policy, "+"))


def draw_curves(axes: Axes, curves: Sequence[Curve], quantity: str, look: Look = DETAILED) -> None:
    """Draw a column of the curves' rows over `n`, in detail with its mean's interval and the seeds."""
    densities = sorted({n for curve in curves for n in curve.rows["n"]})
    gap = min([_WIDEST_GAP, *(right - left for left, right in pairwise(densities))])
    for index, curve in enumerate(curves):
        form, rows = curve.form, curve.rows
        # Side by side, or the seeds of one curve would hide those of another.
        shift = gap * 0.5 * ((index + 0.5) / len(curves) - 0.5)
        seeds = rows["seed"].nunique()
        points = summary(rows, quantity, by=())
        if seeds > 1 and look.detail:
            # Hundreds of seeds, of which many share a value, need a lighter touch than twenty.
            alpha = min(0.25, max(0.05, 5 / seeds))
            axes.scatter(rows["n"] + shift, rows[quantity], s=9, color=form.colour, alpha=alpha, linewidths=0)
            axes.fill_between(
                points["n"], points["low"], points["high"], color=form.colour, alpha=0.2, linewidth=0
            )
            if len(points) == 1:  # a band of no width
                axes.vlines(points["n"] + shift, points["low"], points["high"], color=form.colour)
        draw_line(axes, points["n"], points["mean"], form, curve.label)
    if len(densities) <= _MOST_TICKS:
        axes.set_xticks(densities)
    axes.set_xlim(densities[0] - 0.6 * gap, densities[-1] + 0.6 * gap)
    axes.set_xlabel("number of robots in all, N")


def draw_line(axes: Axes, across: pd.Series, up: pd.Series, form: Form, label: str) -> None:
    """Draw a curve with its markers."""
    axes.plot(
        across.to_numpy(),
        up.to_numpy(),
        label=label,
        color=form.colour,
        linestyle=form.line,
        marker=form.marker,
        markersize=6,
        markerfacecolor=form.colour if form.filled else "white",
        markeredgecolor=form.colour,
    )


def scale_from_zero(axes: Axes, values: pd.Series) -> None:
    """Let the vertical axis begin at 0, with room for whole markers at either end."""
    top = values.max() or 1.0
    axes.set_ylim(-0.02 * top, 1.06 * top)


def heading(scenario: str, title: str) -> str:
    """Return what stands above a figure of a scenario: its id and what it is, as far as that is known."""
    return f"{scenario}: {title}" if title else scenario


@contextmanager
def sheet(title: str, width: float = 7.0, height: float = 4.9) -> Iterator[Figure]:
    """Open a figure with a heading, of a size in inches, in the house's style."""
    with (
        sns.axes_style("whitegrid", rc={"grid.color": "0.9"}),
        sns.plotting_context("notebook", font_scale=0.9),
        mpl.rc_context({"text.parse_math": False}),  # a user's title may have a dollar in it
    ):
        figure = Figure(figsize=(width, height), layout="constrained")
        figure.suptitle(fill(title, width=int(10 * width), break_on_hyphens=False))
        yield figure


@contextmanager
def page(rows: pd.DataFrame, title: str, width: float = 7.0, look: Look = DETAILED) -> Iterator[Figure]:
    """Open a figure with a heading; when the caller has drawn its axes, put the legend below them.

    Parameters
    ----------
    rows : pandas.DataFrame
        The rows shown; the legend says how many seeds they have.
    title : str
        Heading of the figure, broken into lines where it is long.
    width : float
        Inches.
    look : Look
        The legend explains what is drawn in it.
    """
    with sheet(title, width) as figure:
        yield figure
        legend_below(figure, _seeds(rows, look))


def legend_below(figure: Figure, title: str = "") -> None:
    """Put the legend of a figure's first axes below all of them."""
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(
        handles,
        labels,
        title=title,
        loc="outside lower center",
        ncols=min(len(labels), 3),
        handlelength=3.5,
    )


def _seeds(rows: pd.DataFrame, look: Look) -> str:
    counts = rows.groupby(["condition", "n"])["seed"].nunique()
    low, high = counts.min(), counts.max()
    if high == 1:
        return "one seed"
    mean = f"mean of {span(low, high)} seeds"
    return f"{mean}, band: its 95 % interval, points: single seeds" if look.detail else mean
