"""Inputs of the fuzz test: words of the command line, scenario files, results directories."""

import contextlib
import io
import json
import re
import sqlite3
from collections.abc import Callable
from contextlib import closing
from functools import cache
from pathlib import Path
from random import Random
from typing import Any, Final

import pyarrow as pa
import pyarrow.parquet as pq
import tomlkit

from kswarms.scenarios.cli import invoke
from kswarms.scenarios.description.toml_files import read_scenarios
from tests.fuzz.harness import Input
from tests.fuzz.values import BYTES, JUNK, NUMBERS, TEXTS, WORDS, damage, mutate

SCENARIO: Final[dict[str, Any]] = {
    "id": "tiny",
    "title": "Games of two seconds",
    "densities": [4],
    "seeds": 1,
    "conditions": [
        {"duration": 2.0, "swarms": [{"policy": "avoid"}, {"policy": "attack", "drive": 0.5}]},
        {
            "name": "learner",
            "duration": 2,
            "learning": 1.5,
            "side": 3.0,
            "stations": [[0.0, 0.5]],
            "bases": [[-0.8, 0.0], [0.8, 0.0]],
            "supply": 3,
            "puck_limit": 9,
            "sample_period": 1.0,
            "layout": "symmetric",
            "body": {"radius": 0.08, "sensor_range": 0.5, "top_speed": 0.2},
            "parameters": "fitted, friction=0.3",
            "actions": [
                {"name": "flight", "direction": -1, "duration": 1.0},
                {"name": "fight", "direction": 1, "duration": 1.0},
            ],
            "swarms": [
                {"policy": "inter-learner(rule='ucb')"},
                {"policy": "mixed", "share": 1, "drive_action": 0.7},
            ],
        },
    ],
    "grid": {"parameters.push_share": [0.0, 0.5]},
}
QUICK: Final = ["--jobs", "1", "--no-figures", "--quiet"]
COMMANDS: Final = (
    ["list"],
    ["show", "tiny.toml"],
    ["run", "tiny.toml", "--densities", "4", "--seeds", "1", *QUICK],
    ["run", "tiny.toml", "--out", "study", "--record", "robots,conflicts", *QUICK],
    ["status", "study"],
    ["export", "study"],
    ["merge", "study", "--out", "merged"],
    ["replay", "study", "RUN"],
    ["conflicts", "tiny.toml", "--n", "4", "--from", "0", "--to", "2"],
    ["conflicts", "study", "--run", "RUN"],
    ["film", "tiny.toml", "--sheet", "1", "--to", "1", "--size", "64"],
    ["film", "study", "--run", "RUN", "--sheet", "1", "--size", "64"],
    ["contribution", "tiny.toml", "--n", "4", "--seeds", "1", "--jobs", "1"],
    ["report", "study"],
    ["calibrate", "--waves", "0"],  # refused, as it would play for long
    ["explore", "--port", "-1"],  # refused, as it would serve a page
)
EXPENSIVE: Final = ("--all", "--scheduler", "--install-completion", "--show-completion")


@cache
def _options(command: str) -> tuple[str, ...]:
    output = io.StringIO()
    with contextlib.redirect_stdout(output):
        invoke([command, "--help"])
    return tuple(
        name
        for name in re.findall(r"^\s+(--[\w-]+)", output.getvalue(), re.MULTILINE)
        if name not in EXPENSIVE
    )


def _run_of(directory: Path) -> str:
    return str(pq.read_table(directory / "study" / "runs.parquet")["run"][0].as_py())


