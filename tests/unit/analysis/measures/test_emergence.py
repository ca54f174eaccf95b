"""Choices, values and preferences of learners with known answers."""

import pytest

from kswarms.agents.common.errors import InputError
from kswarms.analysis.measures.emergence import arm_values, choices, learning_conflicts, preferences
from tests.helpers.result_rows import MET, robots
from tests.helpers.result_rows import learning_conflicts as rows_of_learners

LEARNING = rows_of_learners()


def test_only_conflicts_decided_by_bandits_in_the_learning_phase_count() -> None:
    rows = learning_conflicts(LEARNING)
    assert len(rows) == 40
    assert set(zip(rows["swarm"], rows["opponent_swarm"], strict=True)) == {(2, 1)}
    for other in (MET, LEARNING.assign(phase="game"), LEARNING.assign(q=float("nan"))):
        with pytest.raises(InputError, match="must be of the learning phase of a game with a learner"):
            learning_conflicts(other)


def test_choices_are_shares_by_swarm_or_by_robot() -> None:
    swarm = choices(LEARNING)
    fights = swarm[swarm["action"] == "fight"]
    assert fights[fights["time"] < 9.5]["share"].tolist() == [0.0] * 10
    assert fights[fights["time"] > 9.5]["share"].tolist() == pytest.approx([0.5] * 10)
    by_robot = choices(LEARNING, by=["robot"])
    last = by_robot[(by_robot["action"] == "fight") & (by_robot["time"] > 18)]
    assert last.set_index("robot")["share"].to_dict() == {2: 1.0, 3: 0.0}


def test_q_is_the_latest_value_and_missing_before_the_first_trial() -> None:
    q = arm_values(LEARNING)
    fight = q[(q["robot"] == 2) & (q["action"] == "fight")].sort_values("time")
    assert fight["time"].min() > 9
    assert fight["q"].iloc[-1] == pytest.approx(1.9)
    flight = q[(q["robot"] == 2) & (q["action"] == "flight")]
    assert set(flight["q"]) == {0.1}  # kept after its last choice
    assert flight["time"].max() == fight["time"].max()


def test_preferences_leave_out_untried_arms() -> None:
    rows = preferences(robots())
    assert rows[["robot", "action", "q", "learned"]].to_numpy().tolist() == [
        [2, "flight", 0.1, False],
        [2, "fight", 0.2, True],
        [3, "flight", 0.3, True],
    ]
    assert len(preferences(robots(("a", "b")))) == 6
    untried = [{"opponent": 1, "action": "fight", "reward": 0.0, "time": 0.0, "count": 0.0, "q": None}]
    for other in (robots()[:1], robots()[:1].assign(arms=[untried])):
        with pytest.raises(InputError, match="must be of a game with a learner"):
            preferences(other)
