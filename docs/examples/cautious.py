# cautious.py
"""A policy: flee from other swarms, but for every so many meetings."""

from kswarms.agents.actions import AWAY, TOWARDS, Action
from kswarms.agents.policies.interface import Setting


class Cautious:
    """Flees `patience` times from a robot of another swarm, then fights once, and so on."""

    def __init__(self, setting: Setting, patience: int = 3) -> None:
        self.swarm = setting.swarm
        self.patience = patience
        self.flight, self.fight = setting.first(AWAY), setting.first(TOWARDS)
        self.meetings = 0

    def choose(self, opponent: int) -> Action:
        """Return what to do about a robot of swarm `opponent`, counted from 0."""
        if opponent == self.swarm:
            return self.flight
        self.meetings += 1
        return self.flight if self.meetings % (self.patience + 1) else self.fight
