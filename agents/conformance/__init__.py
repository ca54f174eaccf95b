"""What every policy, reward and selection rule must do, as checks that a test of a user's own can run.

Each check takes what builds the thing, and raises an `AssertionError` that says what is wrong. They need no
test framework; with pytest::

    @pytest.mark.parametrize("check", POLICY_CHECKS)
    def test_my_policy(check):
        check(MyPolicy)
"""

from kswarms.agents.conformance.policies import POLICY_CHECKS
from kswarms.agents.conformance.rewards import REWARD_CHECKS
from kswarms.agents.conformance.rules import RULE_CHECKS

__all__ = ["POLICY_CHECKS", "REWARD_CHECKS", "RULE_CHECKS"]
