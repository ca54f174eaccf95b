"""Record of a conflict."""

from typing import NamedTuple

from kswarms.agents.actions import Action


class Conflict(NamedTuple):
    """One conflict of a robot, from the start of its action to the start of the next; times in periods.

    `robot`, `opponent` and `seen` are numbers of robots. `seen` has the robots that the sensors read at the
    start, see `read_sensors`; n_k and n_m of section 1.3 count these robots by swarm.
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
