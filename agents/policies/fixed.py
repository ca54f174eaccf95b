"""Policies that do not learn."""

from kswarms.agents.actions import AWAY, TOWARDS, Action
from kswarms.agents.policies.interface import Setting
from kswarms.agents.streams import Purpose


class FixedPolicy:
    """Take one action (`within`) in the own swarm, and one (`against`) against other swarms."""

    def __init__(self, setting: Setting, within: Action, against: Action) -> None:
        self.swarm = setting.swarm
        self.within = within
        self.against = against

    def choose(self, opponent: int) -> Action:
        """Return the action against a robot of swarm `opponent` (from 0)."""
        return self.within if opponent == self.swarm else self.against

    def __repr__(self) -> str:
        name = type(self).__name__
        return f"{name}(swarm={self.swarm}, within={self.within.name!r}, against={self.against.name!r})"


class Avoid(FixedPolicy):
    """Flight from every robot."""

    def __init__(self, setting: Setting) -> None:
        super().__init__(setting, within=setting.first(AWAY), against=setting.first(AWAY))


class Attack(FixedPolicy):
    """Flight within the own swarm, fight against others."""

    def __init__(self, setting: Setting) -> None:
        super().__init__(setting, within=setting.first(AWAY), against=setting.first(TOWARDS))


class Aggressive(FixedPolicy):
    """Fight against every robot."""

    def __init__(self, setting: Setting) -> None:
        super().__init__(setting, within=setting.first(TOWARDS), against=setting.first(TOWARDS))


class RandomPolicy:
    """Flight within the own swarm, flight or fight with equal probability against others."""

    def __init__(self, setting: Setting) -> None:
        self.swarm = setting.swarm
        self._within = setting.first(AWAY)
        self._against = (self._within, setting.first(TOWARDS))
        self._streams = setting.streams

    def choose(self, opponent: int) -> Action:
        """Return the action against a robot of swarm `opponent` (from 0)."""
        if opponent == self.swarm:
            return self._within
        return self._against[self._streams.generator(Purpose.POLICY).random() < 0.5]

    def __repr__(self) -> str:
        return f"RandomPolicy(swarm={self.swarm})"
