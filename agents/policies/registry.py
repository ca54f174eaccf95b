"""The named policies of the package."""

from collections.abc import Callable
from functools import partial
from typing import Final, NamedTuple

from kswarms.agents.policies.fixed import Aggressive, Attack, Avoid, RandomPolicy
from kswarms.agents.policies.interface import Policy
from kswarms.agents.policies.learner import Learner
from kswarms.agents.policies.saved import LearnedPolicy


class Kind(NamedTuple):
    """A named policy.

    Attributes
    ----------
    make : callable
        Builds the policy from a `Setting` and the arguments in the text.
    arguments : tuple of str
        Names of the arguments that the text may give.
    """

    make: Callable[..., Policy]
    arguments: tuple[str, ...] = ()


_LEARNING: Final = ("reward", "rule", "otherwise")

POLICIES: Final[dict[str, Kind]] = {
    "avoid": Kind(Avoid),
    "attack": Kind(Attack),
    "aggressive": Kind(Aggressive),
    "random": Kind(RandomPolicy),
    "learner": Kind(Learner, ("about", *_LEARNING)),
    "inter-learner": Kind(partial(Learner, about="inter"), _LEARNING),
    "intra-learner": Kind(partial(Learner, about="intra"), _LEARNING),
    "learned": Kind(LearnedPolicy, ("file",)),
}
"""The policies by name."""

ALIASES: Final = {"mixed": "avoid+aggressive"}
"""Names that stand for several policies."""
