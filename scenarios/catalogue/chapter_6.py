"""Symmetric swarms: the figures of chapter 6 (specification, section 3.2)."""

from typing import Any, Final

from kswarms.agents.actions import AWAY, TOWARDS, Action
from kswarms.scenarios.catalogue.builders import curve, curves, learner, reward_of, rule_of, swarm
from kswarms.scenarios.description.scenario import Scenario

AVOID, ATTACK = swarm("avoid"), swarm("attack")
INTER_LEARNER, INTRA_LEARNER, LEARNER_OF_BOTH = learner(), learner("intra-learner"), learner("learner")
INDIVIDUAL = learner(reward="individual")

UNTIL_50_PUCKS: Final[dict[str, Any]] = {"puck_limit": 50, "duration": 36_000.0}
RANDOM_STATIONS: Final[dict[str, Any]] = {"layout": "random-stations"}
SEEDS_OF_RANDOM_STATIONS: Final = 200

DELTAS: Final = (0.02, 0.08, 0.125, 0.2, 0.25)

RULES: Final = {
    "ucb": "ucb",
    "discounted-ucb": "discounted-ucb",
    "greedy": "greedy",
    "periodic-random-5": rule_of("periodic-random", every=5),
    "periodic-random-20": rule_of("periodic-random", every=20),
}

FOUR_ACTIONS: Final = (
    Action(name="flight-50ms", direction=AWAY, duration=0.05),
    Action(name="flight-500ms", direction=AWAY, duration=0.5),
    Action(name="flight-1000ms", direction=AWAY, duration=1.0),
    Action(name="fight-1000ms", direction=TOWARDS, duration=1.0),
)
# A flight of 50 ms needs a control period of at most 50 ms (section 2.6).
ALONE: Final[dict[str, Any]] = {"actions": FOUR_ACTIONS, "parameters": "fitted, period=0.05"}

# fmt: off
SYMMETRIC: Final = (
    Scenario(id="fig-6.1a", title="Avoid against avoid", conditions=curve(AVOID, AVOID)),
    Scenario(id="fig-6.1b", title="Attack against attack", conditions=curve(ATTACK, ATTACK)),
    Scenario(id="fig-6.1c", title="Avoid against attack", conditions=curve(AVOID, ATTACK)),
    Scenario(id="fig-6.2", title="Avoid against attack, until 50 pucks",
             conditions=curve(AVOID, ATTACK, **UNTIL_50_PUCKS)),
    Scenario(id="fig-6.3", title="Avoid against attack, until 50 pucks: time in conflict",
             conditions=curve(AVOID, ATTACK, **UNTIL_50_PUCKS)),
    Scenario(id="fig-6.4a", title="Avoid against inter-learner", conditions=curve(AVOID, INTER_LEARNER)),
    Scenario(id="fig-6.4b", title="Attack against inter-learner", conditions=curve(ATTACK, INTER_LEARNER)),
    Scenario(id="fig-6.5a", title="Avoid against inter-learner, until 50 pucks",
             conditions=curve(AVOID, INTER_LEARNER, **UNTIL_50_PUCKS)),
    Scenario(id="fig-6.5b", title="Attack against inter-learner, until 50 pucks",
             conditions=curve(ATTACK, INTER_LEARNER, **UNTIL_50_PUCKS)),
    Scenario(id="fig-6.6", title="Attack against intra-learner", conditions=curve(ATTACK, INTRA_LEARNER)),
    Scenario(id="fig-6.7", title="Avoid against intra-learner", conditions=curve(AVOID, INTRA_LEARNER)),
    Scenario(id="fig-6.8", title="Avoid against learner of both", conditions=curve(AVOID, LEARNER_OF_BOTH)),
    Scenario(id="fig-6.9", title="Attack against inter-learner on individual utility",
             conditions=curve(ATTACK, INDIVIDUAL)),
    Scenario(id="fig-6.10a", title="Attack against inter-learner on WLU or on individual utility",
             conditions=curves({"wlu": (ATTACK, INTER_LEARNER), "individual": (ATTACK, INDIVIDUAL)})),
    Scenario(id="fig-6.10b", title="Avoid against inter-learner on WLU or on individual utility",
             conditions=curves({"wlu": (AVOID, INTER_LEARNER), "individual": (AVOID, INDIVIDUAL)})),
    *(
        Scenario(id=f"fig-6.11{letter}", title=f"Attack against inter-learner, Δ = {delta}",
                 conditions=curve(ATTACK, learner(reward=reward_of(delta=delta))))
        for letter, delta in zip("abcd", (0.25, 0.2, 0.08, 0.02), strict=True)
    ),
    Scenario(id="fig-6.12", title="Attack against inter-learner of several Δ, and against random choice",
             conditions=curves(
                 {f"delta={delta}": (ATTACK, learner(reward=reward_of(delta=delta))) for delta in DELTAS}
                 | {"random": (ATTACK, swarm("random"))})),
    Scenario(id="fig-6.13a", title="Avoid against attack, random stations", seeds=SEEDS_OF_RANDOM_STATIONS,
             conditions=curve(AVOID, ATTACK, **RANDOM_STATIONS)),
    Scenario(id="fig-6.13b", title="Avoid against avoid, random stations", seeds=SEEDS_OF_RANDOM_STATIONS,
             conditions=curve(AVOID, AVOID, **RANDOM_STATIONS)),
    Scenario(id="fig-6.13c", title="Attack against inter-learner, random stations",
             seeds=SEEDS_OF_RANDOM_STATIONS, conditions=curve(ATTACK, INTER_LEARNER, **RANDOM_STATIONS)),
    Scenario(id="fig-6.13d", title="Avoid against inter-learner, random stations",
             seeds=SEEDS_OF_RANDOM_STATIONS, conditions=curve(AVOID, INTER_LEARNER, **RANDOM_STATIONS)),
    Scenario(id="fig-6.14", title="Attack against inter-learner with several selection rules",
             conditions=curves({name: (ATTACK, learner(rule=rule)) for name, rule in RULES.items()})),
    Scenario(id="fig-6.15", title="One swarm that always takes the same action, or learns which",
             conditions=curves(
                 {action.name: (swarm(action.name),) for action in FOUR_ACTIONS}
                 | {"learner": (learner("intra-learner", reward="single-swarm"),)}, **ALONE)),
)
# fmt: on
"""Scenarios of chapter 6, in the order of the source."""
