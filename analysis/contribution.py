"""What robots contributed to their swarm, beside the rewards that they computed (docs/contribution.md).

From the rows of `contribution.parquet`: a robot's contribution to a game is the SUD of its swarm less that of
the same game without it. Rows of one question are compared: one scenario, condition, N and way to be absent.

An interval of a mean is Student's over the seeds; that of a rank correlation or of a quotient is a bootstrap,
which draws seeds, each with all its robots, again. One seed has no interval: NaN.
"""

import warnings
from collections.abc import Callable, Mapping
from pathlib import Path
from textwrap import fill
from typing import Any, Final

import numpy as np
import pandas as pd
import seaborn as sns
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy import stats

from agents.errors import InputError
from analysis.drawing import SWARM_FORMS
from analysis.figures import DOTS_PER_INCH

Floats = NDArray[np.float64]
Statistic = Callable[[Floats], Floats]
"""Maps tables of shape (…, seeds, columns) to numbers of shape (…)."""

FILE: Final = "contribution.parquet"
CONFIDENCE: Final = 0.95
FEWEST_ROBOTS: Final = 3
"""Of which ranks are compared: two are in the same order or they are not."""

_QUESTION: Final = ["scenario", "condition", "n", "absent_from"]
_RESAMPLES: Final = 2000
_BOOTSTRAP_SEED: Final = 0

MEASURES: Final = {"pucks": "pucks", "time": "s"}
"""The SUD whose change is a contribution, and its unit."""
QUANTITIES: Final = (*MEASURES, "reward", "reward_rate")
"""What is averaged of each robot: its contribution, its reward in a game (s), and that per second of conflicts."""
OTHERS: Final = ("mates", "opponents")


def read(directory: Path) -> pd.DataFrame:
    """Read `contribution.parquet`, one row for each game and robot.

    Parameters
    ----------
    directory : Path
        The directory that `kswarms contribution --out` wrote.

    Raises
    ------
    InputError
        If there is no such table that can be read.
    """
    path = directory / FILE
    try:
        return pd.read_parquet(path)
    except (OSError, ValueError) as error:
        raise InputError("results", str(path), "must be a table that `kswarms contribution` wrote") from error


def of_question(rows: pd.DataFrame, **question: object) -> pd.DataFrame:
    """Return the rows of one question, with the contributions.

    Parameters
    ----------
    rows : pandas.DataFrame
        Rows of `contribution.parquet`.
    **question
        Values of `scenario`, `condition`, `n`, `absent_from`, as far as `rows` has several.

    Returns
    -------
    pandas.DataFrame
        Besides the columns of `rows`: `pucks` and `time` (s), the contribution to SUD; `reward_rate`, the reward
        for each second of conflicts and the program after them (Eq. 4.15), NaN for a robot without any.

    Raises
    ------
    InputError
        If none remain, or those of several questions.
    """
    for name, value in question.items():
        rows = rows[rows[name] == value]
    for name in _QUESTION:
        values = sorted(set(rows[name]))
        if len(values) != 1:
            raise InputError(name, question.get(name), f"must be one of {', '.join(map(str, values)) or 'none'}")
    return rows.assign(
        pucks=(rows["sud"] - rows["sud_without"]).astype(float),
        time=rows["time_sud"] - rows["time_sud_without"],
        reward_rate=rows["reward"] / rows["reward_time"].where(rows["reward_time"] > 0),
    )


