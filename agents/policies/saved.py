"""Learned policies that outlive their game: written to a file, and played in another one."""

import json
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any, Final

from kswarms.agents.actions import AWAY, Action
from kswarms.agents.common.atomic_files import whole
from kswarms.agents.common.descriptions import Checked
from kswarms.agents.common.errors import InputError
from kswarms.agents.policies.interface import Setting

_FORMAT: Final = "kswarms-policies-1"


class _SavedArm(Checked):
    opponent: int
    action: str
    reward: float
    time: float
    count: float
    q: float | None


class LearnedPolicy:
    """What a robot learned in another game: argmax Q for each swarm-ID, flight where it knows none.

    The robots of the swarm take the policies of the file in turn, so it may be larger or smaller than the
    swarm that learned.

    Parameters
    ----------
    setting : Setting
        Where it plays.
    file : str
        Path of a file written by `save`.

    Raises
    ------
    InputError
        If there is no such file, or what was learned does not fit the game.
    """

    def __init__(self, setting: Setting, file: str = "") -> None:
        if not isinstance(file, str) or not file:
            raise InputError("file", file, "must be the path of a file of learned policies")
        saved = load(Path(file))
        if saved["swarm"] != setting.swarm + 1:
            raise InputError(
                "file", file, f"must hold policies of swarm {setting.swarm + 1}, not {saved['swarm']}"
            )
        robots = saved["robots"]
        names = [action.name for action in setting.actions]
        for arm in (arm for arms in robots for arm in arms):
            if arm["action"] not in names:
                raise InputError("file", file, f"has action {arm['action']}, the game {', '.join(names)}")
            if not 1 <= arm["opponent"] <= setting.swarms:
                raise InputError(
                    "file", file, f"knows swarm {arm['opponent']}, the game has {setting.swarms}"
                )
        self.swarm = setting.swarm
        self._flight = flight(setting.actions)
        self._actions = best_actions(robots[setting.place % len(robots)], setting.actions)

    def choose(self, opponent: int) -> Action:
        """Return the action to take against a robot of swarm `opponent` (counted from 0)."""
        return self._actions.get(opponent, self._flight)

    def __repr__(self) -> str:
        known = {swarm + 1: action.name for swarm, action in self._actions.items()}
        return f"LearnedPolicy(swarm={self.swarm}, actions={known})"


def flight(actions: Sequence[Action]) -> Action:
    """Return what is done where nothing is known: the first action that drives away, or the first of all."""
    return next((action for action in actions if action.direction == AWAY), actions[0])


def best_actions(arms: Sequence[Mapping[str, Any]], actions: Sequence[Action]) -> dict[int, Action]:
    """Return argmax Q for each swarm (counted from 0) that arms tell of; flight where none was tried.

    Parameters
    ----------
    arms : sequence of dict
        As of `kswarms.agents.policies.learner.Learner.snapshot`.
    actions : sequence of Action
        The actions of the game.
    """
    by_name = {action.name: action for action in actions}
    best: dict[int, Mapping[str, Any] | None] = {}
    for arm in arms:
        opponent = arm["opponent"] - 1
        known = best.setdefault(opponent, None)
        if arm["count"] > 0 and (known is None or arm["q"] > known["q"]):
            best[opponent] = arm
    return {
        opponent: flight(actions) if arm is None else by_name[arm["action"]] for opponent, arm in best.items()
    }


def save(path: Path, swarm: int, robots: Sequence[Sequence[Mapping[str, Any]]]) -> None:
    """Write the learned policies of a swarm, whole or not at all.

    Parameters
    ----------
    path : Path
        Where to.
    swarm : int
        Swarm-ID, from 1.
    robots : sequence of `kswarms.agents.policies.learner.Learner.snapshot`
        What each of its robots has learned.

    Raises
    ------
    OSError
        If it cannot be written; then nothing is.
    """
    known = [[_without_nan(arm) for arm in arms] for arms in robots]
    text = json.dumps({"format": _FORMAT, "swarm": swarm, "robots": known}, indent=1)
    with whole(path) as file:
        file.write_text(text, encoding="utf-8")


def _without_nan(arm: Mapping[str, Any]) -> dict[str, Any]:
    # JSON has no NaN, the Q of an arm that was never tried.
    return {**arm, "q": arm["q"] if arm["count"] > 0 else None}


def check_arms(arms: Sequence[Mapping[str, Any]]) -> None:
    """Check that arms can be saved.

    Raises
    ------
    InputError, KeyError, TypeError
        If they are not as those of `kswarms.agents.policies.learner.Learner.snapshot`.
    """
    for arm in arms:
        _SavedArm(**_without_nan(arm))


def load(path: Path) -> dict[str, Any]:
    """Read a file written by `save`.

    Raises
    ------
    InputError
        If there is no such file, or it is none of ours.
    """
    try:
        return _load(path, path.stat().st_mtime_ns)
    except (OSError, ValueError, ArithmeticError, KeyError, TypeError, RecursionError) as error:
        raise InputError("file", str(path), f"must be a file of learned policies ({error})") from None


@lru_cache(maxsize=16)
def _load(path: Path, _changed: int) -> dict[str, Any]:
    saved: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    if saved["format"] != _FORMAT or not saved["robots"]:
        raise ValueError(f"not of the form {_FORMAT}")
    robots = [[_SavedArm(**arm).model_dump() for arm in arms] for arms in saved["robots"]]
    for arm in (arm for arms in robots for arm in arms):
        if (arm["q"] is None) != (arm["count"] <= 0):
            raise ValueError(f"q={arm['q']!r} where count={arm['count']:g}")
    return {"swarm": int(saved["swarm"]), "robots": robots}
