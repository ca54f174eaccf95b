"""Rows of learned policies."""

import math
from typing import Any

import pytest

from kswarms.agents.actions import AWAY, TOWARDS, Action
from kswarms.model.description.game import Game, Swarm
from kswarms.model.game_model import GameModel
from kswarms.model.recorder import policy_rows


def play(*policies: str, seed: int = 0, size: int = 6, **fields: Any) -> GameModel:
    swarms = tuple(Swarm(policy=policy, size=size) for policy in policies)
    model = GameModel(Game(swarms=swarms, learning=120.0, duration=60.0, **fields), seed, "conflicts")
    model.play()
    return model


def test_a_swarm_alone_learns_among_four_actions() -> None:
    actions = (
        Action(name="flight", direction=AWAY, duration=1.8),
        Action(name="other-flight", direction=AWAY, duration=1.8),
        Action(name="fight", direction=TOWARDS, duration=1.0),
        Action(name="long-fight", direction=TOWARDS, duration=3.0),
    )
    model = play("learner(reward='single-swarm')", size=12, actions=actions)
    table = model.tables()["conflicts"]
    conflicts = [dict(zip(table, values, strict=True)) for values in zip(*table.values(), strict=True)]
    rows = [row for row in conflicts if row["phase"] == "learning"]
    assert {row["action"] for row in rows} == {action.name for action in actions}
    for row in rows:
        expected = row["active"] / 8 * (row["t_p"] - 3 * row["t_a"])
        assert row["reward"] == pytest.approx(expected, abs=1e-9) or math.isnan(row["reward"])
    shares = {row["action"]: row["share"] for row in policy_rows(model)}
    assert set(shares) == {action.name for action in actions}
    assert sum(shares.values()) == pytest.approx(1.0)


def test_policy_rows_have_the_shares_of_the_robots() -> None:
    model = play("avoid", "learner", "inter-learner+aggressive", seed=1)
    rows = {(row["swarm"], row["opponent"], row["action"]): row for row in policy_rows(model)}
    pairs = [(2, 1), (2, 2), (2, 3), (3, 1), (3, 2)]
    assert set(rows) == {(*pair, action) for pair in pairs for action in ("flight", "fight")}
    for (swarm, opponent, action), row in rows.items():
        policies = [robot.policy for robot in model.members[swarm - 1]]
        learners = [policy for policy in policies if opponent - 1 in getattr(policy, "bandits", {})]
        assert len(learners) == {2: 6, 3: 3}[swarm]
        chosen = [policy.learned_action(opponent - 1).name for policy in learners]
        assert row["share"] == chosen.count(action) / len(chosen)
        assert row["attack_share"] == rows[swarm, opponent, "fight"]["share"]
