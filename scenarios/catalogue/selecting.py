"""Which scenarios are meant: from the words of a command line to scenarios that can be played."""

import difflib
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Final

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.catalogue import CATALOGUE, TABLES
from kswarms.scenarios.description.scenario import Scenario
from kswarms.scenarios.description.toml_files import read_scenarios

FIRST_SCENARIO: Final = "fig-6.1c"
"""What is watched if nothing is asked for …"""
USUAL_N: Final = 20
"""… and with how many robots, or nearly."""


def chosen(ids: Iterable[str]) -> list[Scenario]:
    """Return the scenarios of these ids, each once; the id of a table stands for all that it is made of.

    A word that ends in ``.toml`` is the path of a file with scenarios.

    Raises
    ------
    InputError
        If there is no such id or file, or two scenarios of one id differ.
    """
    found: dict[str, Scenario] = {}
    for name in ids:
        scenarios = read_scenarios(Path(name)) if name.endswith(".toml") else _of_catalogue(name)
        for scenario in scenarios:
            if found.setdefault(scenario.id, scenario) != scenario:
                raise InputError("id", scenario.id, "must name one scenario, not two that differ")
    return list(found.values())


def _of_catalogue(name: str) -> list[Scenario]:
    if name not in CATALOGUE and name not in TABLES:
        near = difflib.get_close_matches(name, [*CATALOGUE, *TABLES], cutoff=0.5)
        hint = f"did you mean {' or '.join(near)}?" if near else "see `kswarms list`"
        raise InputError("id", name, f"must be a scenario or table of the list; {hint}")
    return [CATALOGUE[each] for each in (TABLES[name].scenarios if name in TABLES else [name])]


def planned(
    scenarios: Iterable[Scenario], densities: Sequence[int], seeds: int | None, suitable_only: bool
) -> tuple[list[Scenario], list[str]]:
    """Return the scenarios with the densities and the number of seeds asked for in place of their own.

    Parameters
    ----------
    scenarios : iterable of Scenario
        What is to be played.
    densities : sequence of int
        Numbers of robots; none for each scenario's own.
    seeds : int, optional
        Games for each density; None for each scenario's own number.
    suitable_only : bool
        Whether a scenario is played with those densities that suit it alone, or left out if none does.

    Returns
    -------
    scenarios : list of Scenario
        What can be played.
    left_out : list of str
        Ids of those that no density suits.

    Raises
    ------
    InputError
        If a density or the number of seeds is not allowed, or nothing remains.
    """
    playable, left_out = [], []
    for scenario in scenarios:
        wanted = tuple(n for n in densities if not suitable_only or scenario.allows(n))
        if densities and not wanted:
            left_out.append(scenario.id)
            continue
        asked = ({"densities": wanted} if wanted else {}) | ({"seeds": seeds} if seeds is not None else {})
        try:
            playable.append(scenario.replace(**asked))
        except InputError as error:
            raise InputError(error.field, error.value, f"{error.allowed} ({scenario.id})") from None
    if not playable:
        raise InputError("densities", ",".join(map(str, densities)), "must suit some scenario")
    return playable, left_out


def words(text: str) -> list[str]:
    """Read words separated by commas, each once."""
    return list(dict.fromkeys(word.strip() for word in text.split(","))) if text else []


def integers(field: str, text: str | None) -> tuple[int, ...]:
    """Read whole numbers separated by commas, each once, in order; none of no text.

    Raises
    ------
    InputError
        If one is no whole number.
    """
    if text is None:
        return ()
    try:
        return tuple(sorted({int(word) for word in text.split(",")}))
    except ValueError:
        raise InputError(field, text, "must be integers separated by commas, as 6,30,50") from None
