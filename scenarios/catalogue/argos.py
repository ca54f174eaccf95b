"""Scenarios with the controller of the ARGoS measurements, to compare the physics (docs/fidelity.md)."""

from typing import Final

from kswarms.scenarios.catalogue.builders import curve, swarm
from kswarms.scenarios.description.scenario import Scenario

DENSITIES: Final = (6, 16, 26, 36, 46)

ARGOS: Final = tuple(
    Scenario(
        id=f"argos-{first}-{second}",
        title=f"{first.capitalize()} against {second}, as in ARGoS",
        densities=DENSITIES,
        conditions=curve(swarm(first), swarm(second), parameters="argos", body="argos-footbot"),
    )
    for first, second in (("avoid", "avoid"), ("attack", "attack"), ("avoid", "attack"))
)
"""Scenarios that were also simulated in ARGoS."""
