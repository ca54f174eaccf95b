"""Scenarios as TOML files."""

import tomllib
from pathlib import Path

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.description.scenario import Scenario


def read_scenarios(path: Path) -> list[Scenario]:
    """Read the scenarios of a TOML file: one, or several as its array ``scenarios``.

    Parameters
    ----------
    path : Path
        A file as ``kswarms show`` prints it.

    Raises
    ------
    InputError
        If it cannot be read, or one of its scenarios could not be played.
    """
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except (OSError, ValueError, RecursionError) as error:
        reason = error.strerror if isinstance(error, OSError) else error
        raise InputError("id", str(path), f"must be a file of TOML ({reason})") from error
    several = content.get("scenarios", content)
    if not isinstance(several, list):
        return [_scenario(path.name, content)]
    if len(content) > 1 or not several:
        raise InputError(f"{path.name}: scenarios", several, "must be some, and all that is in the file")
    return [_scenario(f"{path.name}: scenarios.{k}", each) for k, each in enumerate(several)]


def _scenario(place: str, content: object) -> Scenario:
    if not isinstance(content, dict):
        raise InputError(place, content, "must be a table")
    try:
        return Scenario(**content)
    except InputError as error:
        raise InputError(f"{place}: {error.field}", error.value, error.allowed) from None
