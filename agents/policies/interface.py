"""What a policy is, and what it is built for (specification, section 2.4).

A policy is asked once for each conflict, with what the robot knows of the other: its swarm-ID. One that
learns is also told how each conflict ended. A policy of a user's own is a class with the methods of `Policy`,
and those of `LearningPolicy` if it learns; nothing has to be derived from.
"""

from collections.abc import Sequence
from typing import NamedTuple, Protocol

from kswarms.agents.actions import Action
from kswarms.agents.common.errors import InputError
from kswarms.agents.streams import Streams


class Setting(NamedTuple):
    """What a policy is built for.

    Attributes
    ----------
    swarm : int
        Swarm of the robot, counted from 0.
    swarms : int
        Number of swarms.
    actions : sequence of Action
        The actions of the game.
    streams : Streams
        The robot's streams.
    place : int
        Number of the robot within its swarm, from 0.
    """

    swarm: int
    swarms: int
    actions: Sequence[Action]
    streams: Streams
    place: int = 0

    def first(self, direction: int) -> Action:
        """Return the first action of a direction, `kswarms.agents.actions.AWAY` or `TOWARDS`.

        Raises
        ------
        InputError
            If the game has none.
        """
        for action in self.actions:
            if action.direction == direction:
                return action
        names = [action.name for action in self.actions]
        raise InputError("actions", names, f"must have one of direction {direction:+d} for this policy")


class Policy(Protocol):
    """What decides at a conflict.

    A class of a user's own is called with a `Setting` and the keyword arguments of the text that names it.
    """

    def choose(self, opponent: int) -> Action:
        """Return the action to take against a robot of swarm `opponent` (counted from 0)."""
        ...


class LearningPolicy(Policy, Protocol):
    """A policy that is told how its conflicts ended, until the measured game begins.

    Without a learning phase it is told throughout that game. If it also has a method ``snapshot``, which
    returns what `Learner.snapshot` does, then what it learned is recorded and can be saved.
    """

    def learn(self, t_a: float, t_p: float, n_active: int) -> tuple[float, float]:
        """Close the conflict chosen for last.

        Parameters
        ----------
        t_a, t_p : float
            T(a) and T(p) (s).
        n_active : int
            n'_i, sensors that were active when it began.

        Returns
        -------
        reward, value : float
            What the conflict was worth (s) and Q of the action after it, for the record; NaN for none.
        """
        ...

    def freeze(self) -> None:
        """Stop learning: from now on choose what was learned, without exploration."""
        ...
