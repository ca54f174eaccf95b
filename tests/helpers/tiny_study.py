"""A study with games of two seconds, and functions that read its files."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from kswarms.model.game_model import GameModel
from kswarms.scenarios.cli import invoke
from kswarms.scenarios.description.condition import Condition, SwarmRule
from kswarms.scenarios.description.scenario import Scenario

TINY = Scenario(
    id="tiny",
    title="Games of two seconds",
    densities=(4, 6),
    seeds=10,
    conditions=(
        Condition(swarms=(SwarmRule(policy="avoid"), SwarmRule(policy="attack")), duration=2.0),
        Condition(
            name="learner",
            swarms=(SwarmRule(policy="avoid"), SwarmRule(policy="inter-learner")),
            learning=2.0,
            duration=2.0,
        ),
    ),
)
PLAIN_RUN = ["run", "tiny.toml", "--jobs", "1", "--quiet", "--no-figures"]
RUN = [*PLAIN_RUN, "--record", "robots"]
TABLES = ("runs.parquet", "policies.parquet", "robots.parquet")

Fault = Callable[[GameModel], None]


def read_tables(directory: str) -> list[bytes]:
    return [Path(directory, name).read_bytes() for name in TABLES]


_whole: dict[str, bytes] = {}
"""Files of the study that was played without interruption."""


def uninterrupted_tables() -> list[bytes]:
    """Return the tables of the study, played without interruption; its files are in the directory ``whole``.

    Each process plays it once.
    """
    if not _whole:
        assert invoke([*RUN, "--out", "whole"]) == 0
        _whole.update({path.name: path.read_bytes() for path in Path("whole").iterdir()})
    Path("whole").mkdir(exist_ok=True)
    for name, content in _whole.items():
        Path("whole", name).write_bytes(content)
    return read_tables("whole")


def read_sessions(directory: str = "results") -> list[dict[str, Any]]:
    sessions: list[dict[str, Any]] = json.loads(Path(directory, "manifest.json").read_text())["sessions"]
    return sessions
