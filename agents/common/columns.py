"""Columns of every table of results: one schema for writers, readers, replay and documentation.

Robots are numbered from 0, swarms from 1. ``runs`` is the table in the file ``runs.parquet``, and so on.
"""

from typing import Final, NamedTuple

SCHEMA_VERSION: Final = 1
"""Stored in the metadata of each Parquet file, and raised when a column changes. Files of 0.1.0 have none."""


class Column(NamedTuple):
    """A column: name, kind, unit (empty if none), meaning in Markdown.

    Kinds: 'text', 'integer', 'real', 'boolean', 'arm' (a struct with the columns `ARM`), 'list of' a kind.
    """

    name: str
    kind: str
    unit: str
    meaning: str


_RUN: Final = Column("run", "text", "", "digest of the game, its seed and the version")
_CURVE: Final = (
    Column("scenario", "text", "", "id of the scenario"),
    Column("condition", "text", "", "name of the curve, empty if the scenario has only one"),
)
_N: Final = Column("n", "integer", "", "robots in all")
_SEED: Final = Column("seed", "integer", "", "seed of the game")
_ROBOT: Final = Column("robot", "integer", "", "number of the robot")
_SWARM: Final = Column("swarm", "integer", "", "number of the swarm")
_POLICY: Final = Column("policy", "text", "", "policy, with its arguments")
_PUCKS: Final = Column("pucks", "integer", "", "pucks deposited")
_ACTION: Final = Column("action", "text", "", "name of the action")
_POSITION: Final = (Column("x", "real", "m", "position"), Column("y", "real", "m", "position"))

ARM: Final = (
    Column("opponent", "integer", "", "number of the opponent's swarm"),
    _ACTION,
    Column("reward", "real", "s", "sum of the rewards, discounted if the selection rule discounts"),
    Column("time", "real", "s", "sum of T(a) + T(p), likewise discounted"),
    Column("count", "real", "", "number of conflicts, likewise discounted"),
    Column("q", "real", "", "Q = reward / time (Eq. 4.15), NaN if never tried"),
)
"""What a robot learned of an action against a swarm: an element of the column ``arms``."""

