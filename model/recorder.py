"""Recording of a game: samples in Mesa's DataCollector, recorded tables, rows of results (section 3.5)."""

import itertools
from collections.abc import Callable
from functools import partial
from os import PathLike
from typing import Any, Final

import numpy as np
from mesa import DataCollector

from kswarms.agents.actions import TOWARDS
from kswarms.agents.common.columns import RECORDED_TABLES, column_names
from kswarms.agents.common.errors import InputError, require_integer, require_type
from kswarms.agents.common.input_files import to_path
from kswarms.agents.policies.saved import best_actions, save_learned, snapshot_of
from kswarms.agents.robot.krembot import Krembot
from kswarms.agents.robot.state import ACTION
from kswarms.agents.theory.swarms import swarm_utility_difference
from kswarms.agents.theory.times import share_of_time
from kswarms.model.game_state import GameState
from kswarms.model.mesa_base import label_samples

RECORDS: Final = ("model", "agents", *RECORDED_TABLES)
"""Samples of the model and of the agents; tables of conflicts, robots and positions."""

Table = dict[str, list[Any]]

_CONFLICTS, _ROBOTS, _TRAJECTORY = (column_names(table)[1:] for table in RECORDED_TABLES)  # without the run
_NOT_REPORTED: Final = ("swarm", "duration", "ended")
"""Columns of results without a model reporter for each swarm."""
_POLICIES: Final = ("swarm", "opponent", "action", "share", "attack_share")
_OF_ROBOT: Final[dict[str, Callable[[Krembot], Any]]] = {
    "swarm": lambda robot: robot.swarm + 1,
    "state": lambda robot: robot.state,
    "puck": lambda robot: robot.carrying,
    "x": lambda robot: float(robot.position[0]),
    "y": lambda robot: float(robot.position[1]),
    "heading": lambda robot: robot.heading,
}


def _report(value_of: Callable[[Krembot], Any], agent: Any) -> Any:
    """Return a value of a robot; None for an agent that is no robot."""
    return value_of(agent) if isinstance(agent, Krembot) else None


def parse_record(text: str) -> frozenset[str]:
    """Parse a comma-separated list of `RECORDS`."""
    require_type("record", text, str, "must be a text")
    record = frozenset(name.strip() for name in text.split(",") if name.strip())
    for name in sorted(record):
        if name not in RECORDS:
            raise InputError("record", name, f"must be one of {', '.join(RECORDS)}")
    return record


