"""The catalogue against an independent reading of the specification's tables."""

import inspect
from collections.abc import Sequence
from typing import NamedTuple

import pytest

from kswarms.agents.learning.rewards import WLU, IndividualUtility, Reward, SingleSwarmWLU
from kswarms.agents.learning.selection_rules import GAMMA, UCB, DiscountedUCB, Greedy, PeriodicRandom, Rule
from kswarms.agents.policies.interface import Setting
from kswarms.agents.policies.learner import Learner
from kswarms.agents.policies.spec import make_policy
from kswarms.agents.streams import Streams
from kswarms.model.description.presets import text_of
from kswarms.scenarios.catalogue import CATALOGUE, TABLES
from kswarms.scenarios.catalogue.builders import learner, reward_of, rule_of
from kswarms.scenarios.description.scenario import Scenario

TEN = (6, 10, 16, 20, 26, 30, 36, 40, 46, 50)
SEVEN_TO_SIX = (13, 26, 39, 52)
ACTIONS = {
    "flight-50ms": (-1, 0.05),
    "flight-500ms": (-1, 0.5),
    "flight-1000ms": (-1, 1.0),
    "fight-1000ms": (1, 1.0),
}

DELTAS = (0.02, 0.1, 0.125, 0.145)
RULES = ("ucb", "discounted-ucb", "greedy", "periodic-random-5", "periodic-random-20")


def by_delta(policies: str, *deltas: float) -> dict[str, str]:
    return {f"delta={delta}": policies for delta in deltas}


# Policies of each curve of each scenario: ">" is a fast swarm, "?" a learner (see LEARNED).
CURVES: dict[str, dict[str, str]] = {
    "fig-6.1a": {"": "avoid avoid"},
    "fig-6.1b": {"": "attack attack"},
    **{name: {"": "avoid attack"} for name in ("fig-6.1c", "fig-6.2", "fig-6.3")},
    "fig-6.4a": {"": "avoid ?"},
    "fig-6.4b": {"": "attack ?"},
    "fig-6.5a": {"": "avoid ?"},
    "fig-6.5b": {"": "attack ?"},
    "fig-6.6": {"": "attack ?"},
    "fig-6.7": {"": "avoid ?"},
    "fig-6.8": {"": "avoid ?"},
    "fig-6.9": {"": "attack ?"},
    "fig-6.10a": {"wlu": "attack ?", "individual": "attack ?"},
    "fig-6.10b": {"wlu": "avoid ?", "individual": "avoid ?"},
    **{f"fig-6.11{letter}": {"": "attack ?"} for letter in "abcd"},
    "fig-6.12": by_delta("attack ?", 0.02, 0.08, 0.125, 0.2, 0.25) | {"random": "attack random"},
    "fig-6.13a": {"": "avoid attack"},
    "fig-6.13b": {"": "avoid avoid"},
    "fig-6.13c": {"": "attack ?"},
    "fig-6.13d": {"": "avoid ?"},
    "fig-6.14": dict.fromkeys(RULES, "attack ?"),
    "fig-6.15": {name: name for name in ACTIONS} | {"learner": "?"},
    "fig-7.1": {"": ">avoid avoid"},
    "fig-7.2a": {"": ">avoid attack"},
    "fig-7.2b": {"": ">attack avoid"},
    "fig-7.3": {"": ">attack ?"},
    "fig-7.4": by_delta(">attack ?", 0.1, 0.125, 0.145) | {"avoid": ">attack avoid"},
    "fig-7.5": {"": ">avoid ?"},
    "fig-7.6": by_delta(">avoid ?", *DELTAS) | {"avoid": ">avoid avoid", "attack": ">avoid attack"},
    "fig-7.7a": {"": ">mixed avoid"},
    "fig-7.7b": {"": ">mixed attack"},
    "fig-7.8": by_delta(">mixed ?", *DELTAS) | {"avoid": ">mixed avoid"},
    "fig-7.10": by_delta(">avoid ? >aggressive", *DELTAS) | {"avoid": ">avoid avoid >aggressive"},
    "fig-7.11": by_delta(">avoid ? >aggressive", *DELTAS) | {"avoid": ">avoid avoid >aggressive"},
    "fig-7.12": {"": "avoid avoid"},
    "fig-7.13a": {"": "attack avoid"},
    "fig-7.13b": {"": "attack ?"},
    "fig-7.15": {"": "avoid avoid"},
    "fig-7.16a": {"": "avoid ?"},
    "fig-7.16b": {"": "avoid ?"},
    "fig-7.17": {"": "attack avoid"},
    "fig-7.18a": {"": "attack ?"},
    "fig-7.18b": {"": "attack ?"},
    "fig-7.19": {"b=1": "attack ?", "b=7/6": "attack ?", "avoid": "attack avoid"},
    "argos-avoid-avoid": {"": "avoid avoid"},
    "argos-attack-attack": {"": "attack attack"},
    "argos-avoid-attack": {"": "avoid attack"},
}


