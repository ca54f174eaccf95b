"""Parts of the report about recorded games: networks and jams, emerging policies, places of conflicts."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
import pandas as pd

from kswarms.agents.common.errors import InputError
from kswarms.agents.common.quoting import for_file_name
from kswarms.analysis.figures import emergence, heat_maps, networks
from kswarms.analysis.film.painter import ArenaLayout
from kswarms.analysis.measures.networks import describe_network, jams, meeting_network
from kswarms.analysis.report.page import Part
from kswarms.analysis.results.records import read_conflicts, read_robots, recorded_runs
from kswarms.analysis.text_tables import TextTable, number

MAX_GAMES: Final = 4
"""Maximum number of recorded games that the report uses for a condition and density."""

ArenaOf = Callable[[str, str, int, int], ArenaLayout | None]
"""Maps scenario, condition, number of robots and seed to the arena, None if it is unknown."""

_NETWORK_COLUMNS: Final = {
    "n": ("N", ".0f"),
    "seed": ("seed", ".0f"),
    "meetings": ("conflicts", ".0f"),
    "met": ("pairs\nthat met", ".2f"),
    "degree": ("degree", ".1f"),
    "strength": ("strength\n(s)", ".0f"),
    "inter": ("time\ninter-swarm", ".2f"),
    "assortativity": ("assortativity\nof pairs", ".2f"),
    "assortativity_time": ("assortativity\nby time", ".2f"),
    "chance": ("assortativity\nif all met", ".2f"),
    "jams": ("jams", ".1f"),
    "jammed": ("robots\nin jams", ".1f"),
    "largest": ("largest\ncluster", ".1f"),
}
"""Headers and number formats of the network table, by column."""

_NETWORK_CAPTION: Final = (
    "of the measured game; degree: other robots that a robot met; strength: time that a robot spent in "
    "conflicts; assortativity by swarm-ID: 1 if robots met only their own swarm, −1 if only others; jams, "
    "robots in jams and the largest cluster: means over the seconds of the game"
)


@dataclass(frozen=True)
class RecordedCondition:
    """A condition and its recorded games, one row of `runs.parquet` for each game."""

    scenario: str
    condition: str
    games: pd.DataFrame

    @property
    def name(self) -> str:
        """Scenario and condition."""
        return f"{self.scenario}, {self.condition}" if self.condition else self.scenario

    @property
    def id(self) -> str:
        """The name as part of anchors and file names; special characters become hyphens."""
        return for_file_name("".join(each if each.isalnum() else "-" for each in self.name))

    @property
    def densest(self) -> pd.DataFrame:
        """The first `MAX_GAMES` games at the highest density."""
        dense: pd.DataFrame = self.games[self.games["n"] == self.games["n"].max()]
        return dense.head(MAX_GAMES)

    @property
    def densest_name(self) -> str:
        """Name of the condition with the density and the number of seeds of `densest`."""
        games = self.densest
        seeds = games["seed"].nunique()
        return f"{self.name}: N = {games['n'].iloc[0]}, {seeds} seed{'s' if seeds > 1 else ''}"


def recorded_conditions(directory: Path, table: str, runs: pd.DataFrame) -> list[RecordedCondition]:
    """Return the conditions with games in a recorded table, ``conflicts`` or ``robots``.

    A game that several conditions share belongs to the first of them.
    """
    order = {scenario: index for index, scenario in enumerate(dict.fromkeys(runs["scenario"]))}
    recorded = runs[runs["run"].isin(recorded_runs(directory, table))]
    games = recorded.drop_duplicates("run").sort_values(["n", "seed"])
    conditions = [
        RecordedCondition(str(scenario), str(condition), rows)
        for (scenario, condition), rows in games.groupby(["scenario", "condition"], sort=False)
    ]
    return sorted(conditions, key=lambda each: (order[each.scenario], each.condition))


def conflict_parts(
    directory: Path, condition: RecordedCondition, arena_of: ArenaOf
) -> Iterator[tuple[str, Part]]:
    """Yield (chapter, part) for recorded conflicts; chapters are ``networks``, ``maps``, ``emergence``."""
    shown = condition.densest.iloc[0]
    conflicts = read_conflicts(directory, condition.densest["run"])
    measured = conflicts[conflicts["phase"] == "game"]
    game = measured[measured["run"] == shown["run"]]
    name = f"{condition.name}: N = {shown['n']}, seed {shown['seed']}"
    if not game.empty:
        yield "networks", _network_part(directory, condition, game, name)
        yield "maps", _map_part(condition, measured, arena_of)
    with_learning = conflicts[conflicts["run"] == shown["run"]]
    if (with_learning["q"].notna() & (with_learning["phase"] == "learning")).any():
        yield "emergence", _emergence_part(condition, with_learning, name)


def _network_part(directory: Path, condition: RecordedCondition, game: pd.DataFrame, name: str) -> Part:
    part = Part(f"network-{condition.id}", condition.name)
    part.add_figure(
        part.id,
        networks.network_figure(meeting_network(game), f"{name}: meetings"),
        f"Network and matrix of the time that each pair of robots spent in conflict, {name}.",
        f"Meetings in the measured game, {name}. Left: the wider and darker a line, the longer the conflicts "
        "of the two robots. Right: the same times as a matrix; grey pairs never met.",
    )
    part.add_figure(
        f"jams-{condition.id}",
        networks.jams_figure(jams(game), f"{name}: jams"),
        f"Robots in jams and in the largest cluster over the time of the measured game, {name}.",
        f"Jams, {name}: robots linked by simultaneous conflicts, at every second.",
    )
    rows = []
    for n, games in condition.games.groupby("n"):
        seeds = games.head(MAX_GAMES).set_index("run")["seed"]
        conflicts = read_conflicts(directory, list(seeds.index))
        for run, of_run in conflicts[conflicts["phase"] == "game"].groupby("run"):
            network = describe_network(meeting_network(of_run))
            of_jams = jams(of_run)[["jams", "jammed", "largest"]].mean()
            rows.append({"n": n, "seed": seeds[run], **network, **of_jams})
    frame = pd.DataFrame(rows).sort_values(["n", "seed"])
    forms = {name: form for name, (_, form) in _NETWORK_COLUMNS.items()}
    cells = [[number(row[name], form) for name, form in forms.items()] for row in frame.to_dict("records")]
    table = TextTable([header for header, _ in _NETWORK_COLUMNS.values()], cells, _NETWORK_CAPTION)
    part.add_table(part.id, f"Networks of {condition.name}", table, frame)
    return part


def _map_part(condition: RecordedCondition, measured: pd.DataFrame, arena_of: ArenaOf) -> Part:
    part = Part(f"map-{condition.id}", condition.name)
    name = condition.densest_name
    part.add_figure(
        part.id,
        heat_maps.heat_map_figure(measured, name, _common_arena(condition, arena_of)),
        f"Heat maps of the places where conflicts began in the measured game, all and by action, {name}.",
        f"Places where conflicts began in the measured game, and numbers of conflicts, by action, {name}.",
    )
    return part


def _common_arena(condition: RecordedCondition, arena_of: ArenaOf) -> ArenaLayout | None:
    """Return the arena of the games in `densest`, None if arenas differ or are unknown."""
    games = condition.densest[["n", "seed"]].to_numpy().tolist()
    first, *others = (arena_of(condition.scenario, condition.condition, n, seed) for n, seed in games)
    if first is None or not all(o is not None and np.array_equal(o.stations, first.stations) for o in others):
        return None
    return first


def _emergence_part(condition: RecordedCondition, conflicts: pd.DataFrame, name: str) -> Part:
    part = Part(f"emergence-{condition.id}", condition.name)
    part.add_figure(
        f"choices-{condition.id}",
        emergence.choices_figure(conflicts, f"{name}: choices"),
        f"Line chart of the share of an action among learners' choices over the learning time, {name}.",
        f"Choices while learning, of all conflicts of the swarm and of each robot, {name}.",
    )
    part.add_figure(
        f"values-{condition.id}",
        emergence.values_figure(conflicts, f"{name}: Q"),
        f"Line chart of the value Q of each action over the learning time, {name}.",
        f"Q while learning (Eq. 4.15), mean of the swarm and of each robot, {name}.",
    )
    return part


def robots_parts(directory: Path, condition: RecordedCondition) -> Iterator[tuple[str, Part]]:
    """Yield (``emergence``, part) with the final Q of each robot, if any robot tried an action."""
    robots = read_robots(directory, condition.densest["run"])
    name = condition.densest_name
    try:
        figure = emergence.preferences_figure(robots, name)
    except InputError:  # no robot learned
        return
    part = Part(f"robots-{condition.id}", f"{condition.name}: robot by robot")
    part.add_figure(
        part.id,
        figure,
        f"Scatter chart of the value Q of each action at the end, robot by robot, {name}.",
        f"Differences between the robots of a swarm: Q of every arm at the end of the game, {name}.",
    )
    yield "emergence", part
