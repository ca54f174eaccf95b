"""Scenarios of the catalogue in other worlds."""

from typing import Final

from kswarms.model.description.parameters import Parameters
from kswarms.model.description.presets import PRESETS
from kswarms.scenarios.description.scenario import Scenario

CONTACTS: Final = ("friction", "push_share")
"""Parameters of the contacts. The scenarios ``argos-*`` have these of a world; the others come with ARGoS."""


def in_world(scenario: Scenario, world: Parameters) -> Scenario:
    """Return a scenario with the parameters of a world, except those that the scenario sets itself."""
    changed = [each.replace(parameters=_in_world(each.parameters, world)) for each in scenario.conditions]
    return scenario.replace(conditions=tuple(changed), grid={})


def _in_world(own: Parameters, world: Parameters) -> Parameters:
    if own == PRESETS["argos"]:
        return own.replace(**{name: getattr(world, name) for name in CONTACTS})
    return world.replace(**{name: value for name, value in own if value != getattr(PRESETS["fitted"], name)})
