"""Fixed policies: which action against which swarm (specification, section 2.4).

A policy is asked once for each conflict, with what the robot knows of the other: its swarm-ID.
"""

from collections.abc import Mapping, Sequence
from typing import Final, Protocol

from agents.actions import AWAY, TOWARDS, Action
from agents.errors import InputError


class Policy(Protocol):
    """What a robot needs to be told at a conflict."""

    def choose(self, opponent: int) -> Action:
        """Return the action to take against a robot of swarm `opponent` (counted from 0)."""
        ...


class FixedPolicy:
    """The same action whenever a robot of the same kind (own swarm, other swarm) is met.

    Parameters
    ----------
    swarm : int
        Own swarm, counted from 0.
    within : Action
        Action within the own swarm.
    against : Action
        Action against every other swarm.
    """

    def __init__(self, swarm: int, within: Action, against: Action) -> None:
        self.swarm = swarm
        self.within = within
        self.against = against

    def choose(self, opponent: int) -> Action:
        """Return the action to take against a robot of swarm `opponent`."""
        return self.within if opponent == self.swarm else self.against

    def __repr__(self) -> str:
        return f"FixedPolicy(swarm={self.swarm}, within={self.within.name!r}, against={self.against.name!r})"


# Directions within the own swarm and against others; the action is the set's first of its direction.
_FIXED: Final = {"avoid": (AWAY, AWAY), "attack": (AWAY, TOWARDS), "aggressive": (TOWARDS, TOWARDS)}

_ALIASES: Final = {"mixed": "avoid+aggressive"}


def make_policy(name: str, swarm: int, actions: Sequence[Action]) -> Policy:
    """Build the policy of one robot.

    Parameters
    ----------
    name : str
        ``avoid``, ``attack``, ``aggressive``, or the name of an action, which is then always taken.
    swarm : int
        Swarm of the robot, counted from 0.
    actions : sequence of Action
        The actions of the game.

    Raises
    ------
    InputError
        If there is no such policy, or no action of a direction that it needs.
    """
    by_name: Mapping[str, Action] = {action.name: action for action in actions}
    if name in by_name:
        return FixedPolicy(swarm, by_name[name], by_name[name])
    if name not in _FIXED:
        known = ", ".join([*_FIXED, *_ALIASES, *by_name])
        raise InputError("policy", name, f"must be one of {known}, or several joined by '+'")
    within, against = (
        next((action for action in actions if action.direction == direction), None)
        for direction in _FIXED[name]
    )
    if within is None or against is None:
        raise InputError("policy", name, f"needs actions in both directions, there are {', '.join(by_name)}")
    return FixedPolicy(swarm, within, against)


def deal(policy: str, size: int) -> list[str]:
    """Deal the policies of a swarm out to its robots.

    Parameters
    ----------
    policy : str
        Name of a policy for all, or names joined by ``+``: equal shares in that order, the robots
        that are left over going to the first. ``mixed`` is ``avoid+aggressive``.
    size : int
        Robots in the swarm.

    Returns
    -------
    list of str, length `size`
        Name of each robot's policy.

    Examples
    --------
    >>> deal("mixed", 5)
    ['avoid', 'avoid', 'avoid', 'aggressive', 'aggressive']
    """
    names = _ALIASES.get(policy, policy).split("+")
    share, extra = divmod(size, len(names))
    return [name for k, name in enumerate(names) for _ in range(share + (k < extra))]