def means(rows: pd.DataFrame) -> pd.DataFrame:
    """Average over the seeds, for each robot and for each swarm.

    Parameters
    ----------
    rows : pandas.DataFrame
        As `of_question` returns them.

    Returns
    -------
    pandas.DataFrame
        One row for each `swarm` and `robot`, and one for the mean robot of each swarm, after them, with robot −1;
        `policy` (str), `seeds`, and for each of `QUANTITIES` its mean under its own name, and the 95 % interval
        of that mean, ``…_low`` and ``…_high``.
    """
    quantities = list(QUANTITIES)
    mean_robot = rows.groupby(["swarm", "seed"])[quantities].mean().reset_index().assign(robot=-1)
    mean_robot["policy"] = mean_robot["swarm"].map(rows.groupby("swarm")["policy"].first())
    groups = pd.concat([rows, mean_robot]).groupby(["swarm", "robot"])
    table = groups.agg(policy=("policy", "first"), seeds=("seed", "nunique"))
    for quantity in quantities:
        mean = groups[quantity].mean()
        reach = stats.t.ppf(0.5 + CONFIDENCE / 2, groups[quantity].count() - 1) * groups[quantity].sem()
        table[quantity], table[f"{quantity}_low"], table[f"{quantity}_high"] = mean, mean - reach, mean + reach
    table = table.reset_index()
    return table.sort_values(["swarm", "robot"], key=lambda column: column.where(column >= 0, np.inf))


def rank_correlations(rows: pd.DataFrame) -> pd.DataFrame:
    """Compare the order of robots by reward with that by contribution, within each swarm.

    Parameters
    ----------
    rows : pandas.DataFrame
        As `of_question` returns them.

    Returns
    -------
    pandas.DataFrame
        One row for each `swarm` of three robots at least and each of `MEASURES`, with Spearman's ρ and its 95 %
        interval:

        * ``robots``, ``…_low``, ``…_high``: of the robots' means over the seeds; bootstrap over seeds;
        * ``games``, ``…_low``, ``…_high``: of the robots in one game, averaged over the games; Student's t.

        NaN where all robots have the same.
    """
    table = []
    for swarm, of_swarm in rows.groupby("swarm"):
        reward = _by_seed(of_swarm, "reward")
        robots = reward.shape[1]
        for measure in MEASURES if robots >= FEWEST_ROBOTS else ():
            both = np.hstack([reward, _by_seed(of_swarm, measure)])

            def of_means(tables: Floats, robots: int = robots) -> Floats:
                mean = tables.mean(axis=-2)
                return rank_correlation(mean[..., :robots], mean[..., robots:])

            low, high = _bootstrap(both, of_means)
            in_games = rank_correlation(both[:, :robots], both[:, robots:])
            mean, mean_low, mean_high = _student(in_games[~np.isnan(in_games)])
            table.append(
                {
                    **{"swarm": swarm, "measure": measure},
                    **{"robots": float(of_means(both)), "robots_low": low, "robots_high": high},
                    **{"games": mean, "games_low": mean_low, "games_high": mean_high},
                }
            )
    columns = ("robots", "robots_low", "robots_high", "games", "games_low", "games_high")
    return pd.DataFrame(table, columns=["swarm", "measure", *columns])


