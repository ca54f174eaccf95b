"""The classes of the documentation pass the conformance checks."""

from collections.abc import Callable
from functools import partial
from typing import Any

import pytest

from kswarms.agents.conformance import POLICY_CHECKS, REWARD_CHECKS, RULE_CHECKS
from kswarms.agents.learning.rewards import WLU
from kswarms.agents.learning.selection_rules import Greedy
from kswarms.agents.policies.spec import make_policy
from kswarms.agents.user_code.loading import load_class

Check = Callable[[Any], None]
POLICIES = [
    "docs/examples/cautious.py:Cautious",
    "docs/examples/cautious.py:Cautious(patience=0)",
    "docs/examples/win_stay.py:WinStay(enough=4.0)",
    "learner(reward='docs/examples/haste.py:Haste(cost=0.1)', rule='docs/examples/haste.py:EpsilonGreedy')",
]


@pytest.mark.parametrize("text", POLICIES)
@pytest.mark.parametrize("check", POLICY_CHECKS)
def test_a_policy_passes_every_check(text: str, check: Check) -> None:
    check(partial(make_policy, text))


@pytest.mark.parametrize("check", REWARD_CHECKS)
def test_a_reward_passes_every_check(check: Check) -> None:
    check(partial(load_class("reward", "docs/examples/haste.py:Haste"), cost=0.2))


@pytest.mark.parametrize("check", RULE_CHECKS)
def test_a_rule_passes_every_check(check: Check) -> None:
    check(load_class("rule", "docs/examples/haste.py:EpsilonGreedy"))


class Mutable(WLU):
    """Changes itself although it is frozen."""

    def of(self, *conflict: Any) -> float:
        object.__setattr__(self, "delta", self.delta / 2 if isinstance(self.delta, float) else self.delta)
        return super().of(*conflict)


class Unequal(Greedy):
    """Equals only itself."""

    def __eq__(self, other: object) -> bool:
        return self is other

    __hash__ = Greedy.__hash__


def test_a_failed_check_has_a_message() -> None:
    rewards, rules = ({check.__name__: check for check in checks} for checks in (REWARD_CHECKS, RULE_CHECKS))
    with pytest.raises(AssertionError, match="its use changes it"):
        rewards["check_frozen"](Mutable)
    with pytest.raises(AssertionError, match=r"of\(.*\) differs"):
        rewards["check_same_conflict_gives_same_reward"](Mutable)
    with pytest.raises(AssertionError, match="another is not equal"):
        rules["check_copies"](Unequal)
