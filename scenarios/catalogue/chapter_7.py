"""A disadvantaged S2: slower, smaller, or farther from a station (chapter 7; specification, section 3.3)."""

from typing import Any, Final

from kswarms.scenarios.catalogue.builders import curve, curves, fast, learner, reward_of, swarm
from kswarms.scenarios.description.condition import SwarmRule
from kswarms.scenarios.description.scenario import Scenario

ADVANTAGE: Final = 7 / 6
"""Advantage b of the opponent, β_m/β_i (Eq. 7.2)."""

AVOID, ATTACK = swarm("avoid"), swarm("attack")
FAST_AVOID, FAST_ATTACK, FAST_MIXED = fast("avoid"), fast("attack"), fast("mixed")

NEARER_STATION: Final[dict[str, Any]] = {"layout": "nearer-station"}
SEVEN_TO_SIX: Final = (13, 26, 39, 52)
DELTAS: Final = (0.02, 0.1, 0.125, 0.145)


def _learner(delta: Any = 0.125, b: float = ADVANTAGE, **rest: Any) -> SwarmRule:
    return learner(reward=reward_of(delta=delta, b=b), **rest)


def _by_delta(first: SwarmRule, *deltas: float) -> dict[str, tuple[SwarmRule, ...]]:
    return {f"delta={delta}": (first, _learner(delta)) for delta in deltas}


def _three(second: SwarmRule) -> tuple[SwarmRule, ...]:
    """Return `second` as S2, between the two halves of a fast mixed swarm; S1 may have one robot more."""
    return FAST_AVOID, second.replace(share=2), fast("aggressive")


# fmt: off
DISADVANTAGED: Final = (
    Scenario(id="fig-7.1", title="Fast avoid against avoid", conditions=curve(FAST_AVOID, AVOID)),
    Scenario(id="fig-7.2a", title="Fast avoid against attack", conditions=curve(FAST_AVOID, ATTACK)),
    Scenario(id="fig-7.2b", title="Fast attack against avoid", conditions=curve(FAST_ATTACK, AVOID)),
    Scenario(id="fig-7.3", title="Fast attack against inter-learner, Δ = 0.145",
             conditions=curve(FAST_ATTACK, _learner(0.145))),
    Scenario(id="fig-7.4", title="Fast attack against inter-learner of several Δ, and against avoid",
             conditions=curves(_by_delta(FAST_ATTACK, 0.1, 0.125, 0.145) | {"avoid": (FAST_ATTACK, AVOID)})),
    Scenario(id="fig-7.5", title="Fast avoid against inter-learner, Δ = 0.145",
             conditions=curve(FAST_AVOID, _learner(0.145))),
    Scenario(id="fig-7.6", title="Fast avoid against inter-learner of several Δ, avoid and attack",
             conditions=curves(_by_delta(FAST_AVOID, *DELTAS)
                               | {"avoid": (FAST_AVOID, AVOID), "attack": (FAST_AVOID, ATTACK)})),
    Scenario(id="fig-7.7a", title="Fast mixed against avoid", conditions=curve(FAST_MIXED, AVOID)),
    Scenario(id="fig-7.7b", title="Fast mixed against attack", conditions=curve(FAST_MIXED, ATTACK)),
    Scenario(id="fig-7.8", title="Fast mixed against inter-learner of several Δ, and against avoid",
             conditions=curves(_by_delta(FAST_MIXED, *DELTAS) | {"avoid": (FAST_MIXED, AVOID)})),
    Scenario(id="fig-7.10", title="Fast avoid and fast aggressive, each half the size of S2, against "
             "inter-learner of several Δ, and against avoid",
             conditions=curves({f"delta={delta}": _three(_learner(delta)) for delta in DELTAS}
                               | {"avoid": _three(AVOID)}, multiple_of=2)),
    Scenario(id="fig-7.11", title="Fast avoid and fast aggressive, each half the size of S2, against "
             "inter-learner of several Δ about S1, and against avoid",
             conditions=curves({f"delta={delta}": _three(_learner({1: delta, 3: 0.125})) for delta in DELTAS}
                               | {"avoid": _three(AVOID)}, multiple_of=2)),
    Scenario(id="fig-7.12", title="Avoid against avoid, seven robots to six", densities=SEVEN_TO_SIX,
             conditions=curve(swarm("avoid", share=7), swarm("avoid", share=6))),
    Scenario(id="fig-7.13a", title="Attack against avoid, seven robots to six", densities=SEVEN_TO_SIX,
             conditions=curve(swarm("attack", share=7), swarm("avoid", share=6))),
    Scenario(id="fig-7.13b", title="Attack against inter-learner, seven robots to six",
             densities=SEVEN_TO_SIX, conditions=curve(swarm("attack", share=7), _learner(share=6))),
    Scenario(id="fig-7.15", title="Avoid, nearer a station, against avoid",
             conditions=curve(AVOID, AVOID, **NEARER_STATION)),
    Scenario(id="fig-7.16a", title="Avoid, nearer a station, against inter-learner, b = 1",
             conditions=curve(AVOID, _learner(b=1.0), **NEARER_STATION)),
    Scenario(id="fig-7.16b", title="Avoid, nearer a station, against inter-learner, b = 7/6",
             conditions=curve(AVOID, _learner(), **NEARER_STATION)),
    Scenario(id="fig-7.17", title="Attack, nearer a station, against avoid",
             conditions=curve(ATTACK, AVOID, **NEARER_STATION)),
    Scenario(id="fig-7.18a", title="Attack, nearer a station, against inter-learner, b = 1",
             conditions=curve(ATTACK, _learner(b=1.0), **NEARER_STATION)),
    Scenario(id="fig-7.18b", title="Attack, nearer a station, against inter-learner, b = 7/6",
             conditions=curve(ATTACK, _learner(), **NEARER_STATION)),
    Scenario(id="fig-7.19", title="Attack, nearer a station, against inter-learner of both b, and avoid",
             conditions=curves({"b=1": (ATTACK, _learner(b=1.0)), "b=7/6": (ATTACK, _learner()),
                                "avoid": (ATTACK, AVOID)}, **NEARER_STATION)),
)
# fmt: on
"""Scenarios of chapter 7, in the order of the source."""
