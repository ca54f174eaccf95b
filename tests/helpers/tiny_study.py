"""A study of games of two seconds, and what tests of studies ask of it."""

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
RUN = ["run", "tiny.toml", "--jobs", "1", "--quiet", "--no-figures", "--record", "robots"]
TABLES = ("runs.parquet", "policies.parquet", "robots.parquet")

Fault = Callable[[GameModel], None]


def contents(directory: str) -> list[bytes]:
    return [Path(directory, name).read_bytes() for name in TABLES]


def undisturbed() -> list[bytes]:
    assert invoke([*RUN, "--out", "whole"]) == 0
    return contents("whole")


def sessions(directory: str) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = json.loads(Path(directory, "manifest.json").read_text())["sessions"]
    return found
