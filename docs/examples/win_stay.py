# win_stay.py
"""A policy that learns: win-stay, lose-shift."""

import math

from kswarms.agents.actions import Action
from kswarms.agents.policies.interface import Setting
from kswarms.agents.streams import Purpose


class WinStay:
    """Keeps to an action against a swarm as long as it is followed by enough program time.

    Which action it begins with is random.
    """

    def __init__(self, setting: Setting, enough: float = 1.0) -> None:
        self.actions = setting.actions
        self.enough = enough
        draws = setting.streams.draws(Purpose.POLICY)
        self.arms = [int(draws.integers(len(self.actions))) for _ in range(setting.swarms)]
        self.met = -1

    def choose(self, opponent: int) -> Action:
        """Return what to do about a robot of swarm `opponent`, counted from 0."""
        self.met = opponent
        return self.actions[self.arms[opponent]]

    def learn(self, t_a: float, t_p: float, n_active: int) -> tuple[float, float]:
        """Take in how the last conflict ended: seconds of action, then of program."""
        won = t_p - self.enough * t_a
        if won < 0.0:
            self.arms[self.met] = (self.arms[self.met] + 1) % len(self.actions)
        return won, math.nan

    def freeze(self) -> None:
        """Stop learning: nothing to do, since nothing more is told after this."""
