"""Columns of every table of results: one schema for writers, readers, replay and documentation.

Robots are numbered from 0, swarms from 1. The table ``runs`` is stored in ``runs.parquet``, and so on.
"""

import re
from typing import Final, NamedTuple

SCHEMA_VERSION: Final = 1
"""Stored in the metadata of Parquet files (since 0.2.0); incremented when a column changes."""

LARGEST: Final = 2.0**53
"""Largest magnitude of a number."""
LONGEST_TEXT: Final = 10_000
"""Maximum number of characters of a text."""

_SCHEMA: Final = """
runs: one row for each run, swarm and curve that contains the run
key: scenario, condition, n, seed, swarm
run             | text    |     |               | digest of the game, its seed and the version
scenario        | text    |     |               | id of the scenario
condition       | text    |     |               | name of the curve; may be empty
n               | integer | ≥ 1 |               | robots in all
seed            | integer | ≥ 0 |               | seed of the game
swarm           | integer | ≥ 1 |               | number of the swarm
size            | integer | ≥ 0 |               | robots in the measured game, also if removed in it
policy          | text    |     |               | policy, with its arguments
pucks           | integer | ≥ 0 |               | pucks deposited
sud             | integer |     | pucks         | Swarm Utility Difference: own pucks − all others (Eq. 3.7)
t_a_intra       | real    | ≥ 0 | robot-seconds | T(a) of conflicts within the swarm
t_a_inter       | real    | ≥ 0 | robot-seconds | T(a) of conflicts with other swarms
t_p             | real    | ≥ 0 | robot-seconds | T(p)
conflicts_intra | integer | ≥ 0 |               | conflicts begun within the swarm
conflicts_inter | integer | ≥ 0 |               | conflicts begun with other swarms
duration        | real    | ≥ 0 | s             | length of the measured game
ended           | text    |     |               | end of the game: `time`, `pucks` or `cap`

policies: one row for each run, learning swarm, swarm learned about, action and curve
key: scenario, condition, n, seed, swarm, opponent, action
run          | text    |        |  | digest of the game, its seed and the version
scenario     | text    |        |  | id of the scenario
condition    | text    |        |  | name of the curve; may be empty
n            | integer | ≥ 1    |  | robots in all
seed         | integer | ≥ 0    |  | seed of the game
swarm        | integer | ≥ 1    |  | number of the swarm
opponent     | integer | ≥ 1    |  | number of the swarm learned about
action       | text    |        |  | name of the action
share        | real    | 0 to 1 |  | share of the swarm's robots for which the action is best
attack_share | real    | 0 to 1 |  | share of them whose best action drives towards the opponent

conflicts: one row for each conflict that a robot began
key: run, robot, start
run            | text                    |                |   | digest of the game, its seed and the version
phase          | text                    | learning, game |   | phase of the game
robot          | integer                 | ≥ 0            |   | number of the robot
swarm          | integer                 | ≥ 1            |   | number of the swarm
opponent       | integer                 | ≥ 0            |   | number of the robot met
opponent_swarm | integer                 | ≥ 1            |   | number of its swarm
start          | real                    | ≥ 0            | s | time since the beginning, learning included
x              | real                    |                | m | position
y              | real                    |                | m | position
action         | text                    |                |   | name of the action
t_a            | real                    | ≥ 0            | s | T(a), time in the action
t_p            | real                    | ≥ 0            | s | T(p), time until the next conflict
active         | integer                 | ≥ 0            |   | active sensors, n′
seen           | list of list of integer | ≥ 0            |   | detected robots, a list for each swarm
reward         | real                    | or missing     | s | reward R, missing if nothing is learned
q              | real                    | or missing     |   | Q of the action, missing if nothing is learned

robots: one row for each robot of the measured game, at its end or at its removal from the game
key: run, robot
run    | text        |     |   | digest of the game, its seed and the version
robot  | integer     | ≥ 0 |   | number of the robot
swarm  | integer     | ≥ 1 |   | number of the swarm
policy | text        |     |   | policy, with its arguments
pucks  | integer     | ≥ 0 |   | pucks deposited
t_a    | real        | ≥ 0 | s | time in actions
t_p    | real        | ≥ 0 | s | time in the program
arms   | list of arm |     |   | what the robot learned

trajectory: one row for each sample and robot
key: run, time, robot
run     | text    |      |     | digest of the game, its seed and the version
time    | real    | ≥ 0  | s   | time of the sample
robot   | integer | ≥ 0  |     | number of the robot
x       | real    |      | m   | position
y       | real    |      | m   | position
heading | real    |      | rad | direction, counter-clockwise from the x-axis
state   | text    | P, A |     | P: program, A: action
puck    | boolean |      |     | whether the robot carries a puck

contribution: one row for each game and robot, which compares the game with and without the robot
key: scenario, condition, absent_from, n, seed, robot
scenario              | text    |                |               | id of the scenario
condition             | text    |                |               | name of the curve; may be empty
absent_from           | text    | learning, game |               | first phase without the robot
run                   | text    |                |               | digest of the game with the robot
run_without           | text    |                |               | digest of the game without it
policy                | text    |                |               | policy, with its arguments
n                     | integer | ≥ 1            |               | robots in all
seed                  | integer | ≥ 0            |               | seed of the game
robot                 | integer | ≥ 0            |               | number of the robot
swarm                 | integer | ≥ 1            |               | number of the swarm
sud                   | integer |                | pucks         | SUD of the robot's swarm
sud_without           | integer |                | pucks         | the same without the robot
time_sud              | real    | or missing     | s             | SUD of its swarm in time-utility
time_sud_without      | real    | or missing     | s             | the same without the robot
reward                | real    |                | s             | sum of its rewards R in the game
reward_time           | real    | ≥ 0            | s             | sum of T(a) + T(p) of the same conflicts
duration              | real    | ≥ 0            | s             | length of the measured game
duration_without      | real    | ≥ 0            | s             | the same without the robot
mates_t_a             | real    | ≥ 0            | robot-seconds | T(a) of the robot's mates
mates_t_a_without     | real    | ≥ 0            | robot-seconds | the same without the robot
mates_t_a_met         | real    | ≥ 0            | robot-seconds | T(a) of its mates in conflicts with it
mates_t_p             | real    | ≥ 0            | robot-seconds | T(p) of its mates
mates_t_p_without     | real    | ≥ 0            | robot-seconds | the same without the robot
opponents_t_a         | real    | ≥ 0            | robot-seconds | T(a) of the robot's opponents
opponents_t_a_without | real    | ≥ 0            | robot-seconds | the same without the robot
opponents_t_a_met     | real    | ≥ 0            | robot-seconds | T(a) of these in conflicts with it
opponents_t_p         | real    | ≥ 0            | robot-seconds | T(p) of its opponents
opponents_t_p_without | real    | ≥ 0            | robot-seconds | the same without the robot

arms: the elements of the column `arms` of the table of robots
opponent | integer | ≥ 1        |   | number of the opponent's swarm
action   | text    |            |   | name of the action
reward   | real    |            | s | sum of the rewards, discounted if the selection rule discounts
time     | real    | ≥ 0        | s | sum of T(a) + T(p), likewise discounted
count    | real    | ≥ 0        |   | number of conflicts, likewise discounted
q        | real    | or missing |   | Q = reward / time (Eq. 4.15), missing if never tried
"""
"""Name, kind, allowed values, unit and meaning of each column, by table; the key identifies a row."""


