"""Actions of a robot in a conflict (section 2.3)."""

from typing import Literal

from pydantic import Field

from kswarms.agents.common.descriptions import FrozenModel
from kswarms.agents.common.limits import LONGEST_NAME, LONGEST_TIME, SHORTEST_TIME

AWAY: Literal[-1] = -1
TOWARDS: Literal[1] = 1


class Action(FrozenModel):
    """A way to resolve a conflict: turn, then drive forward.

    Attributes
    ----------
    name : str
        Name of the action: letters, digits, ``_``, ``.`` and ``-``.
    direction : {-1, 1}
        d of Eq. 5.5: +1 turns towards the other robot (fight), −1 towards the most vacant direction (flight).
    duration : float
        Duration of the drive after the turn (s).
    """

    name: str = Field(pattern=r"^[\w.-]+$", max_length=LONGEST_NAME)
    direction: Literal[-1, 1]
    duration: float = Field(ge=SHORTEST_TIME, le=LONGEST_TIME)
