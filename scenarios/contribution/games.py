"""What a robot contributes: the same game with it and without it (docs/contribution.md).

Both games have the seed in common, so they are the same world until the absent robot would have made a
difference. What is compared is the measured game, whether the robot is absent from the learning too or not.
"""

import math
from collections import defaultdict
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, Literal

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from kswarms.agents.common.atomic_files import remove_unfinished, whole
from kswarms.agents.common.columns import TABLES
from kswarms.agents.common.errors import InputError
from kswarms.agents.learning.rewards import WLU, Reward
from kswarms.agents.policies.interface import Setting
from kswarms.agents.policies.learner import Learner
from kswarms.agents.policies.registry import deal, make_policy
from kswarms.agents.streams import Streams
from kswarms.model.description.game import Game
from kswarms.scenarios.catalogue.selecting import words
from kswarms.scenarios.description.toml_files import make_directory
from kswarms.scenarios.runs.outcome import Outcome
from kswarms.scenarios.runs.run import Run, digest
from kswarms.scenarios.runs.sweep import play_all
from kswarms.scenarios.study.parquet import arrow_schema

FILE: Final = "contribution.parquet"

SCHEMA: Final = arrow_schema(TABLES["contribution"])
"""Columns of ``contribution.parquet``: one row for each game and robot (docs/contribution.md)."""

AbsentFrom = Literal["learning", "game"]
Played = Generator[tuple[Run, Outcome], None, None]
Play = Callable[[Sequence[Run]], Played]
"""Plays runs, with the records `RECORD`, and yields each with its outcome, in any order."""
TimeSud = Callable[[Mapping[str, Sequence[Any]], int], Sequence[float]]
"""From the conflicts of a game, columns as in ``conflicts.parquet``, and the number of swarms: SUD of each in
time-utility (s)."""
Row = dict[str, Any]

RECORD: Final = "conflicts,robots"
"""What a game must record to be compared."""

_ONE_QUESTION: Final = ("scenario", "condition", "absent_from", "n")


def robots_of(game: Game, text: str | None) -> tuple[int, ...]:
    """Read which robots of a game are meant.

    Parameters
    ----------
    game : Game
        Where they play.
    text : str, optional
        Numbers of robots from 0, or swarms as S2, separated by commas; all if not given.

    Raises
    ------
    InputError
        If one is neither.

    Examples
    --------
    >>> from kswarms.model.description.game import Swarm
    >>> trio = Game(swarms=[Swarm(policy="avoid", size=size) for size in (2, 3, 4)])
    >>> robots_of(trio, "S2,0")
    (0, 2, 3, 4)
    """
    members, first = {}, 0
    for k, swarm in enumerate(game.swarms):
        members[f"S{k + 1}"] = range(first, first + swarm.size)
        first += swarm.size
    single = {str(robot): range(robot, robot + 1) for robot in range(first)}
    known = single | members
    robots: set[int] = set()
    for word in members if text is None else words(text) or [""]:
        if word not in known:
            raise InputError(
                "robots", word, f"must be robots, 0 to {first - 1}, or swarms, {', '.join(members)}"
            )
        robots |= set(known[word])
    return tuple(sorted(robots))


def contributions(
    game: Game,
    robots: Sequence[int],
    seeds: Sequence[int],
    absent_from: AbsentFrom = "learning",
    label: tuple[str, str] = ("", ""),
    play: Play | None = None,
    time_sud: TimeSud | None = None,
) -> list[Row]:
    """Play a game with all its robots and without each of some, and compare.

    Parameters
    ----------
    game : Game
        With all its robots.
    robots : sequence of int
        The robots whose contributions are measured, one by one.
    seeds : sequence of int
        Each is a game of its own.
    absent_from : {'learning', 'game'}
        Whether a robot is absent from the learning too, or from the measured game alone.
    label : tuple of str
        Scenario and condition, for the rows.
    play : callable, optional
        Plays the runs; by default this process does.
    time_sud : callable, optional
        Measures SUD in time-utility, as `kswarms.analysis.measures.contribution.time_sud`; by default NaN.

    Returns
    -------
    list of dict
        One row for each seed and robot, in this order, with the columns of `SCHEMA`.

    Raises
    ------
    InputError
        If a robot is none of the game's, or the only one, or `game` lacks some already.
    RunError
        If a game fails.
    """
    if game.absent:
        raise InputError("absent", game.absent, "must be empty: robots are taken from a game of all")
    games = [game, *(game.replace(absent=(robot,), absent_from=absent_from) for robot in robots)]
    runs = [Run(digest(each, seed), each, seed, (label,)) for seed in seeds for each in games]
    measured: dict[tuple[int, tuple[int, ...]], _Measured] = {}
    with closing(play_all(runs, record=RECORD) if play is None else play(runs)) as played:
        for run, outcome in played:
            measured[run.seed, run.game.absent] = _measure(run, outcome, time_sud)
    return [
        _row(game, robot, measured[seed, ()], measured[seed, (robot,)])
        | {"scenario": label[0], "condition": label[1], "absent_from": absent_from, "n": game.size}
        | {"seed": seed}
        for seed in seeds
        for robot in robots
    ]


