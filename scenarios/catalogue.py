"""The catalogue: the source's figures whose swarms follow fixed policies (specification, 3.2 and 3.3).

Each entry is data; the few helpers below only save repetition, so that a line reads as a row of the
specification's tables: id, title, S1, S2 and what differs from the default world.
"""

from collections.abc import Iterable
from typing import Any, Final

from agents.actions import AWAY, TOWARDS, Action
from scenarios.description import Condition, Scenario, SwarmRule


def _index(*scenarios: Scenario) -> dict[str, Scenario]:
    return {scenario.id: scenario for scenario in scenarios}


def _swarm(policy: str, **rule: Any) -> SwarmRule:
    return SwarmRule(policy=policy, **rule)


def _fast(policy: str, **rule: Any) -> SwarmRule:
    """Return a swarm with the advantage of sections 7.2 and 7.3: it drives at 70 % in state P alone."""
    return SwarmRule(policy=policy, drive=0.7, drive_action=0.6, **rule)


def _curve(*swarms: SwarmRule, name: str = "", **world: Any) -> tuple[Condition, ...]:
    return (Condition(name=name, swarms=swarms, **world),)


def _each_alone(actions: Iterable[Action], **world: Any) -> tuple[Condition, ...]:
    """Return a curve for each action: one swarm of robots that always take it."""
    actions = tuple(actions)
    return tuple(
        Condition(name=action.name, swarms=(_swarm(action.name),), actions=actions, **world)
        for action in actions
    )


AVOID, ATTACK = _swarm("avoid"), _swarm("attack")
FAST_AVOID, FAST_ATTACK, FAST_MIXED = _fast("avoid"), _fast("attack"), _fast("mixed")

UNTIL_50_PUCKS: Final[dict[str, Any]] = {"puck_limit": 50, "duration": 36_000.0}
RANDOM_STATIONS: Final[dict[str, Any]] = {"layout": "random-stations"}
NEARER_STATION: Final[dict[str, Any]] = {"layout": "nearer-station"}
ARGOS: Final[dict[str, Any]] = {"parameters": "argos", "body": "argos-footbot"}

SEVEN_TO_SIX: Final = (13, 26, 39, 52)
ARGOS_DENSITIES: Final = (6, 16, 26, 36, 46)
SEEDS_OF_RANDOM_STATIONS: Final = 200

FOUR_ACTIONS: Final = (
    Action(name="flight-50ms", direction=AWAY, duration=0.05),
    Action(name="flight-500ms", direction=AWAY, duration=0.5),
    Action(name="flight-1000ms", direction=AWAY, duration=1.0),
    Action(name="fight-1000ms", direction=TOWARDS, duration=1.0),
)

# fmt: off
CATALOGUE: Final = _index(
    # Symmetric swarms (chapter 6).
    Scenario(id="fig-6.1a", title="Avoid against avoid", conditions=_curve(AVOID, AVOID)),
    Scenario(id="fig-6.1b", title="Attack against attack", conditions=_curve(ATTACK, ATTACK)),
    Scenario(id="fig-6.1c", title="Avoid against attack", conditions=_curve(AVOID, ATTACK)),
    Scenario(id="fig-6.2", title="Avoid against attack, until 50 pucks",
             conditions=_curve(AVOID, ATTACK, **UNTIL_50_PUCKS)),
    Scenario(id="fig-6.3", title="Avoid against attack, until 50 pucks: time in conflict",
             conditions=_curve(AVOID, ATTACK, **UNTIL_50_PUCKS)),
    Scenario(id="fig-6.13a", title="Avoid against attack, random stations", seeds=SEEDS_OF_RANDOM_STATIONS,
             conditions=_curve(AVOID, ATTACK, **RANDOM_STATIONS)),
    Scenario(id="fig-6.13b", title="Avoid against avoid, random stations", seeds=SEEDS_OF_RANDOM_STATIONS,
             conditions=_curve(AVOID, AVOID, **RANDOM_STATIONS)),
    # A flight of 50 ms needs a control period as short (section 2.6).
    Scenario(id="fig-6.15", title="One swarm that always takes the same action",
             conditions=_each_alone(FOUR_ACTIONS, parameters="fitted, period=0.05")),
    # A disadvantaged S2 (chapter 7): slower, fewer, or further from a station.
    Scenario(id="fig-7.1", title="Fast avoid against avoid", conditions=_curve(FAST_AVOID, AVOID)),
    Scenario(id="fig-7.2a", title="Fast avoid against attack", conditions=_curve(FAST_AVOID, ATTACK)),
    Scenario(id="fig-7.2b", title="Fast attack against avoid", conditions=_curve(FAST_ATTACK, AVOID)),
    Scenario(id="fig-7.7a", title="Fast mixed against avoid", conditions=_curve(FAST_MIXED, AVOID)),
    Scenario(id="fig-7.7b", title="Fast mixed against attack", conditions=_curve(FAST_MIXED, ATTACK)),
    # S1 and S3 are halves of a mixed swarm: an odd half gives its extra robot to S1 (section 2.4).
    Scenario(id="fig-7.10", title="Fast avoid and fast aggressive, each half as many, against avoid",
             conditions=_curve(FAST_AVOID, _swarm("avoid", share=2), _fast("aggressive"),
                               name="avoid", multiple_of=2)),
    Scenario(id="fig-7.12", title="Avoid against avoid, seven robots to six", densities=SEVEN_TO_SIX,
             conditions=_curve(_swarm("avoid", share=7), _swarm("avoid", share=6))),
    Scenario(id="fig-7.13a", title="Attack against avoid, seven robots to six", densities=SEVEN_TO_SIX,
             conditions=_curve(_swarm("attack", share=7), _swarm("avoid", share=6))),
    Scenario(id="fig-7.15", title="Avoid, nearer a station, against avoid",
             conditions=_curve(AVOID, AVOID, **NEARER_STATION)),
    Scenario(id="fig-7.17", title="Attack, nearer a station, against avoid",
             conditions=_curve(ATTACK, AVOID, **NEARER_STATION)),
    # The controller of the ARGoS measurements (reference/README.md), to compare the physics.
    Scenario(id="argos-avoid-avoid", title="Avoid against avoid, as in ARGoS", densities=ARGOS_DENSITIES,
             conditions=_curve(AVOID, AVOID, **ARGOS)),
    Scenario(id="argos-attack-attack", title="Attack against attack, as in ARGoS", densities=ARGOS_DENSITIES,
             conditions=_curve(ATTACK, ATTACK, **ARGOS)),
    Scenario(id="argos-avoid-attack", title="Avoid against attack, as in ARGoS", densities=ARGOS_DENSITIES,
             conditions=_curve(AVOID, ATTACK, **ARGOS)),
)
# fmt: on
"""Every scenario by its id, in the order of the source."""
