"""Trial of user-defined code before a game: a short subset of the conformance checks."""

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
from kswarms.agents.user_code.loading import reference_to, user_errors


def try_policy(spec: PolicySpec, setting: Setting) -> None:
    """Build a policy and exercise its user-defined parts once, so that errors surface before the game."""
    policy = spec.build(setting)
    if isinstance(policy, Learner):
        reward, rule, arms = policy.reward, policy.rule, len(setting.actions)
        conflicts = product((2.3,), (0.0, 6.0), (3,), (-1, 1), (False, True), (1,))
        _try_part("reward", reward, lambda: compute_rewards(reward, conflicts))
        _try_part("rule", rule, lambda: choose_arms(rule, arms, seed=0, conflicts=2 * arms))
    if spec.is_user_defined:
        _try("policy", spec.name, lambda: _play(policy, setting))


def _play(policy: Policy, setting: Setting) -> None:
    play_conflicts(policy, setting, conflicts=len(setting.actions) * setting.swarms)
    if hasattr(policy, "learn"):
        cast(LearningPolicy, policy).freeze()
    check_snapshot_of(policy, setting)


def _try_part(part: str, used: object, attempt: Callable[[], Any]) -> None:
    """Try the reward or the rule of a learner if it is user-defined."""
    kind = type(used)
    if not kind.__module__.startswith("kswarms."):
        _try(f"policy.{part}", reference_to(kind) or kind.__qualname__, attempt)


def _try(field: str, reference: str, attempt: Callable[[], Any]) -> None:
    with user_errors(field, reference, "its trial"):
        try:
            attempt()
        except CheckError as error:
            raise InputError(field, reference, str(error)) from None
