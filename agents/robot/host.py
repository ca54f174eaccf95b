"""Interface of the model as robots use it; `GameModel` implements it."""

from collections.abc import Mapping, Sequence
from typing import Protocol

from mesa import Agent
from mesa.experimental.continuous_space import ContinuousSpace

from kswarms.agents.actions import Action
from kswarms.agents.robot.clock import Clock
from kswarms.agents.robot.conflict import Conflict
from kswarms.agents.robot.controller import Controller
from kswarms.agents.robot.state import RobotStates


class Host(Protocol):
    """The model that a robot belongs to."""

    env: Clock
    space: ContinuousSpace
    states: RobotStates
    controller: Controller
    actions: Sequence[Action]
    action_periods: Mapping[str, int]
    timed_actions: Mapping[int, tuple[bool, int]]
    conflict_log: list[Conflict] | None

    def remove(self, robot: Agent) -> None:
        """Remove a robot from the game."""
