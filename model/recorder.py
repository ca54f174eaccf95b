"""What is kept of a game: Mesa's DataCollector, the tables of records, the row of results (section 3.5)."""

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from mesa import DataCollector

from kswarms.agents.actions import TOWARDS
from kswarms.agents.common.columns import RECORDED_TABLES, names
from kswarms.agents.common.errors import InputError
from kswarms.agents.policies.saved import best_actions, save, snapshot_of
from kswarms.agents.robot.conflict import Conflict
from kswarms.agents.theory.swarms import swarm_utility_difference

if TYPE_CHECKING:
    from kswarms.model.game_model import GameModel

RECORDS: Final = ("model", "agents", *RECORDED_TABLES)
"""What can be recorded: samples of the model, of the agents; tables of conflicts, robots, positions."""

Table = dict[str, list[Any]]

_CONFLICT_COLUMNS: Final = names("conflicts")[1:]  # without the run


def parse_record(text: str) -> frozenset[str]:
    """Read a comma-separated list of `RECORDS`.

    Raises
    ------
    InputError
        If there is an unknown name in it.
    """
    record = frozenset(name.strip() for name in text.split(",") if name.strip())
    for name in sorted(record):
        if name not in RECORDS:
            raise InputError("record", name, f"must be one of {', '.join(RECORDS)}")
    return record


def make_collector(swarms: int, record: frozenset[str]) -> DataCollector:
    """Build the DataCollector with what is to be recorded.

    Model reporters: ``time`` (s) and for each swarm ``pucks_k``, ``sud_k``, ``share_a_k``, ``share_p_k``.
    Agent reporters: swarm, state, puck, x, y, heading. Table: conflicts.
    """
    model_reporters: dict[str, Callable[[Any], Any]] = {}
    if "model" in record:
        model_reporters["time"] = lambda model: model.time
        for k in range(swarms):
            model_reporters |= _swarm_reporters(k)
    agent_reporters: dict[str, Callable[[Any], Any]] = {}
    if record & {"agents", "trajectory"}:
        agent_reporters = {
            "swarm": lambda robot: robot.swarm + 1,
            "state": lambda robot: robot.state,
            "puck": lambda robot: robot.carrying,
            "x": lambda robot: float(robot.position[0]),
            "y": lambda robot: float(robot.position[1]),
            "heading": lambda robot: robot.heading,
        }
    tables = {"conflicts": list(_CONFLICT_COLUMNS)} if "conflicts" in record else {}
    return DataCollector(model_reporters, agent_reporters, tables=tables)


def _swarm_reporters(swarm: int) -> dict[str, Callable[[Any], Any]]:
    return {
        f"pucks_{swarm + 1}": lambda model: model.pucks[swarm],
        f"sud_{swarm + 1}": lambda model: swarm_utility_difference(model.pucks, swarm),
        f"share_a_{swarm + 1}": lambda model: _share_of_action(model, swarm),
        f"share_p_{swarm + 1}": lambda model: 1.0 - _share_of_action(model, swarm),
    }


def _share_of_action(model: "GameModel", swarm: int) -> float:
    """Return a swarm's T(a) / (T(a) + T(p)) so far, 0 at the very start."""
    t_a, t_p = model.times(swarm)
    played = sum(t_a) + t_p
    return sum(t_a) / played if played > 0 else 0.0


def add_conflicts(model: "GameModel", conflicts: Iterable[Conflict]) -> None:
    """Write closed conflicts to the DataCollector's table, times in seconds, swarms counted from 1.

    ``seen`` has a tuple for each swarm: the numbers of its robots that the sensors read, ascending.
    """
    seconds, robots = model.habits.seconds, model.robots
    for c in conflicts:
        robot, opponent = robots[c.robot], robots[c.opponent]
        seen: list[list[int]] = [[] for _ in model.members]
        for j in sorted(c.seen):
            if j >= 0:
                seen[robots[j].swarm].append(robots[j].number)
        row = (
            *(model.phase, robot.number, robot.swarm + 1, opponent.number, opponent.swarm + 1),
            *(seconds(c.start), c.x, c.y, c.action.name, seconds(c.t_a), seconds(c.t_p), c.active),
            *(tuple(map(tuple, seen)), c.reward, c.value),
        )
        model.datacollector.add_table_row("conflicts", dict(zip(_CONFLICT_COLUMNS, row, strict=True)))


