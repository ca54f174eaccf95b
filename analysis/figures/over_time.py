"""Figures of one game over its time, from the samples of a model's DataCollector.

`model.datacollector.get_model_vars_dataframe()` has the column `time` (s) and, for each swarm k, `pucks_k`,
`sud_k` and `share_a_k`.
"""

import pandas as pd
from matplotlib.figure import Figure
from pandas.api.types import is_numeric_dtype

from kswarms.agents.common.errors import InputError
from kswarms.analysis.figures.style import draw_line, legend_below, new_figure, swarm_style
from kswarms.analysis.results.tables import require_columns


def pucks_over_time(samples: pd.DataFrame, title: str = "") -> Figure:
    """Draw the pucks deposited by each swarm over the time of a game.

    Parameters
    ----------
    samples : pandas.DataFrame
        Samples of a model; `InputError` if a column is missing.
    title : str
        Heading.
    """
    return _over_time(samples, "pucks", "pucks deposited by the swarm", title)


def sud_over_time(samples: pd.DataFrame, title: str = "") -> Figure:
    """Draw the Swarm Utility Difference (Eq. 3.7) of each swarm over the time of a game.

    Parameters and errors are those of `pucks_over_time`.
    """
    figure = _over_time(samples, "sud", "SUD (pucks)", title)
    figure.axes[0].axhline(0, color="0.4", linewidth=1)
    return figure


def time_share_over_time(samples: pd.DataFrame, title: str = "") -> Figure:
    """Draw the share of time that each swarm has spent in conflict so far, T(a) / (T(a) + T(p)).

    Parameters and errors are those of `pucks_over_time`.
    """
    figure = _over_time(samples, "share_a", "share of time in conflict so far", title)
    figure.axes[0].set_ylim(-0.02, 1.02)
    return figure


def _over_time(samples: pd.DataFrame, quantity: str, label: str, title: str) -> Figure:
    require_columns(samples, "samples", [])
    columns = samples.filter(regex=rf"^{quantity}_\d+$").columns
    swarms = sorted(int(name.rpartition("_")[2]) for name in columns)
    if not swarms or "time" not in samples:
        raise InputError("samples", list(samples), f"must have the columns time and {quantity}_1")
    for name in ("time", *columns):
        if not is_numeric_dtype(samples[name]):
            field = f"samples column {name}"
            raise InputError(field, str(samples[name].dtype), "must be a column of numbers")
    with new_figure(title) as figure:
        axes = figure.subplots()
        for swarm in swarms:
            draw_line(axes, samples["time"], samples[f"{quantity}_{swarm}"], swarm_style(swarm), f"S{swarm}")
            axes.lines[-1].set_markevery(max(1, len(samples) // 12))  # dense markers would hide the line
        axes.set(xlabel="time (s)", ylabel=label)
        legend_below(figure)
    return figure