class Learned(NamedTuple):
    """Opponents (swarms from 1), reward and rule of a learner."""

    about: Sequence[int] = (1,)
    reward: Reward = WLU()
    rule: Rule = UCB()


def stronger(delta: float | dict[int, float] = 0.125) -> WLU:
    return WLU(delta=delta, b=7 / 6)


# Learners that differ from one about the other swarm by WLU with Δ = 0.125, b = 1 and UCB.
LEARNED = {
    ("fig-6.6", ""): Learned(about=[2]),
    ("fig-6.7", ""): Learned(about=[2]),
    ("fig-6.8", ""): Learned(about=[1, 2]),
    ("fig-6.9", ""): Learned(reward=IndividualUtility()),
    **{(f"fig-6.10{letter}", "individual"): Learned(reward=IndividualUtility()) for letter in "ab"},
    ("fig-6.11a", ""): Learned(reward=WLU(delta=0.25)),
    ("fig-6.11b", ""): Learned(reward=WLU(delta=0.2)),
    ("fig-6.11c", ""): Learned(reward=WLU(delta=0.08)),
    ("fig-6.11d", ""): Learned(reward=WLU(delta=0.02)),
    **{
        ("fig-6.12", f"delta={delta}"): Learned(reward=WLU(delta=delta))
        for delta in (0.02, 0.08, 0.125, 0.2, 0.25)
    },
    ("fig-6.14", "discounted-ucb"): Learned(rule=DiscountedUCB(discount=0.99)),
    ("fig-6.14", "greedy"): Learned(rule=Greedy()),
    ("fig-6.14", "periodic-random-5"): Learned(rule=PeriodicRandom(every=5)),
    ("fig-6.14", "periodic-random-20"): Learned(rule=PeriodicRandom(every=20)),
    ("fig-6.15", "learner"): Learned(reward=SingleSwarmWLU(kappa=3)),
    ("fig-7.3", ""): Learned(reward=stronger(0.145)),
    ("fig-7.5", ""): Learned(reward=stronger(0.145)),
    **{
        (name, f"delta={delta}"): Learned(reward=stronger(delta))
        for name in ("fig-7.4", "fig-7.6", "fig-7.8")
        for delta in DELTAS
    },
    **{("fig-7.10", f"delta={delta}"): Learned([1, 3], stronger(delta)) for delta in DELTAS},
    **{("fig-7.11", f"delta={delta}"): Learned([1, 3], stronger({1: delta, 3: 0.125})) for delta in DELTAS},
    **{(name, ""): Learned(reward=stronger()) for name in ("fig-7.13b", "fig-7.16b", "fig-7.18b")},
    ("fig-7.19", "b=7/6"): Learned(reward=stronger()),
}
LEARNERS = [
    (name, condition, policies.split().index("?"))
    for name, read in CURVES.items()
    for condition, policies in read.items()
    if "?" in policies
]


def test_the_catalogue_has_exactly_the_figures_of_both_chapters() -> None:
    assert list(CATALOGUE) == list(CURVES)
    assert len([name for name in CATALOGUE if name.startswith("fig-")]) == 48
    assert all(name == scenario.id for name, scenario in CATALOGUE.items())


def test_titles_are_unique() -> None:
    titles = {entry.title for entry in (*CATALOGUE.values(), *TABLES.values())}
    assert len(titles) == len(CATALOGUE) + len(TABLES)


def test_a_table_selects_its_figures() -> None:
    assert {name: table.scenarios for name, table in TABLES.items()} == {
        "table-6.1": ("fig-6.4a", "fig-6.4b"),
        "table-6.2": ("fig-6.8",),
        "table-6.3": ("fig-6.12",),
        "table-7.1": ("fig-7.4",),
        "table-7.2": ("fig-7.16a", "fig-7.16b"),
    }
    assert set(CATALOGUE).isdisjoint(TABLES)
    assert all(name in CATALOGUE for table in TABLES.values() for name in table.scenarios)


@pytest.mark.parametrize("name", CURVES)
def test_swarms_have_the_policies_and_drives_of_the_source(name: str) -> None:
    read = {
        condition.name: " ".join(
            ">" * (rule.drive == 0.7) + ("?" if "learner" in rule.policy else rule.policy)
            for rule in condition.swarms
        )
        for condition in CATALOGUE[name].conditions
    }
    assert read == CURVES[name]
    assert list(read) == list(CURVES[name])
    for condition in CATALOGUE[name].conditions:
        assert {(rule.drive, rule.drive_action) for rule in condition.swarms} <= {(0.7, 0.6), (0.6, 0.6)}


