"""Checks of policies."""

import copy
import pickle
import random
from collections.abc import Callable
from typing import Any, Final, cast

import numpy as np

from kswarms.agents.actions import AWAY, TOWARDS, Action
from kswarms.agents.conformance.shared import CheckError, require
from kswarms.agents.policies.interface import LearningPolicy, Policy, Setting
from kswarms.agents.policies.saved import check_arms, snapshot_of
from kswarms.agents.policies.spec import Factory
from kswarms.agents.streams import Purpose, Streams, stream

TWO_ACTIONS: Final = (
    Action(name="flight", direction=AWAY, duration=1.8),
    Action(name="fight", direction=TOWARDS, duration=1.0),
)
FOUR_ACTIONS: Final = (
    *TWO_ACTIONS,
    Action(name="dash", direction=AWAY, duration=0.1),
    Action(name="ram", direction=TOWARDS, duration=3.0),
)


def make_setting(
    swarm: int = 1, swarms: int = 2, actions: tuple[Action, ...] = TWO_ACTIONS, seed: int = 0, robot: int = 3
) -> Setting:
    """Return the setting of a robot."""
    return Setting(swarm, swarms, actions, Streams(seed, robot))


def make_settings() -> list[Setting]:
    """Return settings in games of two and three swarms, with two and four actions."""
    robots = [(swarm, swarms) for swarms in (2, 3) for swarm in range(swarms)]
    return [make_setting(*robot, actions) for robot in robots for actions in (TWO_ACTIONS, FOUR_ACTIONS)]


def play_conflicts(
    policy: Policy, setting: Setting, conflicts: int = 80, learning: bool = True
) -> list[tuple[Any, ...]]:
    """Play conflicts with fixed opponents and times, and check what the policy's methods return.

    Returns the choices as (opponent, action), each followed by the result of ``learn`` if there is one.
    """
    rng, trace = np.random.default_rng(7), []
    learn = getattr(policy, "learn", None) if learning else None
    for k in range(conflicts):
        opponent = k if k < setting.swarms else int(rng.integers(setting.swarms))
        t_a, t_p, n_active = rng.uniform(1, 3), rng.uniform(0, 20), int(rng.integers(9))
        action = policy.choose(opponent)
        rule = f"choose({opponent}) must return an action of the game, not {action!r}"
        require(action in setting.actions, rule)
        trace.append((opponent, action.name))
        if learn is not None:
            result = learn(t_a, t_p, n_active)
            is_pair = isinstance(result, tuple) and [isinstance(x, float) for x in result] == [True, True]
            require(is_pair, f"learn(…) must return two floats, R and Q, not {result!r}")
            trace.append(result)
    return trace


def check_snapshot_of(policy: Policy, setting: Setting) -> None:
    """Check that ``snapshot()``, if defined, has the format of `Learner.snapshot` and arms of the game."""
    arms = snapshot_of(policy)
    try:
        check_arms(arms)
    except (ValueError, KeyError, TypeError) as error:
        raise CheckError(f"snapshot() must be like Learner.snapshot() ({error})") from None
    names = [action.name for action in setting.actions]
    for arm in arms:
        known = arm["action"] in names and 1 <= arm["opponent"] <= setting.swarms
        require(known, f"snapshot() must describe the game's actions and swarms, not {arm}")


def check_results_of_methods(build: Factory) -> None:
    """Check that the methods return actions of the game, pairs of floats and arms of the game."""
    for setting in make_settings():
        policy = build(setting)
        play_conflicts(policy, setting)
        check_snapshot_of(policy, setting)


def check_same_seed_gives_same_choices(build: Factory) -> None:
    """Check that the robot's streams are the only source of randomness."""
    for setting in make_settings():
        traces = []
        for _ in range(2):
            fresh = setting._replace(streams=Streams(0, 3))
            traces.append(repr(play_conflicts(build(fresh), fresh)))
            random.random()
        require(traces[0] == traces[1], "the same seed gave other choices")


def check_robots_share_no_state(build: Factory) -> None:
    """Check that the conflicts of one robot do not change another robot's choices."""
    alone, other, beside = (make_setting(robot=robot) for robot in (4, 5, 4))
    expected = play_conflicts(build(alone), alone)
    other_policy, policy = build(other), build(beside)
    play_conflicts(other_policy, other)
    trace = play_conflicts(policy, beside)
    require(repr(trace) == repr(expected), "another robot's conflicts change the choices")


def check_copies_behave_alike(build: Factory) -> None:
    """Check that deep copies and pickled copies choose and learn like the original."""
    setting = make_setting()
    policy = build(setting)
    play_conflicts(policy, setting, conflicts=17)
    twins = {"a deep copy": copy.deepcopy(policy), "a pickled copy": pickle.loads(pickle.dumps(policy))}
    trace = repr(play_conflicts(policy, setting))
    for name, twin in twins.items():
        require(repr(play_conflicts(twin, setting)) == trace, f"{name} behaves differently")


def check_other_streams_are_untouched(build: Factory) -> None:
    """Check that the policy draws only from the streams for policies."""
    setting = make_setting(seed=6)
    play_conflicts(build(setting), setting)
    for purpose in set(Purpose) - {Purpose.EXPLORE, Purpose.POLICY}:
        untouched = stream(6, 3, purpose).random()
        require(setting.streams.generator(purpose).random() == untouched, f"it draws from {purpose.name}")


def check_freezing_stops_learning(build: Factory) -> None:
    """Check that `freeze` ends exploration and learning."""
    for setting in make_settings():
        policy = build(setting)
        if not hasattr(policy, "learn"):
            continue
        play_conflicts(policy, setting)
        learner = cast(LearningPolicy, policy)
        learner.freeze()
        learned = repr(snapshot_of(policy))
        chosen: dict[int, set[str]] = {}
        for opponent, action in play_conflicts(policy, setting, learning=False):
            chosen.setdefault(opponent, set()).add(action)
        fixed = all(len(names) == 1 for names in chosen.values())
        require(fixed, f"the choices still vary after freeze(): {chosen}")
        require(repr(snapshot_of(policy)) == learned, "it still learns after freeze()")


POLICY_CHECKS: Final[tuple[Callable[[Factory], None], ...]] = (
    check_results_of_methods,
    check_same_seed_gives_same_choices,
    check_robots_share_no_state,
    check_copies_behave_alike,
    check_other_streams_are_untouched,
    check_freezing_stops_learning,
)
"""The checks of a policy's class or factory."""