TABLES: Final = {
    "runs": (
        *(_RUN, *_CURVE, _N, _SEED, _SWARM),
        Column("size", "integer", "", "robots of the swarm in the measured game"),
        _POLICY,
        _PUCKS,
        Column("sud", "integer", "pucks", "Swarm Utility Difference: own pucks less all others' (Eq. 3.7)"),
        Column("t_a_intra", "real", "robot-seconds", "T(a) of conflicts within the swarm"),
        Column("t_a_inter", "real", "robot-seconds", "T(a) of conflicts with other swarms"),
        Column("t_p", "real", "robot-seconds", "T(p)"),
        Column("conflicts_intra", "integer", "", "conflicts begun within the swarm"),
        Column("conflicts_inter", "integer", "", "conflicts begun with other swarms"),
        Column("duration", "real", "s", "length of the measured game"),
        Column("ended", "text", "", "end of the game: `time`, `pucks` or `cap`"),
    ),
    "policies": (
        *(_RUN, *_CURVE, _N, _SEED, _SWARM),
        Column("opponent", "integer", "", "number of the swarm learned about"),
        _ACTION,
        Column("share", "real", "", "share of the swarm's robots for which the action is best"),
        Column("attack_share", "real", "", "share of them whose best action leads towards the opponent"),
    ),
    "conflicts": (
        _RUN,
        Column("phase", "text", "", "`learning` or `game`"),
        *(_ROBOT, _SWARM),
        Column("opponent", "integer", "", "number of the robot met"),
        Column("opponent_swarm", "integer", "", "number of its swarm"),
        Column("start", "real", "s", "time since the beginning, learning included"),
        *(*_POSITION, _ACTION),
        Column("t_a", "real", "s", "T(a), time in the action"),
        Column("t_p", "real", "s", "T(p), time in the program until the next conflict"),
        Column("active", "integer", "", "active sensors, n′"),
        Column("seen", "list of list of integer", "", "robots that the sensors read, a list for each swarm"),
        Column("reward", "real", "s", "reward R, NaN if nothing is learned"),
        Column("q", "real", "", "Q of the action after the reward (Eq. 4.15), NaN if nothing is learned"),
    ),
    "robots": (
        *(_RUN, _ROBOT, _SWARM, _POLICY, _PUCKS),
        Column("t_a", "real", "s", "time in actions"),
        Column("t_p", "real", "s", "time in the program"),
        Column("arms", "list of arm", "", "what the robot learned"),
    ),
    "trajectory": (
        *(_RUN, Column("time", "real", "s", "time of the sample"), _ROBOT, *_POSITION),
        Column("heading", "real", "rad", "direction, counter-clockwise from the x-axis"),
        Column("state", "text", "", "`P` (program) or `A` (action)"),
        Column("puck", "boolean", "", "whether the robot carries a puck"),
    ),
    "contribution": (
        *_CURVE,
        Column("absent_from", "text", "", "what the robot is absent from: `learning` (and game) or `game`"),
        Column("run", "text", "", "digest of the game with the robot"),
        Column("run_without", "text", "", "digest of the game without it"),
        *(_POLICY, _N, _SEED, _ROBOT, _SWARM),
        Column("sud", "integer", "pucks", "SUD of the robot's swarm"),
        Column("sud_without", "integer", "pucks", "the same without the robot"),
        Column("time_sud", "real", "s", "SUD of its swarm in time-utility"),
        Column("time_sud_without", "real", "s", "the same without the robot"),
        Column("reward", "real", "s", "sum of the robot's rewards R in the measured game"),
        Column("reward_time", "real", "s", "sum of T(a) + T(p) of the same conflicts"),
        Column("duration", "real", "s", "length of the measured game"),
        Column("duration_without", "real", "s", "the same without the robot"),
        *(
            Column(f"{others}_{name}", "real", "robot-seconds", meaning.format(others))
            for others in ("mates", "opponents")
            for name, meaning in (
                ("t_a", "T(a) of the robot's {}"),
                ("t_a_without", "the same without the robot"),
                ("t_a_met", "T(a) of its {} in conflicts with it"),
                ("t_p", "T(p) of the robot's {}"),
                ("t_p_without", "the same without the robot"),
            )
        ),
    ),
}
"""Columns of each table, in order."""

RECORDED_TABLES: Final = ("conflicts", "robots", "trajectory")
"""Tables that a game records on request."""

_ROWS: Final = {
    "runs": "One row for each run and swarm, repeated for each curve that has the run.",
    "policies": "One row for each run, learning swarm, swarm learned about and action, repeated likewise.",
    "conflicts": "One row for each conflict that a robot began.",
    "robots": "One row for each robot at the end of its game.",
    "trajectory": "One row for each sample and robot.",
    "contribution": "One row for each game and robot, with the game without the robot.",
}


def names(table: str, *kinds: str) -> tuple[str, ...]:
    """Return the names of a table's columns, in order: those of some kinds, or all."""
    return tuple(column.name for column in TABLES[table] if not kinds or column.kind in kinds)


def data_dictionary() -> str:
    """Return the columns of all tables as Markdown, a heading of level 3 and a table each."""
    parts = [(f"`{name}.parquet`", text, TABLES[name]) for name, text in _ROWS.items()]
    parts.append(("`arms`", "Each element of the column `arms` of `robots.parquet`.", ARM))
    lines = []
    for title, text, table in parts:
        lines += [f"### {title}", "", text, "", "| column | kind | unit | meaning |", "|---|---|---|---|"]
        lines += [f"| `{c.name}` | {c.kind} | {c.unit} | {c.meaning} |" for c in table]
        lines.append("")
    return "\n".join(lines)
