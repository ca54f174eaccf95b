"""Scenarios with the controller of the ARGoS measurements, to compare the physics (docs/fidelity.md)."""

from typing import Any, Final

from kswarms.scenarios.catalogue.builders import curve, swarm
from kswarms.scenarios.description.scenario import Scenario

AVOID, ATTACK = swarm("avoid"), swarm("attack")
IN_ARGOS: Final[dict[str, Any]] = {"parameters": "argos", "body": "argos-footbot"}
DENSITIES: Final = (6, 16, 26, 36, 46)

# fmt: off
ARGOS: Final = (
    Scenario(id="argos-avoid-avoid", title="Avoid against avoid, as in ARGoS", densities=DENSITIES,
             conditions=curve(AVOID, AVOID, **IN_ARGOS)),
    Scenario(id="argos-attack-attack", title="Attack against attack, as in ARGoS", densities=DENSITIES,
             conditions=curve(ATTACK, ATTACK, **IN_ARGOS)),
    Scenario(id="argos-avoid-attack", title="Avoid against attack, as in ARGoS", densities=DENSITIES,
             conditions=curve(AVOID, ATTACK, **IN_ARGOS)),
)
# fmt: on
"""Scenarios that were also simulated in ARGoS."""
