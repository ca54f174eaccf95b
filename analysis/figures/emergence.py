"""Figures of emerging policies: choices and Q over the learning time, and final Q of each robot.

Choices and Q come from the conflicts of one game: rows of `conflicts.parquet` or of a DataCollector's table
(`model.datacollector.get_table_dataframe("conflicts")`). Final Q comes from rows of `robots.parquet`.
"""

from collections.abc import Callable, Sequence
from itertools import cycle

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from kswarms.analysis.figures.style import (
    CONDITION_COLOURS,
    condition_style,
    figure_text,
    legend_below,
    new_figure,
)
from kswarms.analysis.measures.emergence import BANDIT, arm_values, choices, preferences


def choices_figure(conflicts: pd.DataFrame, title: str = "") -> Figure:
    """Draw the share of each action over the learning time; thick lines are swarms, thin lines robots.

    Parameters
    ----------
    conflicts : pandas.DataFrame
        Conflicts of one game; `InputError` if no robot learned.
    title : str
        Heading.
    """
    swarms, robots = choices(conflicts), choices(conflicts, by=["robot"])
    actions = sorted(set(swarms["action"]))
    if len(actions) == 2:  # the two shares add up to 1
        del actions[1]

    def draw(axes: Axes, bandit: tuple[int, int]) -> None:
        _draw_over_time(axes, _of_bandit(robots, bandit), _of_bandit(swarms, bandit), "share", actions)
        axes.set_ylim(-0.02, 1.02)

    return _panels(swarms, draw, title, "share of the choices")


def values_figure(conflicts: pd.DataFrame, title: str = "") -> Figure:
    """Draw Q of each action over the learning time; thick lines are means of swarms, thin lines robots.

    Parameters and errors are those of `choices_figure`.
    """
    robots = arm_values(conflicts)
    means = robots.groupby([*BANDIT, "action", "time"])["q"].mean().reset_index()
    actions = sorted(set(means["action"]))

    def draw(axes: Axes, bandit: tuple[int, int]) -> None:
        _draw_over_time(axes, _of_bandit(robots, bandit), _of_bandit(means, bandit), "q", actions)

    return _panels(means, draw, title, "Q (reward per second)")


def _of_bandit(rows: pd.DataFrame, bandit: tuple[int, int]) -> pd.DataFrame:
    return rows[(rows["swarm"] == bandit[0]) & (rows["opponent_swarm"] == bandit[1])]


def _draw_over_time(
    axes: Axes, robots: pd.DataFrame, swarm: pd.DataFrame, quantity: str, actions: Sequence[str]
) -> None:
    """Draw the curves of a bandit; an action has the same colour in all panels."""
    for colour, action in zip(cycle(CONDITION_COLOURS), actions, strict=False):
        for _, of_robot in robots[robots["action"] == action].groupby("robot"):
            axes.plot(of_robot["time"], of_robot[quantity], color=colour, linewidth=0.6, alpha=0.35)
        of_swarm = swarm[swarm["action"] == action]
        if not of_swarm.empty:
            axes.plot(of_swarm["time"], of_swarm[quantity], color=colour, linewidth=2.5, label=action)


def _panels(
    rows: pd.DataFrame,
    draw: Callable[[Axes, tuple[int, int]], None],
    title: str,
    ylabel: str,
    xlabel: str = "learning time (s)",
    legend: str = "thick: swarm, thin: its robots",
) -> Figure:
    """Draw a panel for each pair of a learning swarm and an opponent."""
    bandits = sorted({(int(swarm), int(opponent)) for swarm, opponent in rows[BANDIT].to_numpy()})
    with new_figure(title, width=max(7.0, 5.0 * len(bandits)), height=4.4) as figure:
        panels = figure.subplots(1, len(bandits), sharey=True, squeeze=False)[0]
        for axes, bandit in zip(panels, bandits, strict=True):
            axes.set_title(_bandit_name(bandit))
            draw(axes, bandit)
            axes.set(xlabel=xlabel, ylabel=ylabel)
            axes.label_outer()
        legend_below(figure, legend)
    return figure


def _bandit_name(bandit: tuple[int, int]) -> str:
    swarm, opponent = bandit
    return f"within S{swarm}" if swarm == opponent else f"S{swarm} against S{opponent}"


def preferences_figure(robots: pd.DataFrame, title: str = "") -> Figure:
    """Draw Q of every arm at the end of a game, robot by robot.

    Each pair of a learning swarm and an opponent has a panel. Robots are sorted by their best action, then by
    its Q.

    Parameters
    ----------
    robots : pandas.DataFrame
        Rows of `robots.parquet`, of one game or several; `InputError` if no robot learned.
    title : str
        Heading.
    """
    rows = preferences(robots)
    robot = [name for name in ("run", "robot") if name in rows]
    actions = sorted(set(rows["action"]))

    def draw(axes: Axes, bandit: tuple[int, int]) -> None:
        of_bandit = _of_bandit(rows, bandit)
        best = of_bandit[of_bandit["learned"]].drop_duplicates(robot).sort_values(["action", "q"])
        column = pd.Series(range(len(best)), index=pd.MultiIndex.from_frame(best[robot]))
        for index, action in enumerate(actions):
            arm, style = of_bandit[of_bandit["action"] == action], condition_style(index)
            x = column[pd.MultiIndex.from_frame(arm[robot])]
            axes.scatter(x, arm["q"], color=style.colour, marker=style.marker, s=22, label=action)
        learned = best["action"].value_counts(normalize=True).sort_index()
        shares = ", ".join(f"{action} {share:.0%}" for action, share in learned.items())
        axes.set(title=figure_text(f"{_bandit_name(bandit)}; best: {shares}"), xticks=[])

    xlabel, legend = "robots, sorted by best action and its Q", "all arms of a robot are on one vertical line"
    return _panels(rows, draw, title, "Q at the end (reward per second)", xlabel, legend)
