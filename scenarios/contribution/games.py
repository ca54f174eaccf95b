"""Contribution of a robot: the same game played with it and without it (docs/contribution.md).

Both games have the same seed, so they differ only through the absent robot. Only the measured games are
compared, even if the robot is absent from the learning phase too.
"""

import math
from collections import defaultdict
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from typing import Any, Final, Literal

from kswarms.agents.common.errors import InputError
from kswarms.agents.learning.rewards import WLU, Reward
from kswarms.agents.policies.interface import Setting
from kswarms.agents.policies.learner import Learner
from kswarms.agents.policies.spec import PolicySpec, deal
from kswarms.agents.streams import Streams
from kswarms.model.description.game import Game
from kswarms.scenarios.description.text import split_words
from kswarms.scenarios.runs.outcome import Outcome
from kswarms.scenarios.runs.run import Run, digest
from kswarms.scenarios.runs.sweep import play_all

AbsentFrom = Literal["learning", "game"]
Play = Callable[[Sequence[Run]], Generator[tuple[Run, Outcome], None, None]]
"""Plays runs with the records `RECORD` and yields each with its outcome, in any order."""
TimeSud = Callable[[Mapping[str, Sequence[Any]], int], Sequence[float]]
"""Returns each swarm's SUD in time-utility (s), from the columns of ``conflicts`` and the swarm count."""

RECORD: Final = "conflicts,robots"
"""Records that the comparison needs."""


def parse_robots(game: Game, text: str | None) -> tuple[int, ...]:
    """Parse a list of robots and swarms of a game; return the numbers of the robots, ascending.

    Parameters
    ----------
    text : str, optional
        Numbers of robots, from 0, or swarms as S2, separated by commas; all robots by default.

    Raises
    ------
    InputError
        If a word is neither a robot nor a swarm of the game.

    Examples
    --------
    >>> from kswarms.model.description.game import Swarm
    >>> trio = Game(swarms=[Swarm(policy="avoid", size=size) for size in (2, 3, 4)])
    >>> parse_robots(trio, "S2,0")
    (0, 2, 3, 4)
    """
    members, first = {}, 0
    for k, swarm in enumerate(game.swarms):
        members[f"S{k + 1}"] = range(first, first + swarm.size)
        first += swarm.size
    known = {str(robot): range(robot, robot + 1) for robot in range(first)} | members
    robots: set[int] = set()
    for word in members if text is None else split_words(text) or [""]:
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
) -> list[dict[str, Any]]:
    """Play a game with all robots, and without each of `robots` in turn, and compare.

    Parameters
    ----------
    robots : sequence of int
        The robots whose contributions are measured.
    absent_from : {'learning', 'game'}
        Absent from the learning and the game, or from the measured game only.
    label : tuple of str
        Scenario and condition, for the rows.
    play : callable, optional
        Plays the runs; in this process by default.
    time_sud : callable, optional
        Measures SUD in time-utility, as `kswarms.analysis.measures.contribution.time_sud`; NaN by default.

    Returns
    -------
    list of dict
        One row for each seed and robot, in this order: the columns of the table ``contribution``
        (`kswarms.agents.common.columns`).

    Raises
    ------
    InputError
        If a robot is not in the game, or is the only one, or `game` has absent robots.
    RunError
        If a game fails.
    """
    if game.absent:
        raise InputError("absent", game.absent, "must be empty: contributions need a game of all robots")
    games = [game, *(game.replace(absent=(robot,), absent_from=absent_from) for robot in robots)]
    runs = [Run(digest(each, seed), each, seed, (label,)) for seed in seeds for each in games]
    measured: dict[tuple[int, tuple[int, ...]], _Measured] = {}
    rewards = _rewards(game)
    with closing(play_all(runs, record=RECORD) if play is None else play(runs)) as played:
        for run, outcome in played:
            measured[run.seed, run.game.absent] = _measure(run, outcome, rewards, time_sud)
    common = {"scenario": label[0], "condition": label[1], "absent_from": absent_from, "n": game.size}
    return [
        common | {"seed": seed} | _compare(game, robot, measured[seed, ()], measured[seed, (robot,)])
        for seed in seeds
        for robot in robots
    ]


@dataclass
class _Measured:
    """Measures of a run."""

    run: str  # its digest
    swarms: list[dict[str, Any]]  # results of each swarm
    time_sud: Sequence[float]  # of each swarm (s)
    times: dict[int, tuple[float, float]]  # T(a) and T(p) of each robot in the measured game (s)
    # Sums over a robot's conflicts in the measured game: R, T(a) + T(p) (s), and T(a) by opponent (s).
    reward: dict[int, float] = field(default_factory=lambda: defaultdict(float))
    reward_time: dict[int, float] = field(default_factory=lambda: defaultdict(float))
    met: dict[tuple[int, int], float] = field(default_factory=lambda: defaultdict(float))


def _measure(run: Run, outcome: Outcome, rewards: Sequence[Reward], time_sud: TimeSud | None) -> _Measured:
    robots, conflicts, swarms = outcome.records["robots"], outcome.records["conflicts"], len(outcome.swarms)
    measured = _Measured(
        run.digest,
        outcome.swarms,
        time_sud(conflicts, swarms) if time_sud else [math.nan] * swarms,
        dict(zip(robots["robot"], zip(robots["t_a"], robots["t_p"], strict=True), strict=True)),
    )
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


def _policies(game: Game) -> list[tuple[int, PolicySpec]]:
    """Return swarm (from 0) and policy of every robot."""
    return [(k, spec) for k, swarm in enumerate(game.swarms) for spec in deal(swarm.policy, swarm.size)]


def _rewards(game: Game) -> list[Reward]:
    """Return the reward of every robot: a learner's own, WLU for other policies."""
    rewards = []
    for k, spec in _policies(game):
        policy = spec.build(Setting(k, len(game.swarms), game.action_set, Streams(0, 0)))
        rewards.append(policy.reward if isinstance(policy, Learner) else WLU())
    return rewards


def _compare(game: Game, robot: int, full: _Measured, without: _Measured) -> dict[str, Any]:
    """Return the measured columns of a robot's row."""
    policies = _policies(game)
    swarm, policy = policies[robot]
    groups = {
        "mates": [other for other, (k, _) in enumerate(policies) if k == swarm and other != robot],
        "opponents": [other for other, (k, _) in enumerate(policies) if k != swarm],
    }

    def columns(measured: _Measured) -> dict[str, Any]:
        own = measured.swarms[swarm]
        found = {"run": measured.run, "time_sud": measured.time_sud[swarm]}
        for name, others in groups.items():
            found[f"{name}_t_a"] = sum(measured.times[other][0] for other in others)
            found[f"{name}_t_p"] = sum(measured.times[other][1] for other in others)
        return found | {"sud": own["sud"], "duration": own["duration"]}

    return {
        "robot": robot,
        "swarm": swarm + 1,
        "policy": str(policy),
        "reward": full.reward[robot],
        "reward_time": full.reward_time[robot],
        **{f"{name}_t_a_met": sum(full.met[o, robot] for o in others) for name, others in groups.items()},
        **columns(full),
        **{f"{name}_without": value for name, value in columns(without).items()},
    }
