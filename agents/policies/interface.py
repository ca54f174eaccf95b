"""Interface of policies (specification, section 2.4).

A policy chooses an action at each conflict from the opponent's swarm-ID. A learning policy also receives the
outcome of each conflict. A user-defined policy is a class with the methods of `Policy`, and those of
`LearningPolicy` if it learns; it needs no base class.
"""

from collections.abc import Sequence
from typing import NamedTuple, Protocol

from kswarms.agents.actions import Action
from kswarms.agents.common.errors import InputError
from kswarms.agents.learning.selection_rules import GAMMA
from kswarms.agents.streams import Streams


class Setting(NamedTuple):
    """The robot and the game that a policy is built for.

    Attributes
    ----------
    swarm : int
        Swarm of the robot, from 0.
    swarms : int
        Number of swarms.
    actions : sequence of Action
        The actions of the game.
    streams : Streams
        The robot's random streams.
    place : int
        Number of the robot within its swarm, from 0.
    gamma : float
        γ of `UCB` for rules without their own.
    """

    swarm: int
    swarms: int
    actions: Sequence[Action]
    streams: Streams
    place: int = 0
    gamma: float = GAMMA

    def first(self, direction: int) -> Action:
        """Return the first action of a direction, `AWAY` or `TOWARDS`.

        Raises
        ------
        InputError
            If there is none.
        """
        for action in self.actions:
            if action.direction == direction:
                return action
        names = [action.name for action in self.actions]
        raise InputError("actions", names, f"must have one of direction {direction:+d} for this policy")


class Policy(Protocol):
    """Chooses the action at a conflict.

    A policy class is called with a `Setting` and the keyword arguments of the policy's text.
    """

    def choose(self, opponent: int) -> Action:
        """Return the action against a robot of swarm `opponent` (from 0), one of the setting's actions."""
        ...


class LearningPolicy(Policy, Protocol):
    """A policy that learns from the outcomes of its conflicts until the measured game begins.

    Without a learning phase it learns throughout the measured game. With an additional method ``snapshot``
    like that of `Learner`, its learned values are recorded and can be saved.
    """

    def learn(self, t_a: float, t_p: float, n_active: int) -> tuple[float, float]:
        """Report the outcome of the latest conflict.

        Parameters
        ----------
        t_a, t_p : float
            T(a) and T(p) (s).
        n_active : int
            n'_i, number of active sensors at the start of the conflict.

        Returns
        -------
        reward, value : float
            Reward of the conflict (s) and Q of its action after it; NaN if there is none. They are recorded.
        """
        ...

    def freeze(self) -> None:
        """Stop learning: choose the learned actions, without exploration."""
        ...