def command_line(rng: Random, directory: Path) -> Input:
    """Return a command with words replaced, removed, repeated and added."""
    base = rng.choice(COMMANDS)
    if base[0] in _SLOW and rng.random() < 0.8:
        base = rng.choice(COMMANDS)
    words = [_run_of(directory) if word == "RUN" else word for word in base]
    for _ in range(rng.choice((1, 1, 2, 3))):
        place = rng.randrange(1, len(words) + 1)
        how = rng.choice(("option", "option", "replace", "insert", "remove", "repeat"))
        if how == "option":
            name, value = rng.choice(_options(base[0])), rng.choice(WORDS)
            words[place:place] = [f"{name}={value}"] if rng.random() < 0.5 else [name, value]
        elif how == "insert" or place == len(words):
            words.insert(place, rng.choice(WORDS))
        elif how == "replace":
            words[place] = rng.choice(WORDS)
        elif how == "remove":
            del words[place]
        else:
            words.insert(place, words[place])
    guards = {"calibrate": ["--waves", "0"], "explore": ["--port", "-1"], "run": ["--jobs", "1"]}
    words += guards.get(base[0], [])
    if rng.random() < 0.02:
        words[0] = rng.choice(WORDS)
    return Input(repr(words), words)


def scenario_file(rng: Random, directory: Path) -> Input:
    """Return a command that reads a scenario file with a mistake."""
    data: Any = SCENARIO
    for _ in range(rng.choice((1, 1, 1, 2))):
        data = mutate(rng, data)
    content = (_to_toml(data) if isinstance(data, dict) else str(data)).encode("utf-8", "surrogateescape")
    if rng.random() < 0.15:
        content = damage(rng, _to_toml(SCENARIO).encode())
    path = directory / "mine.toml"
    path.write_bytes(content)
    words = ["show", "mine.toml"]
    if rng.random() < 0.4 and _is_cheap(path):
        words = ["run", "mine.toml", *QUICK]
    return Input(f"{words} {content[:3000]!r}", words)


def _to_toml(data: dict[str, Any]) -> str:
    try:
        return tomlkit.dumps(data)
    except Exception:  # noqa: BLE001  # tomlkit has no None, bytes and the like
        return tomlkit.dumps(
            {key: value if isinstance(value, str) else repr(value) for key, value in data.items()}
        )


def _is_cheap(path: Path) -> bool:
    """Return whether the scenarios of a file are valid and short."""
    try:
        scenarios = read_scenarios(path)
    except Exception:  # noqa: BLE001  # `kswarms show` tells it
        return False
    work = 0.0
    for scenario in scenarios:
        for condition in scenario.conditions:
            periods = (condition.learning + condition.duration) / condition.parameters.period
            samples = (condition.learning + condition.duration) / condition.sample_period
            work += scenario.seeds * sum(scenario.densities) * (periods + samples)
    return work < 5000


def ledger(rng: Random, directory: Path) -> Input:
    """Return a command that reads a ledger with changed cells, rows or bytes."""
    run, path = _run_of(directory), directory / "study" / "ledger.sqlite"
    if rng.random() < 0.2:
        path.write_bytes(damage(rng, path.read_bytes()))
        change = "bytes"
    else:
        change = _change_ledger(rng, path)
    return _read_study(rng, run, f"ledger: {change}")


def _change_ledger(rng: Random, path: Path) -> str:
    with closing(sqlite3.connect(path)) as connection, connection:
        names = [
            name for (name,) in connection.execute("SELECT name FROM sqlite_master WHERE type = 'table'")
        ]
        table = rng.choice(names)
        information = connection.execute(f'PRAGMA table_info("{table}")').fetchall()
        columns = [row[1] for row in information]
        keys = [row[1] for row in information if row[5]] or ["rowid"]
        select = f"{', '.join(keys)}, *"
        rows = connection.execute(f'SELECT {select} FROM "{table}"').fetchall()
        where = " AND ".join(f'"{key}" IS ?' for key in keys)
        how = rng.choice(("cell", "cell", "cell", "cell", "row", "column", "table", "version"))
        if how == "table":
            connection.execute(f'DROP TABLE "{table}"')
        elif how == "column":
            connection.execute(f'ALTER TABLE "{table}" RENAME COLUMN "{rng.choice(columns)}" TO "other"')
        elif how == "version":
            connection.execute(f"PRAGMA user_version = {rng.choice((0, 1, 3, 99, -1))}")
        elif rows and how == "row":
            connection.execute(f'DELETE FROM "{table}" WHERE {where}', rng.choice(rows)[: len(keys)])
        elif rows:
            row, k = rng.choice(rows), rng.randrange(len(columns))
            value = _other_cell(rng, row[len(keys) + k])
            how = f"{table}.{columns[k]} = {value!r:.500}"
            with_checks = rng.random() < 0.5
            connection.execute(f"PRAGMA ignore_check_constraints = {int(not with_checks)}")
            try:
                statement = f'UPDATE "{table}" SET "{columns[k]}" = ? WHERE {where}'
                connection.execute(statement, (value, *row[: len(keys)]))
            except sqlite3.Error:
                how += " (refused)"
        return f"{how} in {table}"


