"""The named policies of the package."""

from collections.abc import Callable
from functools import partial
from typing import Final

from kswarms.agents.policies.fixed import Aggressive, Attack, Avoid, RandomPolicy
from kswarms.agents.policies.interface import Policy
from kswarms.agents.policies.learner import Learner
from kswarms.agents.policies.saved import LearnedPolicy

POLICIES: Final[dict[str, Callable[..., Policy]]] = {
    "avoid": Avoid,
    "attack": Attack,
    "aggressive": Aggressive,
    "random": RandomPolicy,
    "learner": Learner,
    "inter-learner": partial(Learner, about="inter"),
    "intra-learner": partial(Learner, about="intra"),
    "learned": LearnedPolicy,
}
"""Classes and factories by name, called with a `Setting` and the arguments of the text."""

ALIASES: Final = {"mixed": "avoid+aggressive"}
"""Names that stand for several policies."""