class Column(NamedTuple):
    """A column: name, kind, unit (empty if none), meaning in Markdown, allowed values.

    Kinds: 'text', 'integer', 'real', 'boolean', 'arm' (a struct with the columns `ARM`), 'list of' a kind.
    Allowed values: a range of numbers such as '≥ 0' or '0 to 1', or a list of texts; 'or missing' if a value
    may be null or NaN. Empty: every value of the kind.
    """

    name: str
    kind: str
    unit: str
    meaning: str
    allowed: str = ""

    @property
    def may_be_missing(self) -> bool:
        """Whether a value may be null or NaN."""
        return self.allowed.endswith("or missing")

    @property
    def bounds(self) -> tuple[float, float]:
        """Smallest and largest number."""
        numbers = [float(number) for number in re.findall(r"\d+", self.allowed)]
        low, high = (*numbers, LARGEST, LARGEST)[:2] if numbers else (-LARGEST, LARGEST)
        return low, high

    @property
    def choices(self) -> tuple[str, ...]:
        """Allowed texts; empty if every text is allowed."""
        return tuple(self.allowed.split(", ")) if self.kind == "text" and self.allowed else ()


class _Table(NamedTuple):
    name: str
    description: str
    key: tuple[str, ...]
    columns: tuple[Column, ...]


def _parse(table: str) -> _Table:
    heading, *rows = table.strip().splitlines()
    name, _, description = heading.partition(": ")
    key: tuple[str, ...] = ()
    if rows[0].startswith("key: "):
        key = tuple(rows.pop(0).removeprefix("key: ").split(", "))
    cells = (map(str.strip, row.split("|")) for row in rows)
    columns = (Column(column, kind, unit, text, allowed) for column, kind, allowed, unit, text in cells)
    return _Table(name, description, key, tuple(columns))


_TABLES: Final = [_parse(table) for table in _SCHEMA.split("\n\n")]

TABLES: Final = {table.name: table.columns for table in _TABLES if table.name != "arms"}
"""Columns of each table, in order."""

KEYS: Final = {table.name: table.key for table in _TABLES}
"""Columns whose values together identify a row of each table."""

ARM: Final = _TABLES[-1].columns
"""Columns of an element of ``arms``: what a robot learned of an action against a swarm."""

RECORDED_TABLES: Final = ("conflicts", "robots", "trajectory")
"""Tables that a game records on request."""


def column_names(table: str, *kinds: str) -> tuple[str, ...]:
    """Return the column names of a table, in order; only those of the given kinds, if any."""
    return tuple(column.name for column in TABLES[table] if not kinds or column.kind in kinds)


def data_dictionary() -> str:
    """Return Markdown with a heading of level 3 and a table of columns for each table."""
    lines = []
    for name, description, key, columns in _TABLES:
        title = f"{name}.parquet" if name in TABLES else name
        lines += [f"### `{title}`", "", f"{description[0].upper()}{description[1:]}.", ""]
        if key:
            lines += [f"Key, different in every row: {', '.join(f'`{column}`' for column in key)}.", ""]
        lines += ["| column | kind | allowed | unit | meaning |", "|---|---|---|---|---|"]
        lines += [f"| `{c.name}` | {c.kind} | {c.allowed} | {c.unit} | {c.meaning} |" for c in columns]
        lines.append("")
    return "\n".join(lines)
