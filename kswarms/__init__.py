"""Competing swarms of foraging robots that learn whether to fight or to flee.

The names below are the public interface, documented in docs/api.md. Each is imported on first use, so that
``import kswarms`` is fast.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from kswarms.agents.actions import AWAY, TOWARDS, Action
    from kswarms.agents.body import Body
    from kswarms.agents.common.errors import InputError
    from kswarms.agents.learning.bandit import Bandit
    from kswarms.agents.learning.rewards import Reward
    from kswarms.agents.learning.selection_rules import Rule
    from kswarms.agents.policies.interface import LearningPolicy, Policy, Setting
    from kswarms.agents.policies.learner import Learner
    from kswarms.agents.policies.spec import make_policy
    from kswarms.agents.streams import Purpose
    from kswarms.analysis.figures.files import save_figure
    from kswarms.analysis.figures.over_n import figure_of
    from kswarms.analysis.findings import FINDINGS, Finding, judge, judge_all, read_findings
    from kswarms.analysis.results.records import read_conflicts
    from kswarms.analysis.results.runs import Results, read_results
    from kswarms.model.description.game import Game, Swarm
    from kswarms.model.description.parameters import Parameters
    from kswarms.model.description.presets import PRESETS, ensemble
    from kswarms.model.foraging import ForagingModel
    from kswarms.model.game_model import GameModel
    from kswarms.scenarios.catalogue import CATALOGUE
    from kswarms.scenarios.description.condition import Condition, SwarmRule
    from kswarms.scenarios.description.scenario import Scenario
    from kswarms.scenarios.description.toml_files import read_scenarios
    from kswarms.scenarios.study.study import Study

__version__ = "0.2.0"

_MODULES: Final = {
    "agents.actions": ("AWAY", "TOWARDS", "Action"),
    "agents.body": ("Body",),
    "agents.common.errors": ("InputError",),
    "agents.learning.bandit": ("Bandit",),
    "agents.learning.rewards": ("Reward",),
    "agents.learning.selection_rules": ("Rule",),
    "agents.policies.interface": ("LearningPolicy", "Policy", "Setting"),
    "agents.policies.learner": ("Learner",),
    "agents.policies.spec": ("make_policy",),
    "agents.streams": ("Purpose",),
    "analysis.figures.files": ("save_figure",),
    "analysis.figures.over_n": ("figure_of",),
    "analysis.findings": ("FINDINGS", "Finding", "judge", "judge_all", "read_findings"),
    "analysis.results.records": ("read_conflicts",),
    "analysis.results.runs": ("Results", "read_results"),
    "model.description.game": ("Game", "Swarm"),
    "model.description.parameters": ("Parameters",),
    "model.description.presets": ("PRESETS", "ensemble"),
    "model.foraging": ("ForagingModel",),
    "model.game_model": ("GameModel",),
    "scenarios.catalogue": ("CATALOGUE",),
    "scenarios.description.condition": ("Condition", "SwarmRule"),
    "scenarios.description.scenario": ("Scenario",),
    "scenarios.description.toml_files": ("read_scenarios",),
    "scenarios.study.study": ("Study",),
}
_MODULE_OF: Final = {name: f"kswarms.{module}" for module, names in _MODULES.items() for name in names}

__all__ = [
    "AWAY",
    "CATALOGUE",
    "FINDINGS",
    "PRESETS",
    "TOWARDS",
    "Action",
    "Bandit",
    "Body",
    "Condition",
    "Finding",
    "ForagingModel",
    "Game",
    "GameModel",
    "InputError",
    "Learner",
    "LearningPolicy",
    "Parameters",
    "Policy",
    "Purpose",
    "Results",
    "Reward",
    "Rule",
    "Scenario",
    "Setting",
    "Study",
    "Swarm",
    "SwarmRule",
    "ensemble",
    "figure_of",
    "judge",
    "judge_all",
    "make_policy",
    "read_conflicts",
    "read_findings",
    "read_results",
    "read_scenarios",
    "save_figure",
]


def __getattr__(name: str) -> Any:
    """Import a public name on first use (PEP 562)."""
    if name in _MODULE_OF:
        value = globals()[name] = getattr(import_module(_MODULE_OF[name]), name)
        return value
    raise AttributeError(f"module 'kswarms' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