@pytest.mark.parametrize(("name", "condition", "swarm"), LEARNERS)
def test_learners_have_the_opponents_reward_and_rule_of_the_source(
    name: str, condition: str, swarm: int
) -> None:
    game = CATALOGUE[name].game(condition, 26)
    setting = Setting(swarm, len(game.swarms), game.action_set, Streams(0, 0))
    built = make_policy(game.swarms[swarm].policy, setting)
    expected = LEARNED.get((name, condition), Learned())
    assert isinstance(built, Learner)
    assert [opponent + 1 for opponent in built.bandits] == list(expected.about)
    assert built.rule == expected.rule.in_game(GAMMA)
    assert type(built.reward) is type(expected.reward)
    for opponent in expected.about:
        for t_a, t_p in ((1.0, 0.0), (0.0, 1.0)):
            conflict = (t_a, t_p, 8, 1, opponent != swarm + 1, opponent)
            assert built.reward.of(*conflict) == pytest.approx(expected.reward.of(*conflict))
    others = {built.choose(other).name for other in range(len(game.swarms)) if other not in built.bandits}
    assert others <= {"flight"}


def test_expected_learners_belong_to_existing_curves() -> None:
    missing = LEARNED.keys() - {(name, condition) for name, condition, _ in LEARNERS}
    assert missing == {("fig-7.4", "delta=0.02")}


@pytest.mark.parametrize("scenario", CATALOGUE.values(), ids=CATALOGUE)
def test_the_protocol_is_that_of_the_source(scenario: Scenario) -> None:
    is_argos, few = scenario.id.startswith("argos"), scenario.id in {"fig-7.12", "fig-7.13a", "fig-7.13b"}
    assert scenario.densities == ((6, 16, 26, 36, 46) if is_argos else SEVEN_TO_SIX if few else TEN)
    assert scenario.seeds == (200 if scenario.id.startswith("fig-6.13") else 20)
    for condition in scenario.conditions:
        limited = scenario.id in {"fig-6.2", "fig-6.3", "fig-6.5a", "fig-6.5b"}
        assert (condition.puck_limit, condition.duration) == ((50, 36_000) if limited else (None, 600))
        assert condition.learning == (3000 if "?" in CURVES[scenario.id][condition.name] else 0)
        assert condition.supply is None
        nearer = ("fig-7.15", "fig-7.16a", "fig-7.16b", "fig-7.17", "fig-7.18a", "fig-7.18b", "fig-7.19")
        layouts = dict.fromkeys(nearer, "nearer-station")
        layouts |= {f"fig-6.13{letter}": "random-stations" for letter in "abcd"}
        assert condition.layout == layouts.get(scenario.id, "symmetric")
        assert condition.body.name == ("argos-footbot" if is_argos else "krembot-sim")
        fitted = "fitted, period=0.05" if scenario.id == "fig-6.15" else "fitted"
        assert text_of(condition.parameters) == ("argos" if is_argos else fitted)
        shares = tuple(rule.share for rule in condition.swarms)
        several = {"fig-7.10": (1, 2, 1), "fig-7.11": (1, 2, 1), "fig-6.15": (1,)}
        assert shares == ((7, 6) if few else several.get(scenario.id, (1, 1)))


@pytest.mark.parametrize("name", ["fig-7.10", "fig-7.11"])
def test_the_halves_of_a_mixed_swarm_allow_every_even_number(name: str) -> None:
    for condition in CATALOGUE[name].conditions:
        for n in range(4, 60, 2):
            first, second, third = (swarm.size for swarm in condition.game(n).swarms)
            assert (second, first + third) == (n // 2, n // 2)
            assert first - third in {0, 1}


def test_the_single_swarm_has_a_curve_for_each_action_and_one_for_a_learner() -> None:
    curves = CATALOGUE["fig-6.15"].conditions
    for curve in curves:
        assert {action.name: (action.direction, action.duration) for action in curve.actions} == ACTIONS
        assert curve.game(6).parameters.period == 0.05
    assert [rule.policy for curve in curves[:-1] for rule in curve.swarms] == list(ACTIONS)


def test_explicit_defaults_are_left_out_of_the_text() -> None:
    plain = learner(reward=reward_of("wlu", delta=0.125, b=1.0), rule=rule_of("ucb", gamma=None))
    assert plain.policy == "inter-learner"
    assert reward_of(delta={1: 0.125, 3: 0.125}) == "wlu"
    assert reward_of(delta={1: 0.02, 3: 0.125}, b=7 / 6) == "wlu(delta={1: 0.02}, b=1.1666666666666667)"
    with_arguments = learner(
        "learner", reward=reward_of("individual", half=True), rule=rule_of("greedy"), share=3
    )
    assert with_arguments.policy == "learner(reward='individual(half=True)', rule='greedy')"
    assert with_arguments.share == 3
    defaults = inspect.signature(Learner).parameters
    assert (defaults["reward"].default, defaults["rule"].default) == ("wlu", "ucb")


def test_unknown_arguments_of_a_learner_are_refused() -> None:
    with pytest.raises(KeyError):
        reward_of("wlu", detla=0.1)
    with pytest.raises(KeyError):
        rule_of("usb")
