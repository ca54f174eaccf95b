"""User-defined policies, rewards and rules: valid ones and faulty ones."""

import math

import numpy as np

from kswarms.agents.actions import AWAY, TOWARDS
from kswarms.agents.learning.rewards import Reward
from kswarms.agents.learning.selection_rules import Rule
from kswarms.agents.policies.learner import Learner

NUMBER = 3


class Cautious:
    def __init__(self, setting, patience=3, *, mood="calm"):
        self.swarm, self.patience = setting.swarm, patience
        self.flight, self.fight = setting.first(AWAY), setting.first(TOWARDS)
        self.met = 0

    def choose(self, opponent):
        self.met += 1
        return self.fight if self.met > self.patience else self.flight


class Needy(Cautious):
    def __init__(self, setting, patience):
        super().__init__(setting, patience)


class Anything(Cautious):
    def __init__(self, setting, **rest):
        super().__init__(setting)
        self.rest = rest


class Alone:
    def choose(self, opponent):
        return None


class NoPolicy:
    def __init__(self, setting):
        pass


class Endless(Cautious):
    def learn(self, t_a, t_p, n_active):
        return 0.0, 0.0


class Frozen(Endless):
    def freeze(self):
        pass


class Silent(Frozen):
    def learn(self, t_a, t_p, n_active):
        pass


class Boastful(Frozen):
    def snapshot(self):
        return [{"opponent": 1, "action": "flight"}]


class Stuck(Frozen):
    def freeze(self):
        raise RuntimeError("cannot\nstop")


class Wordy(Cautious):
    def choose(self, opponent):
        return "fight"


class Broken(Cautious):
    def choose(self, opponent):
        return self.fights


class Fussy(Cautious):
    def __init__(self, setting, patience=3):
        super().__init__(setting, patience)
        math.sqrt(-patience)


class Library(Cautious):
    def choose(self, opponent):
        return np.concatenate([])


class Tally(Frozen):
    """Counts its actions and has a snapshot."""

    def __init__(self, setting):
        super().__init__(setting)
        self.count = [0, 0]

    def choose(self, opponent):
        self.met += 1
        return (self.flight, self.fight)[self.met % 2]

    def learn(self, t_a, t_p, n_active):
        self.count[self.met % 2] += 1
        return 1.0, 1.0

    def snapshot(self):
        names = (self.flight.name, self.fight.name)
        return [
            {"opponent": 1, "action": name, "reward": q * n, "time": float(n), "count": n, "q": q}
            for name, n, q in zip(names, self.count, (1.0, 2.0), strict=True)
        ]


class Subclass(Learner):
    def __init__(self, setting, reward="wlu"):
        super().__init__(setting, about="inter", reward=reward)


class Flat(Reward):
    level: float = 1.0

    def of(self, t_a, t_p, n_active, direction, inter, opponent):
        return self.level * t_p


class Void(Reward):
    pass


class NaN(Flat):
    def of(self, *conflict):
        return math.nan


class Nothing(Flat):
    def of(self, *conflict):
        pass


class Zero(Flat):
    def of(self, t_a, t_p, *rest):
        return t_a / t_p


class Needing(Flat):
    gain: float


class First(Rule):
    arm: int = 0

    def prefer(self, bandit, rng):
        return np.int64(self.arm)


class Greater(First):
    @property
    def factor(self):
        return 2.0


class Lost(First):
    def prefer(self, bandit, rng):
        return bandit.counts
