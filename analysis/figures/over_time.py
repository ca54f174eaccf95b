"""One game over its time, from what a model's DataCollector holds: for notebooks.

The frame is `model.datacollector.get_model_vars_dataframe()`: `time` (s) and for each swarm k `pucks_k`,
`sud_k` and `share_a_k`.
"""

import pandas as pd
from matplotlib.figure import Figure

from kswarms.agents.common.errors import InputError
from kswarms.analysis.figures.style import DETAILED, Look, draw_line, legend_below, sheet


def pucks_over_time(samples: pd.DataFrame, title: str = "", look: Look = DETAILED) -> Figure:
    """Draw the pucks deposited by each swarm over the time of a game.

    Parameters
    ----------
    samples : pandas.DataFrame
        Samples of a model.
    title : str
        What it is of.
    look : Look
        Colours.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InputError
        `samples` have no such columns.
    """
    return _over_time(samples, "pucks", "pucks deposited by the swarm", title, look)


def sud_over_time(samples: pd.DataFrame, title: str = "", look: Look = DETAILED) -> Figure:
    """Draw the Swarm Utility Difference (Eq. 3.7) of each swarm over the time of a game.

    Parameters, returned value and errors are those of `pucks_over_time`.
    """
    figure = _over_time(samples, "sud", "SUD (pucks)", title, look)
    figure.axes[0].axhline(0, color="0.4", linewidth=1)
    return figure


def time_share_over_time(samples: pd.DataFrame, title: str = "", look: Look = DETAILED) -> Figure:
    """Draw the share of time that each swarm has spent in conflict so far, T(a) / (T(a) + T(p)).

    Parameters, returned value and errors are those of `pucks_over_time`.
    """
    figure = _over_time(samples, "share_a", "share of time in conflict so far", title, look)
    figure.axes[0].set_ylim(-0.02, 1.02)
    return figure


def _over_time(samples: pd.DataFrame, quantity: str, label: str, title: str, look: Look) -> Figure:
    prefix = f"{quantity}_"
    swarms = sorted(
        int(name.removeprefix(prefix))
        for name in map(str, samples)
        if name.startswith(prefix) and name.removeprefix(prefix).isdigit()
    )
    if not swarms or "time" not in samples:
        raise InputError("samples", list(samples), f"must have the columns time and {prefix}1")
    with sheet(title) as figure:
        axes = figure.subplots()
        for swarm in swarms:
            draw_line(axes, samples["time"], samples[f"{prefix}{swarm}"], look.of_swarm(swarm), f"S{swarm}")
            axes.lines[-1].set_markevery(max(1, len(samples) // 12))  # markers that touch hide the line
        axes.set_xlabel("time (s)")
        axes.set_ylabel(label)
        legend_below(figure)
    return figure