class Recorder:
    """Records a game; `record` is a subset of `RECORDS`.

    Model reporters: ``time`` (s since the start), ``game_time`` (s of the measured game), ``ended`` (reason
    for the end of the game, ``running`` before it, ``stopped`` if the model was stopped) and ``run_seed``
    (seed of the run); for each swarm k the columns of the table ``runs``, such as ``pucks_k`` and ``t_p_k``,
    and its fractions of T(a) and T(p), ``share_a_k`` and ``share_p_k``. No reporter has the name of an
    argument of `ForagingModel`, because `mesa.batch_run` puts both into one row.
    Agent reporters: swarm, state, puck, x, y and heading; None for agents that are no robots.

    Attributes
    ----------
    collector : mesa.DataCollector
        Samples, and the table of conflicts.
    sample_times : list of float
        Times of the samples (s).
    """

    def __init__(self, state: GameState, record: frozenset[str]) -> None:
        self._state = state
        self._record = record
        self._row: dict[str, Any] = {}
        self._read_names: set[str] = set()
        self._trajectory: list[dict[str, Any]] = []  # columns of each sample, arrays
        self.sample_times: list[float] = []
        row = _sample_row(state) if "model" in record else {}
        self.collector = DataCollector(
            {name: partial(self._read, name) for name in row},
            {name: partial(_report, of) for name, of in _OF_ROBOT.items()} if "agents" in record else {},
            tables={"conflicts": list(_CONFLICTS)} if "conflicts" in record else {},
        )
        self._conflicts: Table = self.collector.tables.get("conflicts", {})

    def samples(self, collector: DataCollector) -> bool:
        """Return whether samples with a collector record anything."""
        reporters = collector.model_reporters, collector.agent_reporters, collector.agenttype_reporters
        return any(reporters) or "trajectory" in self._record

    def _read(self, name: str, _: object) -> Any:
        # All reporters of a collection read the same row.
        if name in self._read_names or self._state.time != self._row.get("time"):
            self._row = _sample_row(self._state)
            self._read_names.clear()
        self._read_names.add(name)
        return self._row[name]

    def sample(self, collector: DataCollector) -> None:
        """Sample the game as it is now: row ``model.steps`` of the samples and of a collector."""
        state, step = self._state, self._state.steps
        self.flush_conflicts()
        del self.sample_times[step:], self._trajectory[step:]
        self.sample_times.append(state.time)
        if "trajectory" in self._record:
            self._trajectory.append(_places(state))
        _make_room(collector, step)
        collector.collect(state)
        label_samples(collector, self.sample_times)

    def flush_conflicts(self) -> None:
        """Move the closed conflicts to the table: times in seconds, swarms counted from 1.

        ``seen`` has a tuple per swarm: the numbers of its robots that the sensors detect, ascending.
        """
        log, state = self._state.conflict_log, self._state
        if not log:
            return
        seconds, swarm_of = state.controller.seconds, state.swarm_of
        for c in log:
            seen: list[list[int]] = [[] for _ in state.members]
            for number in sorted(c.seen):
                seen[swarm_of(number)].append(number)
            identity = (state.phase, c.robot, swarm_of(c.robot) + 1, c.opponent, swarm_of(c.opponent) + 1)
            begin = (seconds(c.start), c.x, c.y, c.action.name)
            end = (seconds(c.t_a), seconds(c.t_p), c.active, tuple(map(tuple, seen)), c.reward, c.value)
            for name, value in zip(_CONFLICTS, identity + begin + end, strict=True):
                self._conflicts[name].append(value)
        log.clear()

    def tables(self) -> dict[str, Table]:
        """Return the recorded tables by name; columns are lists."""
        tables = self.records()
        if "trajectory" in tables:
            tables["trajectory"] = {name: column.tolist() for name, column in tables["trajectory"].items()}
        return tables

    def records(self) -> dict[str, Any]:
        """Return the recorded tables by name. Columns of the trajectory are arrays, others are lists."""
        tables: dict[str, Any] = {}
        if "conflicts" in self._record:
            tables["conflicts"] = self._conflicts
        if "robots" in self._record:
            tables["robots"] = self._robots()
        if "trajectory" in self._record:
            samples = self._trajectory
            tables["trajectory"] = {name: np.concatenate([s[name] for s in samples]) for name in _TRAJECTORY}
        return tables

    def _robots(self) -> Table:
        seconds, state = self._state.controller.seconds, self._state
        rows: list[tuple[Any, ...]] = []
        for robot in itertools.chain.from_iterable(map(state.players, range(len(state.members)))):
            t_a, t_p = robot.times()
            times = seconds(sum(t_a)), seconds(t_p)
            identity = robot.number, robot.swarm + 1, robot.policy_name
            rows.append((*identity, robot.pucks, *times, snapshot_of(robot.policy)))
        return dict(zip(_ROBOTS, _columns(rows, len(_ROBOTS)), strict=True))


def _places(state: GameState) -> dict[str, Any]:
    """Return the rows of a sample in the trajectory: columns by name, without an object for each robot."""
    bodies = state.states.bodies
    return {
        "time": np.full(len(bodies.x), state.time),
        "robot": np.array(state.states.numbers),
        "state": np.where(bodies.phase == ACTION, "A", "P"),
        "puck": bodies.carrying > 0,
        "x": bodies.x.copy(),
        "y": bodies.y.copy(),
        "heading": bodies.heading.copy(),
    }


