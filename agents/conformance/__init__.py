"""Checks that every policy, reward and selection rule must pass, for tests of user-defined ones.

Each check takes a class or a factory, and raises an `AssertionError` if it fails. The checks need no test
framework; with pytest::

    @pytest.mark.parametrize("check", POLICY_CHECKS)
    def test_my_policy(check):
        check(MyPolicy)
"""

from kswarms.agents.conformance.policies import POLICY_CHECKS
from kswarms.agents.conformance.rewards import REWARD_CHECKS
from kswarms.agents.conformance.rules import RULE_CHECKS

__all__ = ["POLICY_CHECKS", "REWARD_CHECKS", "RULE_CHECKS"]
