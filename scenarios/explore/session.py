"""What the page is about, without the page: the controls, the game that they led to, how it is played.

A control that says something impossible leaves the game as it is and says why in one line.
"""

import math
import time as clock
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Final

from kswarms.agents.common.errors import InputError
from kswarms.agents.policies.editing import with_learning
from kswarms.agents.policies.learner import Learner
from kswarms.scenarios.catalogue.selecting import USUAL_N, chosen, integers
from kswarms.scenarios.description.condition import Condition
from kswarms.scenarios.explore.form import Form, SwarmForm, with_parameter
from kswarms.scenarios.runs.play import run_errors
from kswarms.scenarios.runs.run import Run
from kswarms.scenarios.watch.player import Player

Act = Callable[[Callable[[], None]], None]
"""Does something to a session, and has the page shown anew."""

SPEEDS: Final = (1, 2, 5, 10, 20, 50, 100)
"""Seconds of the game in a second of the clock on the wall."""
_HASTE: Final = 0.2
"""For how long a game may be played at full speed until it is shown again (s)."""
_STRIDE: Final = 5.0
"""Between two looks at the clock meanwhile (s of the game)."""


class Session:
    """One page: its controls and its game.

    Parameters
    ----------
    start : str or Run
        What it begins with: a scenario as `kswarms.scenarios.catalogue.selecting.chosen` takes it, or a run.

    Attributes
    ----------
    source : str
        Scenario or run that the form was taken from.
    title : str
        What that is, in a line.
    curves : dict of str to Condition
        The curves of it, by their names; none of a run.
    curve : str
        Name of the one that the form was taken from.
    form : Form
        What the controls say.
    error : str
        Why that cannot be played, or why the game failed, in a line; empty if neither.
    player : Player
        The game.
    playing : bool
        Whether it runs.
    speed : int
        Seconds of the game in a second.
    goal : float, optional
        Instant to which the game is played as fast as can be (s, as `Player.time`).
    chosen : int
        Number of the robot that is looked into; it may be absent.
    show_sectors, show_sensors : bool
        Whether the sectors in which robots ahead start a conflict are drawn, and the chosen robot's sensors.

    Raises
    ------
    InputError
        If there is no such scenario or run.
    RunError
        If its game fails before it has begun.
    """

    def __init__(self, start: str | Run) -> None:
        self.playing = False
        self.speed = 10
        self.goal: float | None = None
        self.show_sectors = False
        self.show_sensors = True
        self.error = ""
        self._failed = False
        self._passing = False
        self._owed = 0.0
        if isinstance(start, Run):
            self.source = f"run {start.digest}"
            self.title = ", ".join(" ".join(label).strip() for label in start.labels)
            self.curves: dict[str, Condition] = {}
            self.curve = ""
            self.form = Form.of_game(start.game, start.seed)
        else:
            self._open(start)
            self.form = self._form(USUAL_N, 0)
        game = self.form.game()
        with run_errors(f"the game of {self.source}"):
            self.player = Player(game, self.form.seed)
        self.chosen = self._first_learner()

    def close(self) -> None:
        """Let the game go."""
        self.playing = False
        self.player.close()

    # The controls.

    def load(self, scenario: str) -> None:
        """Take the controls from a scenario's first curve."""
        with self._told():
            self._open(scenario)
            self.choose_curve(self.curve)

    def choose_curve(self, name: str) -> None:
        """Take the controls from a curve of the scenario."""
        self.curve = name
        self.change(self._form(self.form.n, self.form.seed))
        self.chosen = self._first_learner()

    def _open(self, source: str) -> None:
        scenarios = chosen([source])
        several = len(scenarios) > 1
        self.source = source
        self.title = "; ".join(scenario.title for scenario in scenarios)
        self.curves = {
            f"{scenario.id} {condition.name}".strip() if several else condition.name: condition
            for scenario in scenarios
            for condition in scenario.conditions
        }
        self.curve = next(iter(self.curves))

    def change(self, form: Form) -> None:
        """Play what the form says, from its beginning; say why if it cannot be played."""
        self.form = form
        with self._told():
            player = Player(form.game(), form.seed)
            self.player.close()
            self.player = player
            self.error = ""
            self._failed = False
            self.goal = None
            self._owed = 0.0
            self.chosen = min(self.chosen, form.n - 1)

    def change_parameter(self, name: str, value: float) -> None:
        """Change a parameter of the world."""
        with self._told():
            self.change(self.form._replace(parameters=with_parameter(self.form.parameters, name, value)))

    def change_learning(self, part: str, name: str = "", **arguments: float) -> None:
        """Change the reward or the rule of all learners, as in `with_learning`."""
        with self._told():
            swarms = (
                swarm._replace(policy=with_learning(swarm.policy, part, name or None, **arguments))
                for swarm in self.form.swarms
            )
            self.change(self.form._replace(swarms=tuple(swarms)))

    def change_swarm(self, k: int, **changes: Any) -> None:
        """Change controls of a swarm (from 0); other shares bring the nearest N that suits them."""
        form = self.form.with_swarm(k, **changes)
        if "share" in changes:
            form = form._replace(multiple_of=None)
            form = form._replace(n=_suitable(form.n, _step(form)))
        self.change(form)

    def change_swarms(self, swarms: int) -> None:
        """Have so many swarms: drop the last, or add some that avoid."""
        kept = self.form.swarms[:swarms]
        added = (SwarmForm(),) * (swarms - len(kept))
        form = self.form._replace(swarms=kept + added, multiple_of=None)
        self.change(form._replace(n=_suitable(form.n, _step(form))))

    def change_absent(self, text: str) -> None:
        """Have robots be absent: their numbers, separated by commas; an empty text has all of them back."""
        with self._told():
            self.change(self.form._replace(absent=integers("absent", text or None)))

    def choose(self, robot: int) -> None:
        """Look into a robot."""
        self.chosen = min(max(0, robot), self.player.game.size - 1)

    def step_of_n(self) -> int:
        """Return what the number of robots must be a multiple of."""
        return _step(self.form)

    def _form(self, n: int, seed: int) -> Form:
        form = Form.of_condition(self.curves[self.curve], n, seed)
        return form._replace(n=_suitable(n, _step(form)))

    def _first_learner(self) -> int:
        """Return the first robot that learns, which has most to show; the first of all if none does."""
        robots = self.player.model.robots
        learners = (robot.number for robot in robots if isinstance(robot.policy, Learner))
        return next(learners, robots[0].number)

    @contextmanager
    def _told(self, passing: bool = False) -> Iterator[None]:
        """Tell what goes wrong in a line instead of letting it go on.

        What is passing is told until the game goes where it is asked to; the rest, until the form is right.
        """
        try:
            yield
        except InputError as error:
            self.error = str(error)
            self._passing = passing
        except (Exception, SystemExit) as error:  # noqa: BLE001  # a policy of the user's own may fail anyhow
            self._failed = self._passing = True
            self.error = f"the game failed: {type(error).__name__}: {error}"

    # Playing.

    @property
    def active(self) -> bool:
        """Whether the game moves by itself."""
        if self._failed:
            return False
        return self.goal is not None or (self.playing and not self.player.ended)

    def play(self) -> None:
        """Let the game run, or stop it."""
        self.playing = not self.playing
        self._owed = 0.0

    def step(self) -> None:
        """Stop, and play one control period."""
        self.playing = False
        with self._told():
            self.player.advance(0.0)

    def reset(self) -> None:
        """Go back to the beginning, that of learning."""
        self.goal = None
        with self._told(passing=True):
            self.player.seek(-self.player.begin)
            self._failed = False
            if self._passing:
                self.error = ""

    def go_to(self, time: float) -> None:
        """Go to an instant as fast as can be, in `tick`s."""
        with self._told(passing=True):
            if not math.isfinite(time):
                raise InputError("t", time, "must be a finite number of seconds")
            if time < self.player.time:
                self.reset()
            elif self._passing and not self._failed:
                self.error = ""
            self.goal = time

    def next_conflict(self) -> None:
        """Stop, and play on until the chosen robot begins a conflict."""
        self.playing = False
        with self._told():
            self.player.to_next_conflict(self.chosen)

    def tick(self, elapsed: float) -> bool:
        """Let a time pass on the wall.

        Parameters
        ----------
        elapsed : float
            Seconds.

        Returns
        -------
        bool
            Whether the game has moved.
        """
        player = self.player
        if not self.active:
            return False
        if self.goal is not None:
            return self._hurry(player, self.goal)
        self._owed += elapsed * self.speed
        period = player.game.parameters.period
        due = int(self._owed / period + 1e-9) * period
        if due == 0.0:
            return False
        self._owed -= due
        with self._told():
            player.advance(due)
        return True

    def _hurry(self, player: Player, goal: float) -> bool:
        enough = clock.monotonic() + _HASTE
        with self._told():
            while player.time < goal and not player.ended and clock.monotonic() < enough:
                player.seek(min(goal, player.time + _STRIDE))
        if self.goal == goal and (player.time >= goal or player.ended):
            self.goal = None
        return True


def _step(form: Form) -> int:
    shares = [swarm.share for swarm in form.swarms]
    return form.multiple_of or max(1, sum(shares) // (math.gcd(*shares) or 1))


def _suitable(n: int, step: int) -> int:
    """Return the multiple of `step` that is nearest to `n`, at least one."""
    return max(1, round(n / step)) * step
