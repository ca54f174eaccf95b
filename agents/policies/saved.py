"""Save and load learned policies."""

import json
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal, Self

from pydantic import Field, model_validator

from kswarms.agents.actions import AWAY, Action
from kswarms.agents.common.atomic_files import atomic_path
from kswarms.agents.common.descriptions import FrozenModel
from kswarms.agents.common.errors import InputError
from kswarms.agents.common.input_files import read_json, require_regular_file
from kswarms.agents.policies.interface import Policy, Setting


class _SavedArm(FrozenModel):
    opponent: int
    action: str
    reward: float
    time: float
    count: float
    q: float | None

    @model_validator(mode="after")
    def _check_q(self) -> Self:
        if (self.q is None) != (self.count <= 0):
            raise ValueError(f"q={self.q!r} where count={self.count:g}")
        return self


class SavedPolicies(FrozenModel):
    """Learned policies of the robots of a swarm, as stored in a file."""

    format: Literal["kswarms-policies-1"] = "kswarms-policies-1"
    swarm: int
    robots: tuple[tuple[_SavedArm, ...], ...] = Field(min_length=1)


class LearnedPolicy:
    """Actions learned in another game: argmax Q for each opponent swarm, flight without data.

    `file` is the path of a file written by `save_learned`. It must have the actions and swarms of the game.
    Robot k takes policy k of the file, modulo their number, so the size of the swarm may differ.
    """

    def __init__(self, setting: Setting, file: str = "") -> None:
        if not isinstance(file, str) or not file:
            raise InputError("file", file, "must be the path of a file of learned policies")
        saved = load_learned(Path(file))
        if saved.swarm != setting.swarm + 1:
            rule = f"must hold policies of swarm {setting.swarm + 1}, not {saved.swarm}"
            raise InputError("file", file, rule)
        names = [action.name for action in setting.actions]
        for arm in (arm for arms in saved.robots for arm in arms):
            if arm.action not in names:
                raise InputError("file", file, f"has action {arm.action}, the game {', '.join(names)}")
            if not 1 <= arm.opponent <= setting.swarms:
                raise InputError("file", file, f"has swarm {arm.opponent}, the game has {setting.swarms}")
        self.swarm = setting.swarm
        self._flight = default_action(setting.actions)
        arms = saved.robots[setting.place % len(saved.robots)]
        self._actions = best_actions([dict(arm) for arm in arms], setting.actions)

    def choose(self, opponent: int) -> Action:
        """Return the action against a robot of swarm `opponent` (from 0)."""
        return self._actions.get(opponent, self._flight)

    def __repr__(self) -> str:
        known = {swarm + 1: action.name for swarm, action in self._actions.items()}
        return f"LearnedPolicy(swarm={self.swarm}, actions={known})"


def default_action(actions: Sequence[Action]) -> Action:
    """Return the first flight, or the first action if there is no flight."""
    return next((action for action in actions if action.direction == AWAY), actions[0])


def best_actions(arms: Sequence[Mapping[str, Any]], actions: Sequence[Action]) -> dict[int, Action]:
    """Return the action with the greatest Q for each opponent swarm (from 0), or the default action."""
    by_name = {action.name: action for action in actions}
    best: dict[int, Mapping[str, Any] | None] = {}
    for arm in arms:
        opponent = arm["opponent"] - 1
        known = best.setdefault(opponent, None)
        if arm["count"] > 0 and (known is None or arm["q"] > known["q"]):
            best[opponent] = arm
    default = default_action(actions)
    return {swarm: default if arm is None else by_name[arm["action"]] for swarm, arm in best.items()}


def snapshot_of(policy: Policy) -> list[dict[str, Any]]:
    """Return the learned arms of a policy, as in `Learner.snapshot`; empty if it has no such method."""
    snapshot: Callable[[], list[dict[str, Any]]] = getattr(policy, "snapshot", list)
    return snapshot()


def save_learned(path: Path, swarm: int, robots: Sequence[Sequence[Mapping[str, Any]]]) -> None:
    """Write the learned policies of swarm `swarm` (from 1) atomically; `robots` has a snapshot per robot."""
    saved = SavedPolicies(swarm=swarm, robots=[list(map(_without_nan, arms)) for arms in robots])
    text = json.dumps(saved.model_dump(), indent=1)
    with atomic_path(path) as file:
        file.write_text(text, encoding="utf-8")


def _without_nan(arm: Mapping[str, Any]) -> dict[str, Any]:
    # JSON has no NaN, which is the Q of an untried arm.
    return {**arm, "q": arm["q"] if arm["count"] > 0 else None}


def check_arms(arms: Sequence[Mapping[str, Any]]) -> None:
    """Raise an `InputError`, KeyError or TypeError if arms are not as in `Learner.snapshot`."""
    for arm in arms:
        _SavedArm(**_without_nan(arm))


def load_learned(path: Path) -> SavedPolicies:
    """Read a file written by `save_learned`; raise an `InputError` if it is missing or invalid."""
    require_regular_file("file", path)
    return _load(path, path.stat().st_mtime_ns)


@lru_cache(maxsize=16)
def _load(path: Path, _modified: int) -> SavedPolicies:
    # The cache is keyed by the modification time too, so that a changed file is read again.
    kind = "a file of learned policies"
    content = read_json("file", path, kind)
    try:
        return SavedPolicies(**content)
    except (ValueError, TypeError) as error:
        raise InputError("file", str(path), f"must be {kind} ({error})") from None
