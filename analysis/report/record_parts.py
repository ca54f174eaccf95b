"""The parts of the report about records: networks and jams, how policies emerge, where conflicts happen."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
import pandas as pd

from kswarms.analysis.figures import emergence, networks
from kswarms.analysis.figures import heat_maps as maps
from kswarms.analysis.film.painter import Places
from kswarms.analysis.report.page import Part, Tabled
from kswarms.analysis.results.records import (
    CONFLICTS_FILE,
    ROBOTS_FILE,
    read_conflicts,
    read_robots,
    recorded_runs,
)
from kswarms.analysis.text_tables import NONE, PrintedTable

GAMES: Final = 4
"""Recorded games of a density that the report looks into: conflicts of twenty would not tell more."""

PlacesOf = Callable[[str, str, int, int], Places | None]
"""Stations and bases of a scenario, condition, number of robots and seed; None if they are not known."""


@dataclass(frozen=True)
class Recorded:
    """A curve with recorded games, as rows of `runs.parquet`: `n`, `seed` and `run` of each."""

    scenario: str
    condition: str
    games: pd.DataFrame

    @property
    def name(self) -> str:
        """What the curve is called."""
        return f"{self.scenario}, {self.condition}" if self.condition else self.scenario

    @property
    def id(self) -> str:
        """The curve as part of an anchor."""
        return "".join(sign if sign.isalnum() else "-" for sign in self.name)

    def densest(self) -> pd.DataFrame:
        """Return the games at the highest density, the first seeds."""
        dense: pd.DataFrame = self.games[self.games["n"] == self.games["n"].max()]
        return dense.head(GAMES)


def recorded_curves(directory: Path, runs: pd.DataFrame) -> tuple[list[Recorded], list[Recorded]]:
    """Return the curves of which conflicts were recorded, and those of which robots were.

    A game that several curves share is looked at in the first of them.
    """
    found = []
    for name in (CONFLICTS_FILE, ROBOTS_FILE):
        there = recorded_runs(directory, name)
        games = runs[runs["run"].isin(there)].drop_duplicates("run").sort_values(["n", "seed"])
        curves = games.groupby(["scenario", "condition"], sort=False)
        by_curve = [Recorded(str(scenario), str(condition), rows) for (scenario, condition), rows in curves]
        order = {scenario: index for index, scenario in enumerate(dict.fromkeys(runs["scenario"]))}
        found.append(sorted(by_curve, key=lambda curve: (order[curve.scenario], curve.condition)))
    return found[0], found[1]


def conflict_parts(directory: Path, curve: Recorded, places_of: PlacesOf) -> Iterator[tuple[str, Part]]:
    """Show the recorded conflicts of a curve.

    Yields
    ------
    (str, Part)
        Chapter, ``networks``, ``emergence`` or ``maps``, and a part of it.
    """
    first = curve.densest().iloc[0]
    dense = read_conflicts(directory, curve.densest()["run"])
    one = dense[dense["run"] == first["run"]]
    measured = dense[dense["phase"] == "game"]
    game = measured[measured["run"] == first["run"]]
    of_game = f"{curve.name}: N = {first['n']}, seed {first['seed']}"
    if not game.empty:
        yield "networks", _network_part(directory, curve, game, of_game)
        yield "maps", _maps_part(curve, measured, places_of)
    if one["q"].notna().any():
        yield "emergence", _emergence_part(curve, one, of_game)


def _network_part(directory: Path, curve: Recorded, game: pd.DataFrame, of_game: str) -> Part:
    part = Part(f"network-{curve.id}", curve.name)
    part.show(
        part.id,
        networks.network_figure(networks.meeting_network(game), f"{of_game}: who met whom"),
        f"Network and matrix of the time that each two robots spent in conflict, {of_game}.",
        f"Who met whom in the measured game, {of_game}: left, the wider and darker a line the longer two "
        "met; right, the same times as a matrix, grey where two never met.",
    )
    part.show(
        f"jams-{curve.id}",
        networks.jams_figure(networks.jams(game), f"{of_game}: jams"),
        f"Robots in jams and in the largest cluster over the time of the measured game, {of_game}.",
        f"Jams, {of_game}: robots linked by conflicts that go on at the same moment, looked at every second.",
    )
    rows = []
    for n, games in curve.games.groupby("n"):
        seeds = games.head(GAMES).set_index("run")["seed"]
        conflicts = read_conflicts(directory, list(seeds.index))
        for run, of_run in conflicts[conflicts["phase"] == "game"].groupby("run"):
            rows.append({"n": n, "seed": seeds[run], **_of_network(of_run)})
    frame = pd.DataFrame(rows).sort_values(["n", "seed"])
    part.tables.append(Tabled(part.id, f"Networks of {curve.name}", _printed(frame), frame))
    return part


def _of_network(game: pd.DataFrame) -> Mapping[str, float]:
    means = networks.jams(game)[["jams", "jammed", "largest"]].mean()
    return networks.describe(networks.meeting_network(game)) | {
        str(name): mean for name, mean in means.items()
    }


def _printed(frame: pd.DataFrame) -> PrintedTable:
    columns = {
        "n": ("N", "{:.0f}"),
        "seed": ("seed", "{:.0f}"),
        "meetings": ("conflicts", "{:.0f}"),
        "met": ("pairs\nthat met", "{:.2f}"),
        "degree": ("degree", "{:.1f}"),
        "strength": ("strength\n(s)", "{:.0f}"),
        "inter": ("time\ninter-swarm", "{:.2f}"),
        "assortativity": ("assortativity\nof pairs", "{:.2f}"),
        "assortativity_time": ("assortativity\nby time", "{:.2f}"),
        "chance": ("if all met\nalike", "{:.2f}"),
        "jams": ("jams", "{:.1f}"),
        "jammed": ("robots\nin jams", "{:.1f}"),
        "largest": ("largest\ncluster", "{:.1f}"),
    }
    rows = [
        [form.format(row[name]) if pd.notna(row[name]) else NONE for name, (_, form) in columns.items()]
        for row in frame.to_dict("records")
    ]
    caption = (
        "of the measured game; degree: others that a robot met; strength: time that a robot spent in them; "
        "assortativity by swarm-ID: 1 if robots met their own swarm alone, −1 if others alone; jams, robots "
        "in them and the largest cluster: mean over the seconds"
    )
    return PrintedTable([heading for heading, _ in columns.values()], rows, caption)


def _maps_part(curve: Recorded, measured: pd.DataFrame, places_of: PlacesOf) -> Part:
    part = Part(f"map-{curve.id}", curve.name)
    dense = curve.densest()
    seeds = dense["seed"].nunique()
    of_games = f"{curve.name}: N = {dense['n'].iloc[0]}, {seeds} seed{'s' if seeds > 1 else ''}"
    part.show(
        part.id,
        maps.heat_maps(measured, of_games, _common(curve, places_of)),
        f"Heat maps of the places where conflicts began in the measured game, all and by action, {of_games}.",
        f"Where conflicts began in the measured game, all and by action, with their numbers; {of_games}.",
    )
    return part


def _common(curve: Recorded, places_of: PlacesOf) -> Places | None:
    """Return the places of a curve's games, None where they differ or are not known."""
    games = curve.densest()[["n", "seed"]].to_numpy().tolist()
    first, *others = (places_of(curve.scenario, curve.condition, n, seed) for n, seed in games)
    if first is None or not all(o is not None and np.array_equal(o.stations, first.stations) for o in others):
        return None
    return first