def _columns(rows: list[tuple[Any, ...]], width: int) -> list[list[Any]]:
    """Return the columns of rows."""
    return [[row[k] for row in rows] for k in range(width)]


def _make_room(collector: DataCollector, step: int) -> None:
    """Prepare a collector for row `step`, whatever a user collected, added or removed before."""
    values = collector.model_vars
    for name in values.keys() - collector.model_reporters.keys():
        del values[name]
    for name in collector.model_reporters:
        column = values.setdefault(name, [])
        del column[step:]
        column += [None] * (step - len(column))


def _sample_row(state: GameState) -> dict[str, Any]:
    """Return the values of all model reporters."""
    ended = state.ended or ("running" if state.running else "stopped")
    sample = {"time": state.time, "game_time": state.duration, "ended": ended, "run_seed": state.seed}
    for k in range(len(state.members)):
        t_a, t_p = state.times(k)
        share = float(share_of_time(sum(t_a), sum(t_a), t_p))
        row = _result_row(state, k, t_a, t_p) | {"share_a": share, "share_p": 1.0 - share}
        sample |= {f"{name}_{k + 1}": value for name, value in row.items() if name not in _NOT_REPORTED}
    return sample


def result_rows(state: GameState) -> list[dict[str, Any]]:
    """Return one row per swarm: the columns of the table ``runs`` from ``swarm`` on."""
    return [_result_row(state, k, *state.times(k)) for k in range(len(state.members))]


def _result_row(state: GameState, k: int, t_a: list[int], t_p: int) -> dict[str, Any]:
    seconds, members = state.controller.seconds, state.players(k)
    conflicts = [sum(robot.conflicts[m] for robot in members) for m in range(len(t_a))]
    return {
        "swarm": k + 1,
        "size": len(members),
        "policy": state.game.swarms[k].policy_name,
        "pucks": state.pucks[k],
        "sud": swarm_utility_difference(state.pucks, k),
        "t_a_intra": seconds(t_a[k]),
        "t_a_inter": seconds(sum(t_a) - t_a[k]),
        "t_p": seconds(t_p),
        "conflicts_intra": conflicts[k],
        "conflicts_inter": sum(conflicts) - conflicts[k],
        "duration": state.duration,
        "ended": state.ended,
    }


def policy_rows(state: GameState) -> list[dict[str, Any]]:
    """Return one row per learning swarm, swarm learned about and action: the table ``policies``."""
    actions = state.game.action_set
    rows: list[dict[str, Any]] = []
    for k in range(len(state.members)):
        of_robots = [best_actions(snapshot_of(robot.policy), actions) for robot in state.players(k)]
        for opponent in sorted({m for best in of_robots for m in best}):
            learned = [best[opponent] for best in of_robots if opponent in best]
            shares = {a.name: sum(b.name == a.name for b in learned) / len(learned) for a in actions}
            attack_share = sum(action.direction == TOWARDS for action in learned) / len(learned)
            for name, share in shares.items():
                row = (k + 1, opponent + 1, name, share, attack_share)
                rows.append(dict(zip(_POLICIES, row, strict=True)))
    return rows


def save_policies(state: GameState, swarm: int, path: str | PathLike[str]) -> None:
    """Save what the robots of a swarm (from 1) learned, for the policy ``learned(file="…")``.

    Raises
    ------
    InputError
        If the game has no such swarm, or it does not learn.
    OSError
        If the file cannot be written; an existing file is unchanged.
    """
    require_type("state", state, GameState, "must be a model")
    require_integer("swarm", swarm, 1, len(state.members))
    path = to_path("path", path)
    learned = [snapshot_of(robot.policy) for robot in state.players(swarm - 1)]
    if not learned or not all(learned):
        raise InputError("swarm", swarm, "must be a swarm of learners")
    save_learned(path, swarm, learned)
