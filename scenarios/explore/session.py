"""State of one page, independent of its widgets: the controls and the game that they describe.

An invalid control leaves the game unchanged and reports an error.
"""

import math
from collections.abc import Callable, Iterator
from typing import Any, Final

from kswarms.agents.common.errors import InputError
from kswarms.agents.policies.editing import with_learning
from kswarms.agents.policies.learner import Learner
from kswarms.agents.policies.spec import PolicyLike, parse_policies
from kswarms.model.description.game import Game
from kswarms.scenarios.catalogue.selection import DEFAULT_N, select_scenarios
from kswarms.scenarios.description.condition import Condition, SwarmRule
from kswarms.scenarios.description.text import parse_integers
from kswarms.scenarios.explore.form import Form, with_parameter
from kswarms.scenarios.explore.playback import Playback
from kswarms.scenarios.runs.play import run_errors
from kswarms.scenarios.runs.run import Run
from kswarms.scenarios.watch.player import Player

Act = Callable[[Callable[[], None]], None]
"""Performs an action on the session, then updates the page."""

_NO_CODE: Final = "must not name code or a file; to allow it, start `kswarms explore` with --allow-code"


class Session(Playback):
    """The controls of a page and its game.

    It starts with a scenario (an id or file, as for `select_scenarios`) or with a run. `source` and `title`
    describe either. `conditions` are the conditions of the scenario, by name. `selected` is the number of the
    selected robot, which may be absent. A game that fails at its start raises a `RunError`.

    Without `allow_code`, the controls can name no code and no files except those that `start` names, so that
    nobody can execute another Python file through the page.
    """

    def __init__(self, start: str | Run, allow_code: bool = False) -> None:
        self.allow_code = allow_code
        self._start = start
        self._own_references: set[str] = set()  # code and files that `start` names
        self.show_sectors = False  # conflict sectors of all robots
        self.show_sensors = True  # sensors of the selected robot
        if isinstance(start, Run):
            self.source = f"run {start.digest}"
            self.title = ", ".join(" ".join(label).strip() for label in start.labels)
            self.conditions: dict[str, Condition] = {}
            self.condition = ""
            self.form = Form.of_game(start.game, start.seed)
            self._own_references.update(*(_references(swarm.policy) for swarm in start.game.swarms))
        else:
            self._open(start)
            self.form = self._form_of_condition(DEFAULT_N, 0)
        game = self._game()
        with run_errors(f"the game of {self.source}"):
            super().__init__(Player(game, self.form.seed))
        self.selected = self._first_learner()

    def load(self, scenario: str) -> None:
        """Set the controls to the first condition of a scenario."""
        with self.report_errors():
            self._open(scenario)
            self.select_condition(self.condition)

    def select_condition(self, name: str) -> None:
        """Set the controls to a condition of the scenario."""
        self.condition = name
        self._restart(self._form_of_condition(self.form.n, self.form.seed))
        self.selected = self._first_learner()

    def change(self, **changes: Any) -> None:
        """Change fields of the form and restart the game."""
        self._restart(self.form.replace(**changes))

    def change_parameter(self, name: str, value: float) -> None:
        """Change a parameter of the world."""
        with self.report_errors():
            self.change(parameters=with_parameter(self.form.fields["parameters"], name, value))

    def change_learning(self, part: str, name: str = "", **arguments: float) -> None:
        """Change the reward or the rule of all learners, as `with_learning` does."""
        with self.report_errors():
            policies = [
                with_learning(swarm["policy"], part, name or None, **arguments) for swarm in self.form.swarms
            ]
            pairs = zip(self.form.swarms, policies, strict=True)
            self.change(swarms=tuple(swarm | {"policy": policy} for swarm, policy in pairs))

    def change_swarm(self, k: int, **changes: Any) -> None:
        """Change fields of a swarm (from 0). A new share rounds N to the nearest allowed number."""
        form = self.form.replace_swarm(k, **changes)
        self._restart(_suit_n(form.replace(multiple_of=None)) if "share" in changes else form)

    def add_swarms(self, more: int) -> None:
        """Add swarms that avoid; remove the last swarms if `more` is negative."""
        kept = self.form.swarms[: more if more < 0 else None]
        added = (SwarmRule(policy="avoid").model_dump(),) * more
        self._restart(_suit_n(self.form.replace(swarms=kept + added, multiple_of=None)))

    def change_absent(self, text: str) -> None:
        """Set the absent robots: numbers separated by commas; none for an empty text."""
        with self.report_errors():
            self.change(absent=parse_integers("absent", text or None))

    def select(self, robot: int) -> None:
        """Select a robot."""
        self.selected = min(max(0, robot), self.player.game.size - 1)

    def step_of_n(self) -> int:
        """Return the number that N must be a multiple of."""
        return _step(self.form)

    def _game(self) -> Game:
        """Return the game of the form; raise `InputError` if it is invalid or names other code."""
        for swarm in self.form.swarms if not self.allow_code else ():
            if not self._own_references.issuperset(_references(swarm["policy"])):
                raise InputError("policy", swarm["policy"], _NO_CODE)
        return self.form.game()

    def _open(self, source: str) -> None:
        if source.endswith(".toml") and source != self._start and not self.allow_code:
            raise InputError("id", source, _NO_CODE)
        scenarios = select_scenarios([source])
        if source == self._start:
            rules = [rule for scenario in scenarios for each in scenario.conditions for rule in each.swarms]
            self._own_references.update(*(_references(rule.policy) for rule in rules))
        several = len(scenarios) > 1
        self.source = source
        self.title = "; ".join(scenario.title for scenario in scenarios)
        self.conditions = {
            f"{scenario.id} {condition.name}".strip() if several else condition.name: condition
            for scenario in scenarios
            for condition in scenario.conditions
        }
        self.condition = next(iter(self.conditions))

    def _form_of_condition(self, n: int, seed: int) -> Form:
        return _suit_n(Form.of_condition(self.conditions[self.condition], n, seed))

    def _restart(self, form: Form) -> None:
        """Play the game of a form from its beginning, or report why it is invalid."""
        self.form = form
        with self.report_errors():
            self.restart(Player(self._game(), form.seed))
            self.selected = min(self.selected, form.n - 1)

    def _first_learner(self) -> int:
        """Return the number of the first robot that learns, or of the first robot if none learns."""
        robots = self.player.model.robots
        learners = (robot.number for robot in robots if isinstance(robot.policy, Learner))
        return next(learners, robots[0].number)


def _references(policy: PolicyLike) -> Iterator[str]:
    """Yield the references to user-defined classes and the files of a policy."""
    for spec in parse_policies(policy):
        yield from spec.references.values()
        if (file := spec.arguments.get("file")) is not None:
            yield str(file)


def _step(form: Form) -> int:
    shares = [swarm["share"] for swarm in form.swarms]
    multiple_of: int | None = form.fields["multiple_of"]
    return multiple_of or max(1, sum(shares) // (math.gcd(*shares) or 1))


def _suit_n(form: Form) -> Form:
    """Return the form with the nearest number of robots that its shares allow."""
    step = _step(form)
    return form.replace(n=max(1, round(form.n / step)) * step)
