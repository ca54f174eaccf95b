"""Selection of scenarios by id or file."""

import difflib
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Final

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.catalogue import CATALOGUE, TABLES
from kswarms.scenarios.description.scenario import Scenario
from kswarms.scenarios.description.toml_files import read_scenarios

DEFAULT_SCENARIO: Final = "fig-6.1c"
"""Default scenario of `kswarms explore` and `kswarms film`."""
DEFAULT_N: Final = 20
"""Default number of robots of these commands; rounded to a number that the scenario allows."""


def select_scenarios(ids: Iterable[str]) -> list[Scenario]:
    """Return the scenarios of ids and ``.toml`` files, each once. The id of a table selects its scenarios."""
    found: dict[str, Scenario] = {}
    for name in ids:
        scenarios = read_scenarios(Path(name)) if name.endswith(".toml") else _from_catalogue(name)
        for scenario in scenarios:
            if found.setdefault(scenario.id, scenario) != scenario:
                raise InputError("id", scenario.id, "names two different scenarios")
    return list(found.values())


def _from_catalogue(name: str) -> list[Scenario]:
    if name not in CATALOGUE and name not in TABLES:
        near = difflib.get_close_matches(name, [*CATALOGUE, *TABLES], cutoff=0.5)
        hint = f"did you mean {' or '.join(near)}?" if near else "see `kswarms list`"
        raise InputError("id", name, f"must be a scenario or table; {hint}")
    return [CATALOGUE[each] for each in (TABLES[name].scenarios if name in TABLES else [name])]


def with_densities_and_seeds(
    scenarios: Iterable[Scenario], densities: Sequence[int], seeds: int | None, suitable_only: bool
) -> tuple[list[Scenario], list[str]]:
    """Return scenarios with other densities or seeds, and the ids of scenarios that are left out.

    Densities are numbers of robots, seeds are games per density. Each scenario keeps its own by default.
    With `suitable_only`, each scenario ignores densities that it does not allow, and is left out if none
    remains; otherwise such a density raises an `InputError`.
    """
    playable, left_out = [], []
    for scenario in scenarios:
        suitable = tuple(n for n in densities if not suitable_only or scenario.allows(n))
        if densities and not suitable:
            left_out.append(scenario.id)
            continue
        games = scenario.seeds if seeds is None else seeds
        try:
            playable.append(scenario.replace(densities=suitable or scenario.densities, seeds=games))
        except InputError as error:
            raise InputError(error.field, error.value, f"{error.allowed} ({scenario.id})") from None
    if not playable:
        raise InputError("densities", ",".join(map(str, densities)), "must suit at least one scenario")
    return playable, left_out
