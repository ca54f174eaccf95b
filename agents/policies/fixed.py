"""Policies that do not learn."""

from kswarms.agents.actions import AWAY, TOWARDS, Action
from kswarms.agents.policies.interface import Setting
from kswarms.agents.streams import Purpose


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


class RandomPolicy:
    """Flight within the own swarm; against others flight or fight with equal probability.

    Parameters
    ----------
    setting : Setting
        Where it plays.
    """

    def __init__(self, setting: Setting) -> None:
        self.swarm = setting.swarm
        self._within = setting.first(AWAY)
        self._against = (self._within, setting.first(TOWARDS))
        self._streams = setting.streams

    def choose(self, opponent: int) -> Action:
        """Return the action to take against a robot of swarm `opponent`."""
        if opponent == self.swarm:
            return self._within
        return self._against[self._streams.draws(Purpose.POLICY).random() < 0.5]

    def __repr__(self) -> str:
        return f"RandomPolicy(swarm={self.swarm})"
