"""Columns of every table of results: one schema for writers, readers, replay and documentation.

Robots are numbered from 0, swarms from 1. The table ``runs`` is stored in ``runs.parquet``, and so on.
"""

from typing import Final, NamedTuple

SCHEMA_VERSION: Final = 1
"""Stored in the metadata of Parquet files (since 0.2.0); incremented when a column changes."""

_SCHEMA: Final = """
runs: one row for each run, swarm and curve that contains the run
run             | text    |               | digest of the game, its seed and the version
scenario        | text    |               | id of the scenario
condition       | text    |               | name of the curve, empty if the scenario has only one
n               | integer |               | robots in all
seed            | integer |               | seed of the game
swarm           | integer |               | number of the swarm
size            | integer |               | robots of the swarm in the measured game
policy          | text    |               | policy, with its arguments
pucks           | integer |               | pucks deposited
sud             | integer | pucks         | Swarm Utility Difference: own pucks − all others (Eq. 3.7)
t_a_intra       | real    | robot-seconds | T(a) of conflicts within the swarm
t_a_inter       | real    | robot-seconds | T(a) of conflicts with other swarms
t_p             | real    | robot-seconds | T(p)
conflicts_intra | integer |               | conflicts begun within the swarm
conflicts_inter | integer |               | conflicts begun with other swarms
duration        | real    | s             | length of the measured game
ended           | text    |               | end of the game: `time`, `pucks` or `cap`

policies: one row for each run, learning swarm, swarm learned about, action and curve
run          | text    |  | digest of the game, its seed and the version
scenario     | text    |  | id of the scenario
condition    | text    |  | name of the curve, empty if the scenario has only one
n            | integer |  | robots in all
seed         | integer |  | seed of the game
swarm        | integer |  | number of the swarm
opponent     | integer |  | number of the swarm learned about
action       | text    |  | name of the action
share        | real    |  | share of the swarm's robots for which the action is best
attack_share | real    |  | share of them whose best action drives towards the opponent

conflicts: one row for each conflict that a robot began
run            | text                    |   | digest of the game, its seed and the version
phase          | text                    |   | `learning` or `game`
robot          | integer                 |   | number of the robot
swarm          | integer                 |   | number of the swarm
opponent       | integer                 |   | number of the robot met
opponent_swarm | integer                 |   | number of its swarm
start          | real                    | s | time since the beginning, learning included
x              | real                    | m | position
y              | real                    | m | position
action         | text                    |   | name of the action
t_a            | real                    | s | T(a), time in the action
t_p            | real                    | s | T(p), time in the program until the next conflict
active         | integer                 |   | active sensors, n′
seen           | list of list of integer |   | robots that the sensors detect, a list for each swarm
reward         | real                    | s | reward R, NaN if nothing is learned
q              | real                    |   | Q of the action after the conflict, NaN if nothing is learned

robots: one row for each robot at the end of its game
run    | text        |   | digest of the game, its seed and the version
robot  | integer     |   | number of the robot
swarm  | integer     |   | number of the swarm
policy | text        |   | policy, with its arguments
pucks  | integer     |   | pucks deposited
t_a    | real        | s | time in actions
t_p    | real        | s | time in the program
arms   | list of arm |   | what the robot learned

trajectory: one row for each sample and robot
run     | text    |     | digest of the game, its seed and the version
time    | real    | s   | time of the sample
robot   | integer |     | number of the robot
x       | real    | m   | position
y       | real    | m   | position
heading | real    | rad | direction, counter-clockwise from the x-axis
state   | text    |     | `P` (program) or `A` (action)
puck    | boolean |     | whether the robot carries a puck

contribution: one row for each game and robot, which compares the game with and without the robot
scenario              | text    |               | id of the scenario
condition             | text    |               | name of the curve, empty if the scenario has only one
absent_from           | text    |               | first phase without the robot: `learning` or `game`
run                   | text    |               | digest of the game with the robot
run_without           | text    |               | digest of the game without it
policy                | text    |               | policy, with its arguments
n                     | integer |               | robots in all
seed                  | integer |               | seed of the game
robot                 | integer |               | number of the robot
swarm                 | integer |               | number of the swarm
sud                   | integer | pucks         | SUD of the robot's swarm
sud_without           | integer | pucks         | the same without the robot
time_sud              | real    | s             | SUD of its swarm in time-utility
time_sud_without      | real    | s             | the same without the robot
reward                | real    | s             | sum of the robot's rewards R in the measured game
reward_time           | real    | s             | sum of T(a) + T(p) of the same conflicts
duration              | real    | s             | length of the measured game
duration_without      | real    | s             | the same without the robot
mates_t_a             | real    | robot-seconds | T(a) of the robot's mates
mates_t_a_without     | real    | robot-seconds | the same without the robot
mates_t_a_met         | real    | robot-seconds | T(a) of its mates in conflicts with it
mates_t_p             | real    | robot-seconds | T(p) of its mates
mates_t_p_without     | real    | robot-seconds | the same without the robot
opponents_t_a         | real    | robot-seconds | T(a) of the robot's opponents
opponents_t_a_without | real    | robot-seconds | the same without the robot
opponents_t_a_met     | real    | robot-seconds | T(a) of its opponents in conflicts with it
opponents_t_p         | real    | robot-seconds | T(p) of its opponents
opponents_t_p_without | real    | robot-seconds | the same without the robot

arms: the elements of the column `arms` of the table of robots
opponent | integer |   | number of the opponent's swarm
action   | text    |   | name of the action
reward   | real    | s | sum of the rewards, discounted if the selection rule discounts
time     | real    | s | sum of T(a) + T(p), likewise discounted
count    | real    |   | number of conflicts, likewise discounted
q        | real    |   | Q = reward / time (Eq. 4.15), NaN if never tried
"""
"""Name, kind, unit and meaning of each column, by table."""


