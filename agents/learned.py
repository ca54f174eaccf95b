"""Learned policies that outlive their game: written to a file, and played in another one."""

import json
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, Final

from agents.actions import AWAY, Action
from agents.errors import InputError
from agents.validation import Checked

if TYPE_CHECKING:
    from agents.policies import Setting

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

    def __init__(self, setting: "Setting", file: str = "") -> None:
        if not isinstance(file, str) or not file:
            raise InputError("file", file, "must be the path of a file of learned policies")
        saved = load(Path(file))
        if saved["swarm"] != setting.swarm + 1:
            raise InputError(
                "file", file, f"must hold policies of swarm {setting.swarm + 1}, not {saved['swarm']}"
            )
        robots = saved["robots"]
        by_name = {action.name: action for action in setting.actions}
        for arm in (arm for arms in robots for arm in arms):
            if arm["action"] not in by_name:
                raise InputError("file", file, f"has action {arm['action']}, the game {', '.join(by_name)}")
            if not 1 <= arm["opponent"] <= setting.swarms:
                raise InputError(
                    "file", file, f"knows swarm {arm['opponent']}, the game has {setting.swarms}"
                )
        self.swarm = setting.swarm
        self._flight = next((a for a in setting.actions if a.direction == AWAY), setting.actions[0])
        self._actions = _best_actions(robots[setting.place % len(robots)], by_name)

    def choose(self, opponent: int) -> Action:
        """Return the action to take against a robot of swarm `opponent` (counted from 0)."""
        return self._actions.get(opponent, self._flight)

    def __repr__(self) -> str:
        known = {swarm + 1: action.name for swarm, action in self._actions.items()}
        return f"LearnedPolicy(swarm={self.swarm}, actions={known})"


def _best_actions(arms: Sequence[Mapping[str, Any]], by_name: Mapping[str, Action]) -> dict[int, Action]:
    best: dict[int, Mapping[str, Any]] = {}
    for arm in arms:
        if arm["q"] is not None:
            opponent = arm["opponent"] - 1
            if opponent not in best or arm["q"] > best[opponent]["q"]:
                best[opponent] = arm
    return {opponent: by_name[arm["action"]] for opponent, arm in best.items()}


def save(path: Path, swarm: int, robots: Sequence[Sequence[Mapping[str, Any]]]) -> None:
    """Write the learned policies of a swarm, whole or not at all.

    Parameters
    ----------
    path : Path
        Where to.
    swarm : int
        Swarm-ID, from 1.
    robots : sequence of `agents.learner.Learner.snapshot`
        What each of its robots has learned.

    Raises
    ------
    OSError
        If it cannot be written; then nothing is.
    """
    # JSON has no NaN, the Q of an arm that was never tried.
    known = [[{**arm, "q": arm["q"] if arm["count"] > 0 else None} for arm in arms] for arms in robots]
    text = json.dumps({"format": _FORMAT, "swarm": swarm, "robots": known}, indent=1)
    with TemporaryDirectory(dir=path.parent, prefix=".unfinished-") as unfinished:
        file = Path(unfinished, path.name)
        file.write_text(text, encoding="utf-8")
        file.replace(path)


def load(path: Path) -> dict[str, Any]:
    """Read a file written by `save`.

    Raises
    ------
    InputError
        If there is no such file, or it is none of ours.
    """
    try:
        return _load(path, path.stat().st_mtime_ns)
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError("file", str(path), f"must be a file of learned policies ({error})") from None


@lru_cache(maxsize=16)
def _load(path: Path, _changed: int) -> dict[str, Any]:
    saved: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    if saved["format"] != _FORMAT or not saved["robots"]:
        raise ValueError(f"not of the form {_FORMAT}")
    robots = [[_SavedArm(**arm).model_dump() for arm in arms] for arms in saved["robots"]]
    return {"swarm": int(saved["swarm"]), "robots": robots}
