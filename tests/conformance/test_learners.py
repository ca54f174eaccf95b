"""What every policy must do: a new one in `POLICIES` is checked by all of this without another line.

Policies that learn are checked with every reward and every rule too. Each check is a function of what
builds a policy, and has a policy that it must turn down.
"""

import copy
import math
import pickle
import random
from collections.abc import Callable
from itertools import product
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest

from agents.actions import AWAY, TOWARDS, Action
from agents.learned import save
from agents.learner import Learner
from agents.policies import POLICIES, Policy, Setting, make_policy
from agents.rewards import REWARDS
from agents.selection import RULES
from agents.streams import Purpose, Streams, stream

TWO = (
    Action(name="flight", direction=AWAY, duration=1.8),
    Action(name="fight", direction=TOWARDS, duration=1.0),
)
FOUR = (
    *TWO,
    Action(name="dash", direction=AWAY, duration=0.1),
    Action(name="ram", direction=TOWARDS, duration=3.0),
)
GAMES = [(swarm, swarms, actions) for swarms in (2, 3) for swarm in range(swarms) for actions in (TWO, FOUR)]
Build = Callable[[Setting], Policy]

ARGUMENTS = {"learned": "(file={file!r})"}
"""What a policy cannot be built without."""
TEXTS = [
    *(name + ARGUMENTS.get(name, "") for name in POLICIES),
    *(f"learner(reward='{reward}', rule='{rule}')" for reward, rule in product(REWARDS, RULES)),
    *TWO[0].name.split(),
]


def setting(
    swarm: int = 1, swarms: int = 2, actions: tuple[Action, ...] = TWO, seed: int = 0, robot: int = 3
) -> Setting:
    return Setting(swarm, swarms, actions, Streams(seed, robot))


def live(policy: Policy, swarms: int, conflicts: int = 80) -> list[tuple[Any, ...]]:
    """Have conflicts, the same whatever the policy does; return what it chose and what it learned."""
    world, story = np.random.default_rng(7), []
    learn = getattr(policy, "learn", None)
    for _ in range(conflicts):
        opponent, t_a, t_p = int(world.integers(swarms)), world.uniform(1, 3), world.uniform(0, 20)
        story.append((opponent, policy.choose(opponent).name))
        if learn:
            story.append(learn(t_a, t_p, int(world.integers(9))))
    return story


def check_every_choice_is_one_of_the_games_actions(build: Build) -> None:
    for swarm, swarms, actions in GAMES:
        policy = build(setting(swarm, swarms, actions))
        for opponent in range(swarms):
            for _ in range(20):
                assert policy.choose(opponent) in actions


def check_same_seed_same_choices(build: Build) -> None:
    for swarm, swarms, actions in GAMES:
        one, other = (build(setting(swarm, swarms, actions)) for _ in range(2))
        random.random()
        assert repr(live(one, swarms)) == repr(live(other, swarms))


def check_robots_share_no_state(build: Build) -> None:
    alone = live(build(setting(robot=4)), 2)
    neighbour, one = build(setting(robot=5)), build(setting(robot=4))
    live(neighbour, 2)
    assert repr(live(one, 2)) == repr(alone)


def check_copies_go_on_alike(build: Build) -> None:
    policy = build(setting())
    live(policy, 2, conflicts=17)
    twins = [copy.deepcopy(policy), pickle.loads(pickle.dumps(policy)), policy]
    stories = [repr(live(twin, 2)) for twin in twins]
    assert stories[0] == stories[1] == stories[2]
    assert repr(twins[0]) == repr(twins[1]) == repr(policy)


def check_repr_tells_the_swarm_and_no_address(build: Build) -> None:
    text = repr(build(setting(swarm=1)))
    assert "swarm=1" in text
    assert " at 0x" not in text
    assert len(text.splitlines()) == 1


def check_it_draws_from_the_streams_of_policies_alone(build: Build) -> None:
    where = setting(seed=6)
    policy = build(where)
    live(policy, 2)
    for purpose in set(Purpose) - {Purpose.EXPLORE, Purpose.POLICY}:
        assert where.streams.draws(purpose).random() == stream(6, 3, purpose).random()