def _emergence_part(curve: Recorded, one: pd.DataFrame, of_game: str) -> Part:
    part = Part(f"emergence-{curve.id}", curve.name)
    part.show(
        f"choices-{curve.id}",
        emergence.choices_figure(one, f"{of_game}: choices"),
        f"Line chart of the share of an action among learners' choices over the time of learning, {of_game}.",
        f"Choices while learning, of all conflicts of the swarm and of each robot, {of_game}.",
    )
    part.show(
        f"values-{curve.id}",
        emergence.values_figure(one, f"{of_game}: Q"),
        f"Line chart of the value Q of each action over the time of learning, {of_game}.",
        f"Q while learning (Eq. 4.15), mean of the swarm and of each robot, {of_game}.",
    )
    return part


def robots_parts(directory: Path, curve: Recorded) -> Iterator[tuple[str, Part]]:
    """Yield how unlike the robots of a curve became, for the chapter ``emergence``, if any learned."""
    dense = curve.densest()
    robots = read_robots(directory, dense["run"])
    if not robots["arms"].map(len).any():
        return
    seeds = dense["seed"].nunique()
    of_games = f"{curve.name}: N = {dense['n'].iloc[0]}, {seeds} seed{'s' if seeds > 1 else ''}"
    part = Part(f"robots-{curve.id}", f"{curve.name}: robot by robot")
    part.show(
        part.id,
        emergence.preferences_figure(robots, of_games),
        f"Scatter chart of the value Q of each action at the end, robot by robot, {of_games}.",
        f"How unlike the robots of a swarm became: Q of every arm at the end of the game, {of_games}.",
    )
    yield "emergence", part