@dataclass
class _Measured:
    """What is compared of a run.

    Attributes
    ----------
    run : str
        Its digest.
    sud, time_sud : list of float
        SUD of each swarm (pucks; s).
    duration : float
        Of the measured game (s).
    times : dict of int to (float, float)
        T(a) and T(p) of each robot in it (s).
    reward, reward_time : dict of int to float
        Of each robot, over its conflicts in it: Σ R, and Σ (T(a) + T(p)) (s).
    met : dict of (int, int) to float
        T(a) of one robot in conflicts with another (s).
    """

    run: str
    sud: list[int]
    time_sud: Sequence[float]
    duration: float
    times: dict[int, tuple[float, float]]
    reward: dict[int, float] = field(default_factory=lambda: defaultdict(float))
    reward_time: dict[int, float] = field(default_factory=lambda: defaultdict(float))
    met: dict[tuple[int, int], float] = field(default_factory=lambda: defaultdict(float))


def _measure(run: Run, outcome: Outcome, time_sud: TimeSud | None) -> _Measured:
    robots, conflicts, swarms = outcome.records["robots"], outcome.records["conflicts"], len(outcome.swarms)
    measured = _Measured(
        run.digest,
        [row["sud"] for row in outcome.swarms],
        time_sud(conflicts, swarms) if time_sud else [math.nan] * swarms,
        outcome.swarms[0]["duration"],
        dict(zip(robots["robot"], zip(robots["t_a"], robots["t_p"], strict=True), strict=True)),
    )
    rewards = _rewards(run.game)
    directions = {action.name: action.direction for action in run.game.action_set}
    columns = ("phase", "robot", "swarm", "opponent", "opponent_swarm", "action", "t_a", "t_p", "active")
    for phase, robot, swarm, opponent, opponent_swarm, action, t_a, t_p, active in zip(
        *(conflicts[column] for column in columns), strict=True
    ):
        if phase == "game":
            measured.met[robot, opponent] += t_a
            measured.reward_time[robot] += t_a + t_p
            measured.reward[robot] += rewards[robot].of(
                t_a, t_p, active, directions[action], swarm != opponent_swarm, opponent_swarm
            )
    return measured


def _policies(game: Game) -> list[tuple[int, str]]:
    """Return swarm (from 0) and policy of every robot."""
    return [(k, name) for k, swarm in enumerate(game.swarms) for name in deal(swarm.policy, swarm.size)]


def _rewards(game: Game) -> list[Reward]:
    """Return the reward of every robot: of a learner its own, of the others WLU."""
    rewards = []
    for k, name in _policies(game):
        policy = make_policy(name, Setting(k, len(game.swarms), game.action_set, Streams(0, 0)))
        rewards.append(policy.reward if isinstance(policy, Learner) else WLU())
    return rewards


def _row(game: Game, robot: int, whole: _Measured, without: _Measured) -> Row:
    policies = _policies(game)
    swarm, policy = policies[robot]
    row: Row = {
        "run": whole.run,
        "run_without": without.run,
        "robot": robot,
        "swarm": swarm + 1,
        "policy": policy,
        "sud": whole.sud[swarm],
        "sud_without": without.sud[swarm],
        "time_sud": whole.time_sud[swarm],
        "time_sud_without": without.time_sud[swarm],
        "reward": whole.reward[robot],
        "reward_time": whole.reward_time[robot],
        "duration": whole.duration,
        "duration_without": without.duration,
    }
    for name, are_mates in (("mates", True), ("opponents", False)):
        others = [
            other
            for other, (its_swarm, _) in enumerate(policies)
            if other != robot and (its_swarm == swarm) == are_mates
        ]
        row[f"{name}_t_a_met"] = sum(whole.met[other, robot] for other in others)
        for k, what in enumerate(("t_a", "t_p")):
            row[f"{name}_{what}"] = sum(whole.times[other][k] for other in others)
            row[f"{name}_{what}_without"] = sum(without.times[other][k] for other in others)
    return row


def prepare_table(directory: Path) -> None:
    """Make sure that a table of contributions can be written to a directory, which is made if need be.

    What processes that were killed have left unfinished there is removed.

    Raises
    ------
    InputError
        If it cannot, or a file of its name is none of ours.
    """
    make_directory(directory)
    path = directory / FILE
    try:
        ours = not path.exists() or pq.read_schema(path).equals(SCHEMA)
    except (OSError, pa.ArrowException):
        ours = False
    if not ours:
        raise InputError("out", str(directory), f"holds a {FILE} that is no table of kswarms")
    remove_unfinished(directory)


def write_table(directory: Path, rows: Sequence[Row]) -> Path:
    """Write contributions, beside those that the directory holds already of other games.

    Earlier rows of the same scenario, condition, N and way to be absent are replaced.

    Parameters
    ----------
    directory : Path
        A directory that went through `prepare_table`.
    rows : sequence of dict
        As `contributions` returns them, at least one.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    OSError
        If writing fails; then the file is as it was.
    """
    path = directory / FILE
    table = pa.Table.from_pylist(list(rows), schema=SCHEMA)
    if path.exists():
        earlier = pq.read_table(path, schema=SCHEMA)
        again = pa.array([True] * len(earlier))
        for name in _ONE_QUESTION:
            again = pc.and_(again, pc.equal(earlier[name], rows[0][name]))
        table = pa.concat_tables([earlier.filter(pc.invert(again)), table])
    table = table.sort_by([(name, "ascending") for name in (*_ONE_QUESTION, "seed", "robot")])
    with whole(path) as file:
        pq.write_table(table, file)
    return path