class Column(NamedTuple):
    """A column: name, kind, unit (empty if none), meaning in Markdown.

    Kinds: 'text', 'integer', 'real', 'boolean', 'arm' (a struct with the columns `ARM`), 'list of' a kind.
    """

    name: str
    kind: str
    unit: str
    meaning: str


def _parse(table: str) -> tuple[str, str, tuple[Column, ...]]:
    """Return the name, the description and the columns of a table of the schema."""
    heading, *rows = table.strip().splitlines()
    name, _, description = heading.partition(": ")
    return name, description, tuple(Column(*map(str.strip, row.split("|"))) for row in rows)


_TABLES: Final = [_parse(table) for table in _SCHEMA.split("\n\n")]

TABLES: Final = {name: columns for name, _, columns in _TABLES if name != "arms"}
"""Columns of each table, in order."""

ARM: Final = _TABLES[-1][-1]
"""Columns of an element of ``arms``: what a robot learned of an action against a swarm."""

RECORDED_TABLES: Final = ("conflicts", "robots", "trajectory")
"""Tables that a game records on request."""


def column_names(table: str, *kinds: str) -> tuple[str, ...]:
    """Return the column names of a table, in order; only those of the given kinds, if any."""
    return tuple(column.name for column in TABLES[table] if not kinds or column.kind in kinds)


def data_dictionary() -> str:
    """Return Markdown with a heading of level 3 and a table of columns for each table."""
    lines = []
    for name, description, columns in _TABLES:
        title = f"{name}.parquet" if name in TABLES else name
        lines += [f"### `{title}`", "", f"{description[0].upper()}{description[1:]}.", ""]
        lines += ["| column | kind | unit | meaning |", "|---|---|---|---|"]
        lines += [f"| `{c.name}` | {c.kind} | {c.unit} | {c.meaning} |" for c in columns]
        lines.append("")
    return "\n".join(lines)
