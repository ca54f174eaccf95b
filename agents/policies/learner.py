"""The learner: a bandit for each swarm-ID that a robot can meet (section 1.5, Algorithm 1)."""

from math import isfinite, nan
from typing import Any, Final, Literal

from numpy.random import Generator

from kswarms.agents.actions import Action
from kswarms.agents.common.errors import InputError
from kswarms.agents.learning.bandit import Bandit
from kswarms.agents.learning.rewards import Reward, make_reward
from kswarms.agents.learning.selection_rules import make_rule
from kswarms.agents.policies.interface import Setting
from kswarms.agents.policies.saved import flight
from kswarms.agents.streams import Purpose

_NOTHING: Final = (nan, nan)
"""Reward and value of a conflict that nothing is learned from."""


class Learner:
    """Learns which action to take against which swarm, and takes a fixed one against the others.

    Parameters
    ----------
    setting : Setting
        Where it plays.
    about : {'inter', 'intra', 'both'}
        Whether it learns about other swarms, its own, or both.
    reward, rule : str
        As `make_reward` and `make_rule` take them.
    otherwise : str
        Name of the action against the swarms that it does not learn about; by default the first that
        drives away.

    Attributes
    ----------
    rule : Rule
        How an arm is chosen while it learns.
    bandits : dict of int to Bandit
        What it knows about each swarm (counted from 0) that it learns about.
    learning : bool
        Whether it still learns; afterwards it takes what it learned, without exploration.

    Raises
    ------
    InputError
        If an argument is not allowed.
    """

    def __init__(
        self,
        setting: Setting,
        about: Literal["inter", "intra", "both"] = "both",
        reward: str = "wlu",
        rule: str = "ucb",
        otherwise: str = "",
    ) -> None:
        if about not in ("inter", "intra", "both"):
            raise InputError("about", about, "must be inter, intra or both")
        self.swarm = setting.swarm
        self.actions = setting.actions
        self._flight = self._otherwise = flight(setting.actions)
        if otherwise != "":
            by_name = {action.name: action for action in self.actions}
            if not isinstance(otherwise, str) or otherwise not in by_name:
                raise InputError("otherwise", otherwise, f"must be one of {', '.join(by_name)}")
            self._otherwise = by_name[otherwise]
        self._reward = make_reward(reward)
        for opponent in sorted(self._reward.opponents()):
            if not 1 <= opponent <= setting.swarms:
                raise InputError("reward", reward, f"names swarm {opponent}, the game has {setting.swarms}")
        self.rule = make_rule(rule, len(self.actions))
        self._factor = self.rule.factor
        self.bandits = {
            swarm: Bandit(len(self.actions))
            for swarm in range(setting.swarms)
            if about == "both" or (swarm == self.swarm) == (about == "intra")
        }
        if not self.bandits:
            raise InputError("about", about, "needs another swarm to learn about")
        for opponent in sorted(self._reward.opponents()):
            if opponent - 1 not in self.bandits:
                raise InputError("reward", reward, f"names swarm {opponent}, which it learns nothing about")
        self.learning = True
        self._draws = setting.streams.draws
        self._explore: Generator | None = None
        """The stream that it draws from, once it did."""
        self._opponent = -1
        self._arm = -1

    @property
    def reward(self) -> Reward:
        """What it is rewarded by."""
        return self._reward

    def choose(self, opponent: int) -> Action:
        """Return the action to take against a robot of swarm `opponent` (Eq. 4.16 while learning)."""
        self._opponent = opponent
        bandit = self.bandits.get(opponent)
        if bandit is None:
            return self._otherwise
        if not self.learning:
            return self.learned(opponent)
        draws = self._explore
        if draws is None:
            draws = self._explore = self._draws(Purpose.EXPLORE)
        self._arm = self.rule.choose(bandit, draws)
        if not 0 <= self._arm < len(self.actions):
            raise InputError("rule", self._arm, f"must choose 0 to {len(self.actions) - 1}")
        bandit.choices += 1
        return self.actions[self._arm]

    def learn(self, t_a: float, t_p: float, n_active: int) -> tuple[float, float]:
        """Close the conflict chosen for last, and reward its arm.

        Parameters
        ----------
        t_a, t_p, n_active
            As in `kswarms.agents.policies.interface.LearningPolicy.learn`.

        Returns
        -------
        reward, value : float
            R of the conflict (s) and Q of its arm after it; NaN if nothing is learned of that swarm.
        """
        opponent, arm = self._opponent, self._arm
        bandit = self.bandits.get(opponent)
        if bandit is None or not self.learning:
            return _NOTHING
        reward = self._reward.of(
            t_a, t_p, n_active, self.actions[arm].direction, opponent != self.swarm, opponent + 1
        )
        if not isfinite(reward):
            raise InputError("reward", reward, f"must be finite, also for T(a)={t_a:g}, T(p)={t_p:g}")
        bandit.update(arm, reward, t_a + t_p, self._factor)
        return reward, bandit.value(arm)

    def learned(self, opponent: int) -> Action:
        """Return argmax Q for a swarm learned about; flight where nothing is known."""
        best = self.bandits[opponent].best()
        return self._flight if best is None else self.actions[best]

    def freeze(self) -> None:
        """Stop learning."""
        self.learning = False

    def snapshot(self) -> list[dict[str, Any]]:
        """Return what is known: for each arm the opponent's swarm (from 1), action, Σ R, Σ T, N and Q."""
        return [
            {
                "opponent": swarm + 1,
                "action": action.name,
                "reward": bandit.reward[arm],
                "time": bandit.time[arm],
                "count": bandit.count[arm],
                "q": bandit.value(arm),
            }
            for swarm, bandit in self.bandits.items()
            for arm, action in enumerate(self.actions)
        ]

    def __repr__(self) -> str:
        return f"Learner(swarm={self.swarm}, reward={self._reward!r}, rule={self.rule!r}, {self.bandits})"
