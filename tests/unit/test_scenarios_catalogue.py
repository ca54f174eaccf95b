"""The catalogue against an independent reading of the specification's tables."""

import pytest

from scenarios.catalogue import CATALOGUE
from scenarios.description import Scenario

TEN = (6, 10, 16, 20, 26, 30, 36, 40, 46, 50)
SEVEN_TO_SIX = (13, 26, 39, 52)

# id: policies in order, ">" marking a fast swarm; every other field below is the rule's or listed there.
POLICIES = {
    "fig-6.1a": "avoid avoid",
    "fig-6.1b": "attack attack",
    "fig-6.1c": "avoid attack",
    "fig-6.2": "avoid attack",
    "fig-6.3": "avoid attack",
    "fig-6.13a": "avoid attack",
    "fig-6.13b": "avoid avoid",
    "fig-7.1": ">avoid avoid",
    "fig-7.2a": ">avoid attack",
    "fig-7.2b": ">attack avoid",
    "fig-7.7a": ">mixed avoid",
    "fig-7.7b": ">mixed attack",
    "fig-7.10": ">avoid avoid >aggressive",
    "fig-7.12": "avoid avoid",
    "fig-7.13a": "attack avoid",
    "fig-7.15": "avoid avoid",
    "fig-7.17": "attack avoid",
    "argos-avoid-avoid": "avoid avoid",
    "argos-attack-attack": "attack attack",
    "argos-avoid-attack": "avoid attack",
}
OF_ONE_CURVE = [(CATALOGUE[name], policies) for name, policies in POLICIES.items() if name in CATALOGUE]


def test_every_scenario_with_fixed_policies_is_there_and_no_other() -> None:
    assert set(CATALOGUE) == POLICIES.keys() | {"fig-6.15"}
    assert all(name == scenario.id for name, scenario in CATALOGUE.items())


def test_titles_tell_scenarios_apart() -> None:
    assert len({scenario.title for scenario in CATALOGUE.values()}) == len(CATALOGUE)


@pytest.mark.parametrize(("scenario", "policies"), OF_ONE_CURVE, ids=POLICIES)
def test_swarms_have_the_policies_and_drives_of_the_source(scenario: Scenario, policies: str) -> None:
    (condition,) = scenario.conditions
    assert condition.name == ("avoid" if scenario.id == "fig-7.10" else "")
    read = [">" * (rule.drive == 0.7) + rule.policy for rule in condition.swarms]
    assert " ".join(read) == policies
    assert {(rule.drive, rule.drive_action) for rule in condition.swarms} <= {(0.7, 0.6), (0.6, 0.6)}


@pytest.mark.parametrize("scenario", CATALOGUE.values(), ids=CATALOGUE)
def test_the_protocol_is_that_of_the_source(scenario: Scenario) -> None:
    is_argos, few = scenario.id.startswith("argos"), scenario.id in {"fig-7.12", "fig-7.13a"}
    assert scenario.densities == ((6, 16, 26, 36, 46) if is_argos else SEVEN_TO_SIX if few else TEN)
    assert scenario.seeds == (200 if scenario.id.startswith("fig-6.13") else 20)
    for condition in scenario.conditions:
        limited = scenario.id in {"fig-6.2", "fig-6.3"}
        assert (condition.puck_limit, condition.duration) == ((50, 36_000) if limited else (None, 600))
        assert condition.supply is None
        layouts = dict.fromkeys(("fig-7.15", "fig-7.17"), "nearer-station")
        layouts |= dict.fromkeys(("fig-6.13a", "fig-6.13b"), "random-stations")
        assert condition.layout == layouts.get(scenario.id, "symmetric")
        assert condition.body == ("argos-footbot" if is_argos else "krembot-sim")
        fitted = "fitted, period=0.05" if scenario.id == "fig-6.15" else "fitted"
        assert condition.parameters == ("argos" if is_argos else fitted)
        shares = tuple(rule.share for rule in condition.swarms)
        several = {"fig-7.10": (1, 2, 1), "fig-6.15": (1,)}
        assert shares == ((7, 6) if few else several.get(scenario.id, (1, 1)))


def test_the_halves_of_a_mixed_swarm_take_every_even_number() -> None:
    scenario = CATALOGUE["fig-7.10"]
    for n in range(4, 60, 2):
        first, second, third = (swarm.size for swarm in scenario.game("avoid", n).swarms)
        assert (second, first + third) == (n // 2, n // 2)
        assert first - third in {0, 1}


def test_the_single_swarm_has_four_curves_of_one_action_each() -> None:
    curves = CATALOGUE["fig-6.15"].conditions
    actions = {action.name: (action.direction, action.duration) for action in curves[0].actions}
    assert actions == {
        "flight-50ms": (-1, 0.05),
        "flight-500ms": (-1, 0.5),
        "flight-1000ms": (-1, 1.0),
        "fight-1000ms": (1, 1.0),
    }
    assert [curve.name for curve in curves] == list(actions)
    for curve in curves:
        assert [rule.policy for rule in curve.swarms] == [curve.name]
        assert curve.actions == curves[0].actions
        assert curve.game(6).parameters.period == 0.05
