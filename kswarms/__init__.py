"""Competing swarms of foraging robots that learn whether to fight or to flee.

The names below are the public interface; docs/api.md says how it may change. Each is loaded on first use, so
that ``import kswarms`` is fast.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from kswarms.agents.actions import AWAY, TOWARDS, Action
    from kswarms.agents.common.errors import InputError
    from kswarms.agents.learning.bandit import Bandit
    from kswarms.agents.learning.rewards import Reward
    from kswarms.agents.learning.selection_rules import Rule
    from kswarms.agents.policies.interface import LearningPolicy, Policy, Setting
    from kswarms.agents.policies.learner import Learner
    from kswarms.agents.robot.body import Body
    from kswarms.agents.streams import Purpose
    from kswarms.model.description.game import Game, Swarm
    from kswarms.model.description.parameters import Parameters
    from kswarms.model.foraging import ForagingModel
    from kswarms.model.game_model import GameModel
    from kswarms.scenarios.catalogue import CATALOGUE
    from kswarms.scenarios.description.scenario import Condition, Scenario, SwarmRule

__version__ = "0.2.0"

_HOMES: Final = {
    "agents.actions": ("AWAY", "TOWARDS", "Action"),
    "agents.common.errors": ("InputError",),
    "agents.learning.bandit": ("Bandit",),
    "agents.learning.rewards": ("Reward",),
    "agents.learning.selection_rules": ("Rule",),
    "agents.policies.interface": ("LearningPolicy", "Policy", "Setting"),
    "agents.policies.learner": ("Learner",),
    "agents.robot.body": ("Body",),
    "agents.streams": ("Purpose",),
    "model.description.game": ("Game", "Swarm"),
    "model.description.parameters": ("Parameters",),
    "model.foraging": ("ForagingModel",),
    "model.game_model": ("GameModel",),
    "scenarios.catalogue": ("CATALOGUE",),
    "scenarios.description.scenario": ("Condition", "Scenario", "SwarmRule"),
}
_HOME_OF: Final = {name: f"kswarms.{home}" for home, names in _HOMES.items() for name in names}

__all__ = [
    "AWAY",
    "CATALOGUE",
    "TOWARDS",
    "Action",
    "Bandit",
    "Body",
    "Condition",
    "ForagingModel",
    "Game",
    "GameModel",
    "InputError",
    "Learner",
    "LearningPolicy",
    "Parameters",
    "Policy",
    "Purpose",
    "Reward",
    "Rule",
    "Scenario",
    "Setting",
    "Swarm",
    "SwarmRule",
]


def __getattr__(name: str) -> Any:
    if name in _HOME_OF:
        value = globals()[name] = getattr(import_module(_HOME_OF[name]), name)
        return value
    raise AttributeError(f"module 'kswarms' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
