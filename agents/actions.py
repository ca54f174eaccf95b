"""What a robot can do about a robot ahead of it: the open set of actions (section 2.3)."""

from typing import Final, Literal

from pydantic import Field

from kswarms.agents.common.descriptions import Checked

AWAY: Literal[-1] = -1
TOWARDS: Literal[1] = 1

LONGEST: Final = 1e9
"""No action lasts longer, nor a leg of the wandering on average, nor a sampling period (s): 30 years."""


class Action(Checked):
    """A way to resolve a conflict: turn, then drive forward.

    Attributes
    ----------
    name : str
        Name by which policies ask for it: letters, digits, ``_``, ``.`` and ``-``.
    direction : {-1, 1}
        d of Eq. 5.5: +1 turns towards the other robot (fight), −1 towards the most vacant
        direction (flight).
    duration : float
        How long the robot drives after the turn (s).
    """

    name: str = Field(pattern=r"^[\w.-]+$")
    direction: Literal[-1, 1]
    duration: float = Field(gt=0, le=LONGEST)