def _other_cell(rng: Random, value: Any) -> Any:
    if isinstance(value, str) and value[:1] in "[{" and rng.random() < 0.8:
        try:
            return json.dumps(mutate(rng, json.loads(value)))
        except ValueError:
            pass
    if isinstance(value, bytes) and value and rng.random() < 0.8:
        return damage(rng, value)
    numbers = [number for number in NUMBERS if not isinstance(number, int) or abs(number) < 2**63]
    texts = [text for text in TEXTS if "\udcff" not in text]
    return rng.choice([*numbers, *texts, *BYTES, None])


def table(rng: Random, directory: Path) -> Input:
    """Return a command that reads a table with changed cells, columns or bytes."""
    run = _run_of(directory)
    path = rng.choice(sorted((directory / "study").glob("*.parquet")))
    if rng.random() < 0.15:
        path.write_bytes(damage(rng, path.read_bytes()))
        change = "bytes"
    else:
        change = _change_table(rng, path)
    return _read_study(rng, run, f"{path.name}: {change}", "report", "film", "conflicts")


def _change_table(rng: Random, path: Path) -> str:
    content = pq.read_table(path)
    name = rng.choice(content.column_names)
    k = content.column_names.index(name)
    values = content[name].to_pylist()
    how = rng.choice(("cell", "cell", "all", "remove", "rename", "rows", "none", "type"))
    if how == "remove":
        changed = content.remove_column(k)
    elif how == "rename":
        changed = content.rename_columns([other + "x" * (other == name) for other in content.column_names])
    elif how == "rows":
        changed = pa.concat_tables([content, content.slice(0, rng.randrange(content.num_rows + 1))])
    elif how == "none":
        changed = content.slice(0, 0)
    else:
        value = rng.choice([item for item in JUNK if isinstance(item, int | float | str | None)])
        column = [value if how == "all" or j == 0 else old for j, old in enumerate(values)]
        kind = pa.string() if how == "type" else content.schema.field(name).type
        how = f"{how} {value!r:.100}"
        try:
            array = pa.array([str(item) for item in column] if kind == pa.string() else column, kind)
        except (pa.ArrowException, OverflowError, UnicodeError, TypeError, ValueError):
            array = pa.array([repr(item) for item in column], pa.string())
        changed = content.set_column(k, name, array)
    pq.write_table(changed, path)
    return f"{name} {how}"


_SLOW: Final = ("report", "film")


def _read_study(rng: Random, run: str, change: str, *commands: str) -> Input:
    every = {
        "status": ["status", "study"],
        "export": ["export", "study"],
        "replay": ["replay", "study", run],
        "conflicts": ["conflicts", "study", "--run", run],
        "film": ["film", "study", "--run", run, "--sheet", "1", "--size", "64"],
        "report": ["report", "study"],
        "run": ["run", "tiny.toml", "--out", "study", *QUICK],
        "merge": ["merge", "study", "--out", "merged"],
    }
    names = [name for name in commands or every if name not in _SLOW or rng.random() < 0.05]
    words = every[rng.choice(names or ["status"])]
    return Input(f"{words} with {change}", words)


GENERATORS: Final[dict[str, Callable[[Random, Path], Input]]] = {
    "command line": command_line,
    "scenario file": scenario_file,
    "ledger": ledger,
    "table": table,
}
