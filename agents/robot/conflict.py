"""Record of a conflict."""

from typing import NamedTuple

from kswarms.agents.actions import Action


class Conflict(NamedTuple):
    """One conflict of a robot, from the start of its action to the start of the next; times in periods.

    Robots are rows of the state arrays. `seen` is the result of `sensed_robots`: its robots by swarm are
    n_k and n_m of section 1.3.
    """

    robot: int
    opponent: int
    start: int
    x: float
    y: float
    action: Action
    active: int
    seen: tuple[int, ...]
    t_a: int
    t_p: int
    reward: float
    value: float