def check_a_learner_can_be_told_and_stopped(build: Build) -> None:
    """Tell what learns (T(a), T(p), n'), until `freeze` makes it deaf."""
    for swarm, swarms, actions in GAMES:
        policy = build(setting(swarm, swarms, actions))
        if not hasattr(policy, "learn"):
            continue
        assert isinstance(policy, Learner)
        told = [entry for entry in live(policy, swarms) if isinstance(entry[1], float)]
        assert told
        assert all(type(number) is float for entry in told for number in entry)
        known = repr(policy.snapshot())
        policy.freeze()
        story = live(policy, swarms, conflicts=40)
        assert repr(policy.snapshot()) == known
        assert all(math.isnan(number) for entry in story for number in entry if isinstance(number, float))
        chosen = {entry[0]: set() for entry in story if isinstance(entry[0], int)}
        for entry in story:
            if isinstance(entry[0], int):
                chosen[entry[0]].add(entry[1])
        assert {len(actions) for actions in chosen.values()} == {1}


class Outsider:
    """Does what the game does not know."""

    def __init__(self, where: Setting) -> None:
        self.swarm = where.swarm

    def choose(self, opponent: int) -> Action:
        return Action(name="hide", direction=AWAY, duration=1.0)


class Unseeded(Outsider):
    """Draws from a stream that is not the robot's."""

    def __init__(self, where: Setting) -> None:
        super().__init__(where)
        self.actions = where.actions

    def choose(self, opponent: int) -> Action:
        return random.choice(self.actions)


class Hive(Unseeded):
    """Learns from the conflicts of others."""

    met: Final[list[int]] = []

    def choose(self, opponent: int) -> Action:
        self.met.append(opponent)
        return self.actions[len(self.met) > 100]


class Unpicklable(Unseeded):
    """Does not go on as it was."""

    def choose(self, opponent: int) -> Action:
        self.met = getattr(self, "met", 0) + 1
        return self.actions[self.met % 20 < 5]

    def __getstate__(self) -> dict[str, Any]:
        return {"actions": self.actions, "swarm": self.swarm}


class Greedy(Unseeded):
    """Draws from the stream of another purpose."""

    def __init__(self, where: Setting) -> None:
        super().__init__(where)
        self.streams = where.streams

    def choose(self, opponent: int) -> Action:
        return self.actions[self.streams.draws(Purpose.LEG).random() < 0.5]


class Unstoppable(Learner):
    """Goes on exploring and learning."""

    def freeze(self) -> None:
        pass


Check = Callable[[Build], None]
CHECKS: Final[dict[Check, Build]] = {
    check_every_choice_is_one_of_the_games_actions: Outsider,
    check_same_seed_same_choices: Unseeded,
    check_robots_share_no_state: Hive,
    check_copies_go_on_alike: Unpicklable,
    check_repr_tells_the_swarm_and_no_address: Outsider,
    check_it_draws_from_the_streams_of_policies_alone: Greedy,
    check_a_learner_can_be_told_and_stopped: Unstoppable,
}
"""Every check, with a policy that must not pass it."""


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[int, str]:
    """Return files of learned policies, for each swarm that a robot may be of."""
    folder, paths = tmp_path_factory.mktemp("learned"), {}
    for swarm in range(3):
        learner = Learner(setting(swarm))
        live(learner, 2)
        paths[swarm] = str(Path(folder, f"swarm-{swarm + 1}.json"))
        save(Path(paths[swarm]), swarm + 1, [learner.snapshot()])
    return paths


@pytest.mark.parametrize("text", TEXTS)
@pytest.mark.parametrize("check", CHECKS)
def test_every_policy_passes_every_check(text: str, check: Check, files: dict[int, str]) -> None:
    def build(where: Setting) -> Policy:
        return make_policy(text.replace("{file!r}", repr(files[where.swarm])), where)

    check(build)


@pytest.mark.parametrize("check", CHECKS)
def test_every_check_turns_a_bad_policy_down(check: Check) -> None:
    with pytest.raises(AssertionError):
        check(CHECKS[check])


def test_names_are_as_users_write_them() -> None:
    for name in POLICIES:
        assert name == name.lower().strip()
        assert not set(name) & set("()+,'\" ")