def rank_correlation(first: Floats, second: Floats) -> Floats:
    """Return Spearman's ρ along the last axis, NaN where one of both is constant.

    Parameters
    ----------
    first, second : ndarray of float64, shape (…, robots)
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", stats.ConstantInputWarning)
        ranks = (stats.rankdata(values, axis=-1) for values in (first, second))
        correlation: Floats = np.asarray(stats.pearsonr(*ranks, axis=-1).statistic)
    return correlation


def assumption(rows: pd.DataFrame) -> pd.DataFrame:
    """Say what became of the time that others spent in conflicts with a robot once it was gone.

    The source assumes all of it to be program time (Eqs. 4.9 to 4.11). Times without the robot are scaled to
    the duration of the game with it, which is the same unless a number of pucks ends the game.

    Parameters
    ----------
    rows : pandas.DataFrame
        As `of_question` returns them.

    Returns
    -------
    pandas.DataFrame
        One row for each `swarm` of the robot and each of `OTHERS` that there are, `others`; seconds in a game,
        summed over these others, averaged over robots and seeds:

        * `t_a`, `t_a_without`, `t_p`, `t_p_without`: T(a) and T(p) with the robot and without it;
        * `met`: T(a) in the others' conflicts with the robot;
        * `share`, `low`, `high`: (T(a) − T(a) without) / met, which is 1 if the assumption holds and 0 if other
          conflicts take the place of those; and its 95 % interval, a bootstrap over seeds. NaN if nobody met it.
    """
    scale = rows["duration"] / rows["duration_without"]
    table = []
    for swarm, of_swarm in rows.groupby("swarm"):
        for others in OTHERS:
            times = pd.DataFrame(
                {
                    "t_a": of_swarm[f"{others}_t_a"],
                    "t_a_without": of_swarm[f"{others}_t_a_without"] * scale,
                    "t_p": of_swarm[f"{others}_t_p"],
                    "t_p_without": of_swarm[f"{others}_t_p_without"] * scale,
                    "met": of_swarm[f"{others}_t_a_met"],
                }
            )
            if (times["t_a"] + times["t_p"] == 0).all():
                continue  # nobody there
            of_seeds = times.groupby(of_swarm["seed"]).mean().to_numpy()
            low, high = _bootstrap(of_seeds, _share)
            found: dict[str, Any] = {"swarm": swarm, "others": others, **times.mean()}
            table.append(found | {"share": float(_share(of_seeds)), "low": low, "high": high})
    return pd.DataFrame(table)


def _share(tables: Floats) -> Floats:
    """Return the quotient of `assumption` for tables of shape (…, seeds, 5), in the order of its columns."""
    t_a, t_a_without, met = (tables[..., column].mean(axis=-1) for column in (0, 1, 4))
    return np.divide(t_a - t_a_without, met, out=np.full_like(met, np.nan), where=met > 0)


def _by_seed(rows: pd.DataFrame, quantity: str) -> Floats:
    """Return a quantity as an array of shape (seeds, robots)."""
    table: Floats = rows.pivot(index="seed", columns="robot", values=quantity).to_numpy()
    return table


def _student(values: Floats) -> tuple[float, float, float]:
    """Return the mean of values and the 95 % interval of it, NaN where it takes more of them."""
    if len(values) < 2:
        return (float(values.mean()) if len(values) else np.nan), np.nan, np.nan
    mean = float(values.mean())
    reach = float(stats.t.ppf(0.5 + CONFIDENCE / 2, len(values) - 1) * stats.sem(values))
    return mean, mean - reach, mean + reach


def _bootstrap(table: Floats, statistic: Statistic) -> tuple[float, float]:
    """Return the 95 % interval of a statistic of a table of shape (seeds, columns), by drawing seeds again."""
    seeds = len(table)
    if seeds < 2:
        return np.nan, np.nan
    resampled = stats.bootstrap(
        (np.arange(seeds),),
        lambda drawn, axis: statistic(table[drawn]),  # `axis`: SciPy's call, always the last
        n_resamples=_RESAMPLES,
        confidence_level=CONFIDENCE,
        method="percentile",
        rng=np.random.default_rng(_BOOTSTRAP_SEED),
    )
    low, high = resampled.confidence_interval
    return float(low), float(high)


def scatter(rows: pd.DataFrame, title: str = "") -> Figure:
    """Draw the true contribution of each robot over the reward that it computed.

    Parameters
    ----------
    rows : pandas.DataFrame
        As `of_question` returns them.
    title : str
        What the scenario is, printed after its id.

    Returns
    -------
    matplotlib.figure.Figure
        A panel for each of `MEASURES`: each robot's means with their intervals, single games as light points.
    """
    first = rows.iloc[0]
    seeds = rows["seed"].nunique()
    absent = "from learning and game" if first["absent_from"] == "learning" else "from the measured game"
    heading = [first["scenario"], first["condition"], f"N = {first['n']}", f"robots absent {absent}", title]
    robots, correlations = means(rows), rank_correlations(rows)
    measures = [measure for measure in MEASURES if rows[measure].notna().any()]
    with sns.axes_style("whitegrid", rc={"grid.color": "0.9"}), sns.plotting_context("notebook", font_scale=0.9):
        figure = Figure(figsize=(5.5 * len(measures) + 1, 5.5), layout="constrained")
        figure.suptitle(fill(", ".join(filter(None, heading)), width=95, break_on_hyphens=False))
        panels = figure.subplots(1, len(measures), squeeze=False)[0]
        for axes, measure in zip(panels, measures, strict=True):
            axes.axhline(0, color="0.4", linewidth=1)
            for swarm, of_swarm in rows.groupby("swarm"):
                form = SWARM_FORMS[(int(swarm) - 1) % len(SWARM_FORMS)]
                single = robots[(robots["swarm"] == swarm) & (robots["robot"] >= 0)]
                if seeds > 1:
                    axes.scatter(of_swarm["reward"], of_swarm[measure], s=7, color=form.colour, alpha=0.15, lw=0)
                axes.errorbar(
                    single["reward"],
                    single[measure],
                    xerr=_reach(single, "reward"),
                    yerr=_reach(single, measure),
                    label=f"S{swarm}: {_brief(of_swarm['policy'])}",
                    color=form.colour,
                    linestyle="none",
                    marker=form.marker,
                    markerfacecolor=form.colour if form.filled else "white",
                    elinewidth=0.8,
                )
            axes.set_title(_title(correlations[correlations["measure"] == measure]), fontsize="small")
            axes.set_xlabel("reward that the robot computes in a game (s)")
            axes.set_ylabel(f"change of its swarm's SUD by the robot ({MEASURES[measure]})")
        handles, labels = panels[0].get_legend_handles_labels()
        note = "one seed" if seeds == 1 else f"mean of {seeds} seeds, bars: its 95 % interval, points: single games"
        figure.legend(handles, labels, title=note, loc="outside lower center", ncols=3)
    return figure


def _reach(table: pd.DataFrame, quantity: str) -> pd.Series:
    return table[f"{quantity}_high"] - table[quantity]


def _brief(policies: pd.Series) -> str:
    """Return the policies of a swarm without their arguments, which are too long for a legend."""
    return "+".join(dict.fromkeys(policy.partition("(")[0] for policy in policies))


def _title(correlations: pd.DataFrame) -> str:
    lines = []
    for found in correlations.to_dict("records"):
        robots, games = (with_interval(found, name) for name in ("robots", "games"))
        lines.append(f"S{found['swarm']}: rank correlation of robots {robots}, in a game {games}")
    return "\n".join(lines)


def with_interval(found: Mapping[Any, Any], name: str, digits: int = 2) -> str:
    """Return a number with its interval, from columns like those of `means`; – where there is none."""
    mean, low, high = (found[key] for key in (name, f"{name}_low", f"{name}_high"))
    if pd.isna(mean):
        return "–"
    interval = "" if pd.isna(low) else f" ({low:.{digits}f} … {high:.{digits}f})"
    return f"{mean:.{digits}f}{interval}"


def draw(directory: Path, title: str = "", **question: object) -> Path:
    """Write `figures/contribution-<id>.png` in a results directory.

    Parameters
    ----------
    directory : Path
        A directory that holds `contribution.parquet`.
    title : str
        As for `scatter`.
    **question
        As for `of_question`.

    Raises
    ------
    InputError
        If the table cannot be read, or the figure cannot be written; then it is as it was.
    """
    rows = of_question(read(directory), **question)
    path = directory / "figures" / f"contribution-{rows['scenario'].iloc[0]}.png"
    unfinished = path.with_name(f".unfinished-{path.name}")
    try:
        path.parent.mkdir(exist_ok=True)
        try:
            scatter(rows, title).savefig(unfinished, format="png", dpi=DOTS_PER_INCH)
            unfinished.replace(path)
        finally:
            unfinished.unlink(missing_ok=True)
    except OSError as error:
        raise InputError("figures", str(path), "must be a place that can be written") from error
    return path
