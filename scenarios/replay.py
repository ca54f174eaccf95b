"""Replay: a run found again by its row, and its conflicts told one by one.

A run is a game and a seed, and a game with a seed has one course only, so nothing has to be recorded to see
it again: it is played again.
"""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from agents.bandit import Bandit
from agents.errors import InputError
from agents.learner import Learner
from agents.selection import FORGOTTEN, UCB
from scenarios.catalogue import CATALOGUE
from scenarios.runs import Run, digest

if TYPE_CHECKING:
    from model.foraging import GameModel


class Arm(NamedTuple):
    """What a robot knows of an action against a swarm.

    Attributes
    ----------
    action : str
        Name of the action.
    count : float
        N(a), discounted where the rule discounts.
    q : float
        Q(a) (Eq. 4.15), NaN if it was never tried.
    bound : float
        Q(a) and what UCB adds for exploration (Eq. 4.16); NaN if the rule is none of UCB's, or an arm of the
        bandit was never tried.
    """

    action: str
    count: float
    q: float
    bound: float


class ConflictAccount(NamedTuple):
    """A conflict: who, where, what was known, what was chosen, what it earned.

    Attributes
    ----------
    phase : {'learning', 'game'}
        Whether learners still learned.
    robot, swarm : int
        Whose conflict it is: number of the robot from 0, its swarm from 1.
    opponent, opponent_swarm : int
        Whom it met.
    start : float
        When (s since the beginning, that of learning included).
    x, y : float
        Where (m).
    known : tuple of Arm
        What the robot knew at that moment of its actions against that swarm; empty if it learns nothing there.
    action : str
        What it chose.
    t_a, t_p : float
        T(a) and T(p) (s).
    active : int
        Sensors that were active, n'_i.
    reward, q : float
        R (s) and Q of the action after it; NaN where nothing was learned.
    """

    phase: str
    robot: int
    swarm: int
    opponent: int
    opponent_swarm: int
    start: float
    x: float
    y: float
    known: tuple[Arm, ...]
    action: str
    t_a: float
    t_p: float
    active: int
    reward: float
    q: float


def arms_known(learner: Learner, bandit: Bandit) -> tuple[Arm, ...]:
    """Return what a bandit of a learner knows of each action."""
    rule = learner.rule
    bounds = [math.nan] * len(bandit.count)
    if isinstance(rule, UCB) and min(bandit.count) >= FORGOTTEN:
        bounds = rule.bounds(bandit)
    return tuple(
        Arm(action.name, bandit.count[arm], bandit.value(arm), bounds[arm])
        for arm, action in enumerate(learner.actions)
    )


class Accounts:
    """The conflicts of a game as they are recorded, each with what was known when it began.

    A robot closes its last conflict, learns from it, and only then chooses; so what it knew is what the
    rewards recorded before amount to.

    Parameters
    ----------
    model : GameModel
        A game that records conflicts.
    """

    def __init__(self, model: "GameModel") -> None:
        self._table = model.datacollector.tables["conflicts"]
        self._learners = {
            robot.index: robot.policy for robot in model.robots if isinstance(robot.policy, Learner)
        }
        self._bandits = {
            (index, opponent): Bandit(len(learner.actions))
            for index, learner in self._learners.items()
            for opponent in learner.bandits
        }

    def take(self) -> Iterator[ConflictAccount]:
        """Take the conflicts out of the recorded table and yield them, in the order in which they closed."""
        names = list(self._table)
        columns = [self._table[name].copy() for name in names]
        for column in self._table.values():
            column.clear()  # a long game would fill the memory
        for values in zip(*columns, strict=True):
            yield self._account(dict(zip(names, values, strict=True)))

    def _account(self, row: dict[str, Any]) -> ConflictAccount:
        robot = row["robot"]
        bandit = self._bandits.get((robot, row["opponent_swarm"] - 1))
        known: tuple[Arm, ...] = ()
        if bandit is not None:
            learner = self._learners[robot]
            known = arms_known(learner, bandit)
            if not math.isnan(row["reward"]):
                arm = [action.name for action in learner.actions].index(row["action"])
                bandit.update(arm, row["reward"], row["t_a"] + row["t_p"], learner.rule.factor)
        return ConflictAccount(known=known, **row)


def conflicts_of(run: Run) -> list[ConflictAccount]:
    """Play a run again and return its conflicts, those of learning included, by their start.

    Parameters
    ----------
    run : Run
        What is played.
    """
    from mesa import Agent

    from model.foraging import GameModel

    model = GameModel(run.game, seed=run.seed, record="conflicts")
    try:
        model.play()
        return sorted(Accounts(model).take(), key=lambda account: (account.start, account.robot))
    finally:
        Agent._ids.pop(model, None)  # Mesa's table of the class would keep the model alive


def run_in(directory: Path, name: str) -> Run:
    """Return the run of a row in a results directory.

    Parameters
    ----------
    directory : Path
        That ``kswarms run`` wrote.
    name : str
        Digest of the run, or as much of its beginning as is in no other's.

    Raises
    ------
    InputError
        If there is no such run, or what the catalogue has under its scenario is another game.
    """
    import pyarrow.compute as pc
    import pyarrow.parquet as pq

    path = directory / "runs.parquet"
    if not path.is_file():
        raise InputError("results", str(directory), "must be a directory that `kswarms run` wrote")
    table = pq.read_table(path, columns=["run", "scenario", "condition", "n", "seed"])
    rows = table.filter(pc.starts_with(table["run"], name)).to_pylist()
    if not name or len({row["run"] for row in rows}) != 1:
        found = "none" if not rows else "several"
        raise InputError("run", name, f"must name one run of {path}, column run; it names {found}")
    row = rows[0]
    scenario = CATALOGUE.get(row["scenario"])
    if scenario is None:
        raise InputError("run", name, f"is of scenario {row['scenario']}, which is not in the catalogue")
    game = scenario.game(row["condition"], row["n"])
    if digest(game, row["seed"]) != row["run"]:
        raise InputError("run", name, "was another game: of another version, or with another policy file")
    labels = tuple((each["scenario"], each["condition"]) for each in rows)
    return Run(row["run"], game, row["seed"], tuple(dict.fromkeys(labels)))
