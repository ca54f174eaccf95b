"""The conflicts of a run, with the knowledge of each robot at the start of its conflict.

A game with a seed is deterministic, so a run is played again instead of being recorded.
"""

import math
from collections.abc import Iterator
from typing import Any, Final, NamedTuple

from kswarms.agents.learning.bandit import Bandit
from kswarms.agents.learning.selection_rules import FORGOTTEN, UCB
from kswarms.agents.policies.learner import Learner
from kswarms.model.game_model import GameModel
from kswarms.scenarios.runs.play import finished_game
from kswarms.scenarios.runs.run import Run


class Arm(NamedTuple):
    """Knowledge of a robot about an action against a swarm."""

    action: str
    n: float  # N(a), discounted if the rule discounts
    q: float  # Q(a) (Eq. 4.15), NaN if the action was never tried
    bound: float  # upper bound of Q(a) (Eq. 4.16), NaN if the rule is not UCB or an action was never tried


class WatchedConflict(NamedTuple):
    """A conflict, with the knowledge of its robot at its start.

    Attributes
    ----------
    row : dict of str to object
        The columns of ``conflicts.parquet`` without `run` (`kswarms.agents.common.columns`).
    known : tuple of Arm
        Knowledge about each action against the opponent's swarm; empty if the robot does not learn about it.
    """

    row: dict[str, Any]
    known: tuple[Arm, ...]


def arms_of(learner: Learner, bandit: Bandit) -> tuple[Arm, ...]:
    """Return the knowledge of a bandit about each action."""
    rule = learner.rule
    bounds = [math.nan] * len(bandit.count)
    if isinstance(rule, UCB) and min(bandit.count) >= FORGOTTEN:
        bounds = rule.bounds(bandit)
    return tuple(
        Arm(action.name, bandit.count[arm], bandit.value(arm), bounds[arm])
        for arm, action in enumerate(learner.actions)
    )


class ConflictReader:
    """Reads the recorded conflicts of a game and adds the knowledge of the robots.

    A robot reports its last conflict, learns from it, and only then chooses again. So its knowledge follows
    from the rewards recorded before.
    """

    def __init__(self, model: GameModel) -> None:
        self._table = model.datacollector.tables.get("conflicts", {})
        self._learners = {
            robot.number: robot.policy for robot in model.robots if isinstance(robot.policy, Learner)
        }
        self._bandits = {
            (number, opponent): Bandit(len(learner.actions))
            for number, learner in self._learners.items()
            for opponent in learner.bandits
        }

    def read(self) -> Iterator[WatchedConflict]:
        """Yield the new conflicts in the order in which they ended, and remove them from the table."""
        names = list(self._table)
        columns = [self._table[name].copy() for name in names]
        for column in self._table.values():
            column.clear()  # limits memory in long games
        for values in zip(*columns, strict=True):
            yield self._add_knowledge(dict(zip(names, values, strict=True)))

    def _add_knowledge(self, row: dict[str, Any]) -> WatchedConflict:
        robot = row["robot"]
        bandit = self._bandits.get((robot, row["opponent_swarm"] - 1))
        known: tuple[Arm, ...] = ()
        if bandit is not None:
            learner = self._learners[robot]
            known = arms_of(learner, bandit)
            if not math.isnan(row["reward"]):
                arm = [action.name for action in learner.actions].index(row["action"])
                bandit.update(arm, row["reward"], row["t_a"] + row["t_p"], learner.rule.factor)
        return WatchedConflict(row, known)


def conflicts_of(run: Run) -> list[WatchedConflict]:
    """Play a run and return its conflicts, learning included, sorted by start."""
    with finished_game(run, "conflicts") as model:
        found = ConflictReader(model).read()
        return sorted(found, key=lambda conflict: (conflict.row["start"], conflict.row["robot"]))


HEADINGS: Final = (
    "t (s)", "who", "met", "where (m)", "known: Q (N)", "chose", "T(a)", "T(p)", "n′", "saw", "R", "Q after"
)  # fmt: skip
"""Headings of the cells of `conflict_cells`; times in seconds."""


def conflict_cells(conflict: WatchedConflict, begin: float) -> list[str]:
    """Return a conflict as the cells of a table; printed times start at `begin` (s)."""
    row, x, y = conflict.row, conflict.row["x"], conflict.row["y"]
    return [
        f"{row['start'] - begin:.1f}",
        f"{row['robot']} of S{row['swarm']}",
        f"{row['opponent']} of S{row['opponent_swarm']}",
        f"{x:z.2f}, {y:z.2f}",  # z avoids −0.00
        ", ".join(f"{arm.action} {format_number(arm.q)} ({arm.n:.4g})" for arm in conflict.known) or "–",
        row["action"],
        f"{row['t_a']:.1f}",
        f"{row['t_p']:.1f}",
        str(row["active"]),
        ", ".join(f"{len(own)} of S{k}" for k, own in enumerate(row["seen"], 1) if own),
        format_number(row["reward"]),
        format_number(row["q"]),
    ]


def format_number(value: float) -> str:
    """Return a number with three decimals, a dash for NaN."""
    return "–" if math.isnan(value) else f"{value:z.3f}"
