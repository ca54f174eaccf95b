# cautious.py
"""A policy that flees several times, then fights once."""

from kswarms import AWAY, TOWARDS, Action, Setting


class Cautious:
    """Against other swarms, flee `patience` times, then fight once; repeat."""

    def __init__(self, setting: Setting, patience: int = 3) -> None:
        self.swarm = setting.swarm
        self.patience = patience
        self.flight, self.fight = setting.first(AWAY), setting.first(TOWARDS)
        self.meetings = 0

    def choose(self, opponent: int) -> Action:
        """Return the action against a robot of swarm `opponent`, counted from 0."""
        if opponent == self.swarm:
            return self.flight
        self.meetings += 1
        return self.flight if self.meetings % (self.patience + 1) else self.fight
