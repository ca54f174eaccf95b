"""Trial of user-defined code before a game: a short subset of the conformance checks."""

import hashlib
from collections.abc import Callable
from itertools import product
from typing import Any, cast

from kswarms.agents.common.errors import InputError
from kswarms.agents.conformance.policies import check_snapshot_of, play_conflicts
from kswarms.agents.conformance.rewards import compute_rewards
from kswarms.agents.conformance.rules import choose_arms
from kswarms.agents.conformance.shared import CheckError
from kswarms.agents.policies.interface import LearningPolicy, Policy, Setting
from kswarms.agents.policies.learner import Learner
from kswarms.agents.policies.spec import PolicySpec
from kswarms.agents.streams import Streams
from kswarms.agents.user_code.loading import reference_to, user_errors

STATEFUL = "its two trial games differ: does it use global random numbers or keep state between robots?"
"""Rule that a policy breaks if the same robots with the same seed act differently."""


def try_policy(spec: PolicySpec, setting: Setting, robots: int = 1, conflicts: int = 19) -> str:
    """Exercise the user-defined parts of a policy, so that errors surface before the game.

    A policy with a text plays two equal trial games, which must agree. A class or factory without a text
    plays one: it cannot be loaded by other processes, so it may keep state.

    Parameters
    ----------
    setting : Setting
        Swarm, swarms and actions of the robots of the trial game.
    robots, conflicts : int
        Number of robots, and of conflicts of each robot. A counter is noticed unless its period divides their
        product.

    Returns
    -------
    str
        Digest of the trial game. It is equal in every process unless the policy has hidden state.

    Raises
    ------
    InputError
        If the code raises an error or breaks a rule, or if the trial games differ.
    """
    policy = spec.build(setting)
    if isinstance(policy, Learner):
        reward, rule, arms = policy.reward, policy.rule, len(setting.actions)
        cases = product((2.3,), (0.0, 6.0), (3,), (-1, 1), (False, True), (1,))
        _try_part("reward", reward, lambda: compute_rewards(reward, cases))
        _try_part("rule", rule, lambda: choose_arms(rule, arms, seed=0, conflicts=2 * arms))
    games: list[str] = []
    for _ in range(1 if spec.call is None else 2):
        _try("policy", str(spec), lambda: games.append(_play_game(spec, setting, robots, conflicts)))
    if games[0] != games[-1]:
        raise InputError("policy", str(spec), STATEFUL)
    return hashlib.sha256(games[0].encode()).hexdigest()


def _play_game(spec: PolicySpec, setting: Setting, robots: int, conflicts: int) -> str:
    """Let robots act in fixed conflicts, also after learning; return all that they choose and learn."""
    make, trace = spec.factory(setting.actions), []
    for robot in range(robots):
        own = setting._replace(streams=Streams(0, robot), place=robot)
        policy: Policy = make(own)
        trace += play_conflicts(policy, own, conflicts)
        if hasattr(policy, "learn"):
            cast(LearningPolicy, policy).freeze()
            trace += play_conflicts(policy, own, setting.swarms, learning=False)
        check_snapshot_of(policy, own)
    return repr(trace)


def _try_part(part: str, used: object, attempt: Callable[[], Any]) -> None:
    """Try the reward or the rule of a learner if it is user-defined."""
    kind = type(used)
    if not kind.__module__.startswith("kswarms."):
        _try(f"policy.{part}", reference_to(kind) or kind.__qualname__, attempt)


def _try(field: str, reference: str, attempt: Callable[[], Any]) -> None:
    with user_errors(field, reference, "its trial"):
        try:
            attempt()
        except (CheckError, InputError) as error:
            raise InputError(field, reference, str(error)) from None
