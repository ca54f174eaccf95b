"""Fixed policies and their choices (section 2.4)."""

from typing import Final

import pytest

from kswarms.agents.actions import AWAY, TOWARDS, Action
from kswarms.agents.common.errors import InputError
from kswarms.agents.policies.interface import Policy, Setting
from kswarms.agents.policies.registry import POLICIES
from kswarms.agents.policies.spec import deal, make_policy
from kswarms.agents.streams import Streams
from kswarms.model.description.game import Game, Swarm

FLIGHT: Final = Action(name="flight", direction=AWAY, duration=1.8)
FIGHT: Final = Action(name="fight", direction=TOWARDS, duration=1.0)
DASH: Final = Action(name="dash", direction=AWAY, duration=0.05)
STANDARD: Final = (FLIGHT, FIGHT)
OPEN: Final = (DASH, FLIGHT, FIGHT)
"""More actions; the first of a direction is not the standard one."""

CHOICES: Final = {
    # name: (within the own swarm, against others) with the standard actions, and with `OPEN`
    "avoid": ((FLIGHT, FLIGHT), (DASH, DASH)),
    "attack": ((FLIGHT, FIGHT), (DASH, FIGHT)),
    "aggressive": ((FIGHT, FIGHT), (FIGHT, FIGHT)),
    "flight": ((FLIGHT, FLIGHT), (FLIGHT, FLIGHT)),
    "fight": ((FIGHT, FIGHT), (FIGHT, FIGHT)),
}

SWARMS: Final = range(4)

every_policy = pytest.mark.parametrize("name", CHOICES)
every_swarm = pytest.mark.parametrize("swarm", SWARMS)
every_set = pytest.mark.parametrize("actions", [STANDARD, OPEN], ids=["standard", "open"])


def made(name: str, swarm: int, actions: tuple[Action, ...]) -> Policy:
    return make_policy(name, Setting(swarm, len(SWARMS), actions, Streams(0, 0)))


def choices(policy: Policy) -> list[Action]:
    return [policy.choose(opponent) for opponent in SWARMS]


def test_the_error_for_unknown_names_lists_all_policies() -> None:
    with pytest.raises(InputError, match=r"must be one of (.+), or several") as refusal:
        made("nonsense", 0, STANDARD)
    named = refusal.value.allowed.removeprefix("must be one of ").partition(", or several")[0].split(", ")
    assert set(named) == {*CHOICES, *POLICIES, "mixed"}


@every_set
@every_swarm
@every_policy
def test_choices_against_own_and_other_swarms(name: str, swarm: int, actions: tuple[Action, ...]) -> None:
    within, against = CHOICES[name][actions is OPEN]
    policy = made(name, swarm, actions)
    assert choices(policy) == [within if opponent == swarm else against for opponent in SWARMS]


@every_policy
def test_repr_shows_the_actions(name: str) -> None:
    (within, against), _ = CHOICES[name]
    text = repr(made(name, 2, STANDARD))
    kind = "FixedPolicy" if name in ("flight", "fight") else name.capitalize()
    assert text == f"{kind}(swarm=2, within={within.name!r}, against={against.name!r})"


@every_policy
def test_a_policy_is_dealt_to_all_robots_or_some(name: str) -> None:
    for policy, dealt in ((name, [name] * 3), (f"{name}+avoid", [name, name, "avoid"])):
        assert list(map(str, deal(policy, 3))) == dealt
        assert Swarm(policy=policy, size=3).policy == policy


def test_the_name_of_an_action_is_a_policy() -> None:
    assert choices(made("dash", 1, OPEN)) == [DASH] * 4
    with pytest.raises(InputError, match="policy='dash'"):
        made("dash", 1, STANDARD)


@pytest.mark.parametrize(
    ("name", "actions"),
    [("attack", (FLIGHT,)), ("attack", (FIGHT,)), ("avoid", (FIGHT,)), ("aggressive", (FLIGHT, DASH))],
)
def test_a_policy_requires_actions_of_its_directions(name: str, actions: tuple[Action, ...]) -> None:
    with pytest.raises(InputError, match=r"actions=\[.*\]: must have one of direction") as refusal:
        made(name, 0, actions)
    assert all(action.name in str(refusal.value) for action in actions)


@pytest.mark.parametrize(
    ("policy", "size", "dealt"),
    [
        ("avoid", 0, ""),
        ("mixed", 1, "avoid"),
        ("mixed", 5, "avoid avoid avoid aggressive aggressive"),
        (" mixed", 2, "avoid aggressive"),
        ("attack+mixed", 5, "attack attack avoid avoid aggressive"),
        ("mixed + avoid", 3, "avoid aggressive avoid"),
        ("attack+avoid+fight", 5, "attack attack avoid avoid fight"),
        ("fight+flight", 4, "fight fight flight flight"),
    ],
)
def test_policies_are_dealt_in_equal_shares(policy: str, size: int, dealt: str) -> None:
    assert list(map(str, deal(policy, size))) == dealt.split()
    Game(swarms=(Swarm(policy=policy, size=max(1, size)),))


@pytest.mark.parametrize("policy", ["Avoid", "avoid,attack", "avoid+", "avoid+peace", "leaner"])
def test_unknown_policies_are_refused(policy: str) -> None:
    with pytest.raises(InputError, match=r"policy='[^']*': must be one of avoid, attack, aggressive, random"):
        Game(swarms=(Swarm(policy=policy, size=2),))


@pytest.mark.parametrize("policy", ["mixed()", "avoid+mixed(of=2)"])
def test_an_alias_takes_no_arguments(policy: str) -> None:
    with pytest.raises(InputError, match=r"^policy='mixed\(.*\)': stands for avoid\+aggressive, and"):
        Game(swarms=(Swarm(policy=policy, size=2),))
