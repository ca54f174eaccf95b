# win_stay.py
"""A policy that learns: win-stay, lose-shift."""

import math

from kswarms import Action, Purpose, Setting


class WinStay:
    """Keep an action against a swarm while enough program time follows it; the first action is random."""

    def __init__(self, setting: Setting, enough: float = 1.0) -> None:
        self.actions = setting.actions
        self.enough = enough
        rng = setting.streams.generator(Purpose.POLICY)
        self.arms = [int(rng.integers(len(self.actions))) for _ in range(setting.swarms)]
        self.opponent = -1

    def choose(self, opponent: int) -> Action:
        """Return the action against a robot of swarm `opponent`, counted from 0."""
        self.opponent = opponent
        return self.actions[self.arms[opponent]]

    def learn(self, t_a: float, t_p: float, n_active: int) -> tuple[float, float]:
        """Learn from the last conflict: seconds of its action, then of the program."""
        gain = t_p - self.enough * t_a
        if gain < 0.0:
            self.arms[self.opponent] = (self.arms[self.opponent] + 1) % len(self.actions)
        return gain, math.nan

    def freeze(self) -> None:
        """Stop learning; `learn` is not called after this."""
