"""Replay: the conflicts of a run, told one by one.

A run is a game and a seed, and a game with a seed has one course only, so nothing has to be recorded to see
it again: it is played again.
"""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from kswarms.agents.learning.bandit import Bandit
from kswarms.agents.learning.selection_rules import FORGOTTEN, UCB
from kswarms.agents.policies.learner import Learner
from kswarms.scenarios.runs.play import finished_game
from kswarms.scenarios.runs.run import Run

if TYPE_CHECKING:
    from kswarms.model.game_model import GameModel


class Arm(NamedTuple):
    """What a robot knows of an action against a swarm.

    Attributes
    ----------
    action : str
        Name of the action.
    n : float
        N(a), discounted where the rule discounts.
    q : float
        Q(a) (Eq. 4.15), NaN if it was never tried.
    bound : float
        Q(a) and what UCB adds for exploration (Eq. 4.16); NaN if the rule is none of UCB's, or an arm of the
        bandit was never tried.
    """

    action: str
    n: float
    q: float
    bound: float


class ConflictAccount(NamedTuple):
    """A conflict, and what its robot knew when it began.

    Attributes
    ----------
    row : dict of str to object
        The columns of ``conflicts.parquet`` without `run` (`kswarms.agents.common.columns`).
    known : tuple of Arm
        What the robot knew of its actions against that swarm; empty if it does not learn about it.
    """

    row: dict[str, Any]
    known: tuple[Arm, ...]


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
            robot.number: robot.policy for robot in model.robots if isinstance(robot.policy, Learner)
        }
        self._bandits = {
            (number, opponent): Bandit(len(learner.actions))
            for number, learner in self._learners.items()
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
        return ConflictAccount(row, known)


def conflicts_of(run: Run) -> list[ConflictAccount]:
    """Play a run again and return its conflicts, those of learning included, by their start.

    Parameters
    ----------
    run : Run
        What is played.

    Raises
    ------
    RunError
        If the game fails.
    """
    with finished_game(run, "conflicts") as model:
        accounts = Accounts(model).take()
        return sorted(accounts, key=lambda account: (account.row["start"], account.row["robot"]))


TOLD: Final = (
    "t (s)",
    "who",
    "met",
    "where (m)",
    "known: Q (N)",
    "chose",
    "T(a)",
    "T(p)",
    "n′",
    "saw",
    "R",
    "Q after",
)
"""Headings of what `told` returns; times in seconds."""


def told(account: ConflictAccount, begin: float) -> list[str]:
    """Return a conflict as the cells of a table.

    Parameters
    ----------
    account : ConflictAccount
        The conflict.
    begin : float
        When the measured game began, from which its time is counted (s).
    """
    row, x, y = account.row, account.row["x"], account.row["y"]
    return [
        f"{row['start'] - begin:.1f}",
        f"{row['robot']} of S{row['swarm']}",
        f"{row['opponent']} of S{row['opponent_swarm']}",
        f"{x:z.2f}, {y:z.2f}",  # z: no −0.00
        ", ".join(f"{arm.action} {number(arm.q)} ({arm.n:.4g})" for arm in account.known) or "–",
        row["action"],
        f"{row['t_a']:.1f}",
        f"{row['t_p']:.1f}",
        str(row["active"]),
        ", ".join(f"{len(own)} of S{k}" for k, own in enumerate(row["seen"], 1) if own),
        number(row["reward"]),
        number(row["q"]),
    ]


def number(value: float) -> str:
    """Return a number with three decimals, a dash for none."""
    return "–" if math.isnan(value) else f"{value:z.3f}"
