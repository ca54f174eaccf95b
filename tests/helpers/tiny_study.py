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
    seeds=20,
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


def uninterrupted_tables() -> list[bytes]:
    """Play the study without interruption, and return its tables."""
    assert invoke([*RUN, "--out", "whole"]) == 0
    return read_tables("whole")


def read_sessions(directory: str = "results") -> list[dict[str, Any]]:
    sessions: list[dict[str, Any]] = json.loads(Path(directory, "manifest.json").read_text())["sessions"]
    return sessions