def robots_table(model: "GameModel") -> Table:
    """Return one row for each robot, times in seconds."""
    seconds = model.habits.seconds
    times = [robot.times() for robot in model.robots]
    return {
        "robot": [robot.number for robot in model.robots],
        "swarm": [robot.swarm + 1 for robot in model.robots],
        "policy": [robot.policy_name for robot in model.robots],
        "pucks": [robot.pucks for robot in model.robots],
        "t_a": [seconds(sum(t_a)) for t_a, _ in times],
        "t_p": [seconds(t_p) for _, t_p in times],
        "arms": [snapshot_of(robot.policy) for robot in model.robots],
    }


def trajectory_table(model: "GameModel") -> Table:
    """Return where every robot was at every sample."""
    table: Table = {name: [] for name in names("trajectory")[1:]}
    reporters = list(model.datacollector.agent_reporters)
    for step, rows in model.datacollector._agent_records.items():
        for row in rows:
            seen = dict(zip(reporters, row[2:], strict=True))
            seen |= {"time": model.sample_times[step], "robot": row[1] - 1}
            for name in table:
                table[name].append(seen[name])
    return table


def result_rows(model: "GameModel") -> list[dict[str, Any]]:
    """Return one row for each swarm with the columns of ``runs.parquet`` that the game knows of."""
    seconds = model.habits.seconds
    rows = []
    for k, swarm in enumerate(model.game.swarms):
        t_a, t_p = model.times(k)
        conflicts = [sum(robot.conflicts[m] for robot in model.members[k]) for m in range(len(t_a))]
        rows.append(
            {
                "swarm": k + 1,
                "size": len(model.members[k]),
                "policy": swarm.policy,
                "pucks": model.pucks[k],
                "sud": swarm_utility_difference(model.pucks, k),
                "t_a_intra": seconds(t_a[k]),
                "t_a_inter": seconds(sum(t_a) - t_a[k]),
                "t_p": seconds(t_p),
                "conflicts_intra": conflicts[k],
                "conflicts_inter": sum(conflicts) - conflicts[k],
                "duration": model.duration,
                "ended": model.ended,
            }
        )
    return rows


def policy_rows(model: "GameModel") -> list[dict[str, Any]]:
    """Return, for each learning swarm, swarm learned about and action, the share of robots that chose it.

    The columns of ``policies.parquet`` from ``swarm`` on.
    """
    rows = []
    for k, members in enumerate(model.members):
        of_robots = [best_actions(snapshot_of(robot.policy), model.game.action_set) for robot in members]
        for opponent in sorted({m for actions in of_robots for m in actions}):
            learned = [actions[opponent] for actions in of_robots if opponent in actions]
            shares = {
                a.name: sum(b.name == a.name for b in learned) / len(learned) for a in model.game.action_set
            }
            attack_share = sum(action.direction == TOWARDS for action in learned) / len(learned)
            rows += [
                {
                    "swarm": k + 1,
                    "opponent": opponent + 1,
                    "action": name,
                    "share": share,
                    "attack_share": attack_share,
                }
                for name, share in shares.items()
            ]
    return rows


def save_policies(model: "GameModel", swarm: int, path: Path) -> None:
    """Write what the robots of a swarm (from 1) have learned, to be played as ``learned(file="…")``.

    Raises
    ------
    InputError
        If it is no swarm of the game, or not one of learners.
    OSError
        If the file cannot be written; then nothing is.
    """
    if not 1 <= swarm <= len(model.members):
        raise InputError("swarm", swarm, f"must be in 1 to {len(model.members)}")
    learned = [snapshot_of(robot.policy) for robot in model.members[swarm - 1]]
    if not all(learned):
        raise InputError("swarm", swarm, "must be a swarm of learners")
    save(path, swarm, learned)
