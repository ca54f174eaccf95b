"""What every policy must do."""

import copy
import pickle
import random
from collections.abc import Callable
from typing import Any, Final, cast

import numpy as np

from kswarms.agents.actions import AWAY, TOWARDS, Action
from kswarms.agents.policies.interface import LearningPolicy, Policy, Setting
from kswarms.agents.streams import Purpose, Streams, stream

TWO: Final = (
    Action(name="flight", direction=AWAY, duration=1.8),
    Action(name="fight", direction=TOWARDS, duration=1.0),
)
FOUR: Final = (
    *TWO,
    Action(name="dash", direction=AWAY, duration=0.1),
    Action(name="ram", direction=TOWARDS, duration=3.0),
)
GAMES: Final = [
    (swarm, swarms, actions) for swarms in (2, 3) for swarm in range(swarms) for actions in (TWO, FOUR)
]
"""Own swarm, number of swarms, actions."""
Build = Callable[[Setting], Policy]
"""A policy's class, or what calls it with arguments: ``functools.partial(MyPolicy, patience=2)``."""


def setting(
    swarm: int = 1, swarms: int = 2, actions: tuple[Action, ...] = TWO, seed: int = 0, robot: int = 3
) -> Setting:
    """Return where a robot plays."""
    return Setting(swarm, swarms, actions, Streams(seed, robot))


def live(policy: Policy, swarms: int, conflicts: int = 80, learning: bool = True) -> list[tuple[Any, ...]]:
    """Have conflicts, the same whatever the policy does; return what it chose and what it learned."""
    world, story = np.random.default_rng(7), []
    learn = getattr(policy, "learn", None) if learning else None
    for _ in range(conflicts):
        opponent, t_a, t_p = int(world.integers(swarms)), world.uniform(1, 3), world.uniform(0, 20)
        n_active = int(world.integers(9))
        story.append((opponent, policy.choose(opponent).name))
        if learn is not None:
            story.append(learn(t_a, t_p, n_active))
    return story


def check_every_choice_is_one_of_the_games_actions(build: Build) -> None:
    """Check it in games of two and three swarms, and of two and four actions."""
    for swarm, swarms, actions in GAMES:
        policy = build(setting(swarm, swarms, actions))
        for opponent in range(swarms):
            for _ in range(20):
                action = policy.choose(opponent)
                assert action in actions, f"choose({opponent}) is {action!r}, no action of the game"


def check_same_seed_same_choices(build: Build) -> None:
    """Check that nothing is drawn but from the robot's own streams."""
    for swarm, swarms, actions in GAMES:
        one, other = (build(setting(swarm, swarms, actions)) for _ in range(2))
        random.random()
        assert repr(live(one, swarms)) == repr(live(other, swarms)), "the same seed gave other choices"


def check_robots_share_no_state(build: Build) -> None:
    """Check that what another robot meets makes no difference."""
    alone = live(build(setting(robot=4)), 2)
    neighbour, one = build(setting(robot=5)), build(setting(robot=4))
    live(neighbour, 2)
    assert repr(live(one, 2)) == repr(alone), "another robot's conflicts made a difference"


def check_copies_go_on_alike(build: Build) -> None:
    """Check that copies, pickled ones too, go on as the policy does."""
    policy = build(setting())
    live(policy, 2, conflicts=17)
    twins = {"a deep copy": copy.deepcopy(policy), "a pickled one": pickle.loads(pickle.dumps(policy))}
    story = repr(live(policy, 2))
    for what, twin in twins.items():
        assert repr(live(twin, 2)) == story, f"{what} goes on in another way"


def check_it_draws_from_the_streams_of_policies_alone(build: Build) -> None:
    """Check that the draws of the robot's other decisions are left alone."""
    where = setting(seed=6)
    live(build(where), 2)
    for purpose in set(Purpose) - {Purpose.EXPLORE, Purpose.POLICY}:
        untouched = stream(6, 3, purpose).random()
        assert where.streams.draws(purpose).random() == untouched, f"it draws from {purpose.name}"


def check_a_learner_can_be_told_and_stopped(build: Build) -> None:
    """Check that what is told is answered by two floats, and that `freeze` ends exploring and learning."""
    for swarm, swarms, actions in GAMES:
        policy = build(setting(swarm, swarms, actions))
        if not hasattr(policy, "learn"):
            continue
        for told in live(policy, swarms)[1::2]:
            assert [isinstance(number, float) for number in told] == [True, True], f"learn(…) is {told!r}"
        learner, snapshot = cast(LearningPolicy, policy), getattr(policy, "snapshot", list)
        learner.freeze()
        known = repr(snapshot())
        chosen: dict[int, set[str]] = {}
        for opponent, action in live(policy, swarms, learning=False):
            chosen.setdefault(opponent, set()).add(action)
        assert all(len(names) == 1 for names in chosen.values()), f"frozen, it still varies: {chosen}"
        assert repr(snapshot()) == known, "frozen, it still learns"


POLICY_CHECKS: Final[tuple[Callable[[Build], None], ...]] = (
    check_every_choice_is_one_of_the_games_actions,
    check_same_seed_same_choices,
    check_robots_share_no_state,
    check_copies_go_on_alike,
    check_it_draws_from_the_streams_of_policies_alone,
    check_a_learner_can_be_told_and_stopped,
)
"""Every check of a policy: of its class, or of what calls it with arguments."""
