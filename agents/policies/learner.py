"""The learner: one bandit for each opponent swarm (section 1.5, Algorithm 1)."""

from math import isfinite, nan
from typing import Any, Final, Literal

from numpy.random import Generator

from kswarms.agents.actions import Action
from kswarms.agents.common.errors import InputError, require_type
from kswarms.agents.learning.bandit import Bandit
from kswarms.agents.learning.rewards import Reward, make_reward
from kswarms.agents.learning.selection_rules import Rule, make_rule
from kswarms.agents.policies.interface import Setting
from kswarms.agents.policies.saved import default_action
from kswarms.agents.streams import Purpose
from kswarms.agents.user_code.loading import user_errors

LEARNER_DEFAULTS: Final = {"reward": "wlu", "rule": "ucb"}
_NOTHING: Final = (nan, nan)  # reward and value of a conflict that is not learned from


class Learner:
    """A policy that learns the best action against some or all swarms.

    Parameters
    ----------
    setting : Setting
        The robot and the game.
    about : {'inter', 'intra', 'both'}
        Learn about other swarms, the own swarm, or both.
    reward : str or Reward
        As in `make_reward`.
    rule : str or Rule
        As in `make_rule`.
    otherwise : str
        Name of the fixed action against the other swarms; by default the first flight.

    Attributes
    ----------
    reward : Reward
        The reward of a conflict.
    rule : Rule
        The selection rule while learning.
    bandits : dict of int to Bandit
        A bandit for each swarm (from 0) that is learned about.
    learning : bool
        Whether the policy still learns. Afterwards it takes the best action without exploration.

    Raises
    ------
    InputError
        If an argument is not allowed.
    """

    def __init__(
        self,
        setting: Setting,
        about: Literal["inter", "intra", "both"] = "both",
        reward: str | Reward = LEARNER_DEFAULTS["reward"],
        rule: str | Rule = LEARNER_DEFAULTS["rule"],
        otherwise: str = "",
    ) -> None:
        require_type("setting", setting, Setting, "must be a kswarms.Setting")
        if not isinstance(about, str) or about not in ("inter", "intra", "both"):
            raise InputError("about", about, "must be inter, intra or both")
        self.swarm = setting.swarm
        self.actions = setting.actions
        self._flight = self._otherwise = default_action(setting.actions)
        if otherwise != "":
            by_name = {action.name: action for action in self.actions}
            if not isinstance(otherwise, str) or otherwise not in by_name:
                raise InputError("otherwise", otherwise, f"must be one of {', '.join(by_name)}")
            self._otherwise = by_name[otherwise]
        self.reward = make_reward(reward)
        self.rule = make_rule(rule).in_game(setting.gamma)
        with user_errors("rule", type(self.rule).__qualname__, "factor"):
            self._factor = self.rule.factor
        self.bandits = {
            swarm: Bandit(len(self.actions))
            for swarm in range(setting.swarms)
            if about == "both" or (swarm == self.swarm) == (about == "intra")
        }
        if not self.bandits:
            raise InputError("about", about, "needs another swarm to learn about")
        for opponent in sorted(self.reward.opponents()):
            if not 1 <= opponent <= setting.swarms:
                raise InputError("reward", reward, f"names swarm {opponent}, the game has {setting.swarms}")
            if opponent - 1 not in self.bandits:
                raise InputError("reward", reward, f"names swarm {opponent}, which is not learned about")
        self.learning = True
        self._choose = self.rule.fast_choose()
        self._weights = {
            opponent: [
                self.reward.linear_weights(action.direction, opponent != self.swarm, opponent + 1)
                for action in self.actions
            ]
            for opponent in self.bandits
        }
        self._learned: dict[int, Action] = {}
        self._generator = setting.streams.generator
        self._rng: Generator | None = None  # stream for exploration, created on first use
        self._opponent = -1
        self._arm = -1

    def choose(self, opponent: int) -> Action:
        """Return the action against a robot of swarm `opponent` (Eq. 4.16 while learning)."""
        self._opponent = opponent
        bandit = self.bandits.get(opponent)
        if bandit is None:
            return self._otherwise
        if not self.learning:
            return self._learned.get(opponent) or self.learned_action(opponent)
        rng = self._rng
        if rng is None:
            rng = self._rng = self._generator(Purpose.EXPLORE)
        arm = self._arm = self._choose(bandit, rng)
        if not 0 <= arm < len(self.actions):
            raise InputError("rule", arm, f"must choose 0 to {len(self.actions) - 1}")
        bandit.choices += 1
        return self.actions[arm]

    def learn(self, t_a: float, t_p: float, n_active: int) -> tuple[float, float]:
        """Reward the arm of the latest conflict; return R (s) and the arm's Q, NaN if nothing is learned.

        Parameters are those of `LearningPolicy.learn`.
        """
        opponent, arm = self._opponent, self._arm
        bandit = self.bandits.get(opponent)
        if bandit is None or not self.learning:
            return _NOTHING
        weights = self._weights[opponent][arm]
        if weights is not None:
            of_program, of_action = weights
            reward = of_program * t_p + of_action[n_active] * t_a
        else:
            direction, inter = self.actions[arm].direction, opponent != self.swarm
            reward = self.reward.of(t_a, t_p, n_active, direction, inter, opponent + 1)
        if not isfinite(reward):
            raise InputError("reward", reward, f"must be finite, also for T(a)={t_a:g}, T(p)={t_p:g}")
        return reward, bandit.update(arm, reward, t_a + t_p, self._factor)

    def learned_action(self, opponent: int) -> Action:
        """Return the action with the greatest Q against a swarm; flight if no arm was tried."""
        best = self.bandits[opponent].best()
        return self._flight if best is None else self.actions[best]

    def freeze(self) -> None:
        """Stop learning."""
        self.learning = False
        self._learned = {swarm: self.learned_action(swarm) for swarm in self.bandits}

    def snapshot(self) -> list[dict[str, Any]]:
        """Return the learned values of each arm: opponent's swarm (from 1), action, Σ R, Σ T, N and Q."""
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
        return f"Learner(swarm={self.swarm}, reward={self.reward!r}, rule={self.rule!r}, {self.bandits})"
