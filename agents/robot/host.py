"""What a robot sees of the model that it lives in; `kswarms.model.game_model.GameModel` is one."""

from collections.abc import Mapping
from typing import Protocol

import simpy
from mesa.experimental.continuous_space import ContinuousSpace

from kswarms.agents.robot.conflict import Conflict
from kswarms.agents.robot.controller import Habits
from kswarms.agents.robot.state import Fleet


class World(Protocol):
    """What a robot needs of the model it lives in."""

    env: simpy.Environment
    space: ContinuousSpace
    fleet: Fleet
    habits: Habits
    action_periods: Mapping[str, int]
    conflict_log: list[Conflict] | None
