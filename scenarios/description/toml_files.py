"""Scenarios as TOML files."""

from pathlib import Path

from kswarms.agents.common.errors import InputError
from kswarms.agents.common.input_files import read_toml, to_path
from kswarms.scenarios.description.scenario import Scenario


def read_scenarios(path: Path) -> list[Scenario]:
    """Read the scenarios of a TOML file: one scenario, or an array ``scenarios`` of several.

    Raises
    ------
    InputError
        If the file cannot be read, or a scenario is invalid.
    """
    path = to_path("id", path)
    content = read_toml("id", path)
    scenarios = content.get("scenarios", content)
    if not isinstance(scenarios, list):
        return [_make_scenario(path.name, content)]
    if len(content) > 1 or not scenarios:
        raise InputError(
            f"{path.name}: scenarios", scenarios, "must not be empty, and must be the only entry"
        )
    return [_make_scenario(f"{path.name}: scenarios.{k}", each) for k, each in enumerate(scenarios)]


def _make_scenario(place: str, content: object) -> Scenario:
    if not isinstance(content, dict):
        raise InputError(place, content, "must be a table")
    try:
        return Scenario(**content)
    except InputError as error:
        raise InputError(f"{place}: {error.field}", error.value, error.allowed) from None
