"""The learner, conflict by conflict: which bandit learns, and the choices afterwards (Algorithm 1)."""

import math
from collections import Counter
from typing import Any, cast

import numpy as np
import pytest
from scipy.stats import chisquare

from kswarms.agents.actions import Action
from kswarms.agents.common.errors import InputError
from kswarms.agents.conformance.policies import TWO_ACTIONS, make_setting
from kswarms.agents.policies.learner import Learner
from kswarms.agents.policies.saved import snapshot_of
from kswarms.agents.policies.spec import make_policy

FLIGHT, FIGHT = TWO_ACTIONS


def learner(text: str = "learner", **fields: Any) -> Learner:
    policy = make_policy(text, make_setting(**fields))
    assert isinstance(policy, Learner)
    return policy


def teach(policy: Learner, opponent: int, rewards: dict[str, float], rounds: int = 40) -> None:
    """Play conflicts in which the program time depends on the action."""
    for _ in range(rounds):
        action = policy.choose(opponent)
        policy.learn(1.0, rewards[action.name], 0)


@pytest.mark.parametrize(
    ("text", "about"),
    [
        ("inter-learner", {0, 2}),
        ("intra-learner", {1}),
        ("learner", {0, 1, 2}),
        ("learner(about='both')", {0, 1, 2}),
        ("learner(about='intra')", {1}),
    ],
)
def test_there_is_a_bandit_for_each_swarm_learned_about(text: str, about: set[int]) -> None:
    policy = learner(text, swarm=1, swarms=3)
    assert set(policy.bandits) == about
    for opponent in {0, 1, 2} - about:
        assert policy.choose(opponent) == FLIGHT
        assert all(math.isnan(number) for number in policy.learn(1.0, 5.0, 8))
    assert all(bandit.choices == 0 for bandit in policy.bandits.values())


def test_the_fixed_action_against_other_swarms_is_an_argument() -> None:
    policy = learner("intra-learner(otherwise='fight')")
    assert {policy.choose(0) for _ in range(20)} == {FIGHT}
    assert make_policy("inter-learner", make_setting(actions=(FIGHT, FLIGHT))).choose(1) == FLIGHT


def test_a_conflict_rewards_the_arm_that_was_chosen_for_it() -> None:
    policy = learner("inter-learner(reward='wlu(delta=0.2)')")
    first = policy.choose(0)
    sign = {FIGHT: +1, FLIGHT: -1}
    # R = 6 ± 4/8 · 0.2 · 2, Q = R / (2 + 6)
    reward, value = policy.learn(2.0, 6.0, 4)
    assert reward == pytest.approx(6 + 0.2 * sign[first])
    assert value == pytest.approx((6 + 0.2 * sign[first]) / 8)
    second = policy.choose(0)
    assert {first, second} == {FLIGHT, FIGHT}
    # The other arm has a Q of its own: R = 0 ± 1/8 · 0.2 · 1, over 1 s.
    assert policy.learn(1.0, 0.0, 1) == pytest.approx((0.025 * sign[second], 0.025 * sign[second]))
    third = policy.choose(0)
    assert third == first  # 6/8 and more against 0.025, one try each
    reward, value = policy.learn(2.0, 0.0, 0)
    assert (reward, value) == pytest.approx((0.0, (6 + 0.2 * sign[first]) / 10))


def test_the_sign_of_the_reward_is_reversed_within_the_swarm() -> None:
    policy = learner("learner(reward='wlu(delta=0.5)')")
    rewards = {}
    for opponent in (0, 1):
        for _ in range(2):
            action = policy.choose(opponent)
            rewards[opponent, action.name] = policy.learn(2.0, 0.0, 8)[0]
    assert rewards == {(0, "fight"): 1.0, (0, "flight"): -1.0, (1, "fight"): -1.0, (1, "flight"): 1.0}


def test_rewards_count_opponents_from_one() -> None:
    policy = learner("inter-learner(reward='wlu(delta={1: 0.02, 3: 0.5}, b={3: 2.0})')", swarms=3)
    got = {}
    for opponent in (0, 2):
        for _ in range(2):
            action = policy.choose(opponent)
            got[opponent, action] = policy.learn(1.0, 10.0, 8)[0]
    assert got[0, FIGHT] == pytest.approx(10.02)
    assert got[0, FLIGHT] == pytest.approx(9.98)
    assert got[2, FIGHT] == pytest.approx(5.5)
    assert got[2, FLIGHT] == pytest.approx(4.5)


def test_bandits_of_different_swarms_are_independent() -> None:
    """N of Eq. 4.16 counts one bandit: with the other's 900 conflicts, ln N would explore more."""
    fresh, experienced = learner(), learner()
    for arm in (0, 1):
        for _ in range(450):
            experienced.bandits[1].update(arm, 3.0, 4.0)
    choices: list[list[str]] = []
    for policy in (fresh, experienced):
        choices.append([])
        for k in range(200):
            action = policy.choose(0)
            choices[-1].append(action.name)
            policy.learn(1.0 + k % 3, 5.0 if action == FLIGHT else 5.5, 4)
    assert choices[0] == choices[1]
    assert Counter(choices[0]).keys() == {"flight", "fight"}
    assert sum(experienced.bandits[1].count) == 900


def test_discounting_counts_the_conflicts_of_one_bandit() -> None:
    policy = learner("learner(rule='discounted-ucb(discount=0.5)')")
    for opponent in (0, 1, 1, 1, 0):
        policy.choose(opponent)
        policy.learn(1.0, 1.0, 0)
    assert sorted(policy.bandits[0].count) == [0.5, 1.0]
    assert sum(policy.bandits[1].count) == 1.75


def test_periodic_random_choices_count_one_bandit() -> None:
    policy = learner("learner(rule='periodic-random(every=4)')", seed=3)
    greedy = {0: FIGHT, 1: FLIGHT}
    seen: dict[int, list[Action]] = {0: [], 1: []}
    for k in range(400):
        opponent = int(k % 5 > 2)  # three conflicts with the one, then two with the other
        action = policy.choose(opponent)
        seen[opponent].append(action)
        policy.learn(1.0, 20.0 if action == greedy[opponent] else 1.0, 0)
    for opponent, actions in seen.items():
        others = [k for k, action in enumerate(actions, start=1) if action != greedy[opponent]]
        assert {k % 4 for k in others if k > 2} == {0}
        assert len(others) > len(actions) // 16


@pytest.mark.parametrize(
    ("rewards", "best"), [({"flight": 9.0, "fight": 3.0}, FLIGHT), ({"flight": 3.0, "fight": 9.0}, FIGHT)]
)
def test_a_frozen_learner_chooses_the_best_action_and_learns_nothing(
    rewards: dict[str, float], best: Action
) -> None:
    policy = learner("inter-learner(rule='uniform-random')")
    teach(policy, 0, rewards)
    policy.choose(0)  # the conflict that is open at the switch
    before = repr(policy.bandits)
    policy.freeze()
    for _ in range(50):
        assert policy.choose(0) == policy.learned_action(0) == best
        assert all(math.isnan(number) for number in policy.learn(1.0, 100.0, 8))
    assert repr(policy.bandits) == before


def test_a_frozen_learner_without_data_flees() -> None:
    for actions in ((FLIGHT, FIGHT), (FIGHT, FLIGHT)):
        policy = make_policy("learner", make_setting(actions=actions))
        assert isinstance(policy, Learner)
        policy.choose(0)  # chosen, but never closed: no data
        policy.freeze()
        assert policy.choose(0) == policy.choose(1) == FLIGHT


def test_a_snapshot_has_all_learned_values() -> None:
    policy = learner()
    teach(policy, 0, {"flight": 3.0, "fight": 1.0}, rounds=1)
    rows = policy.snapshot()
    arms = [(m, a) for m in (1, 2) for a in ("flight", "fight")]
    assert [(row["opponent"], row["action"]) for row in rows] == arms
    for row in rows:
        bandit, arm = policy.bandits[row["opponent"] - 1], ("flight", "fight").index(row["action"])
        sums = bandit.reward[arm], bandit.time[arm], bandit.count[arm]
        assert (row["reward"], row["time"], row["count"]) == sums
        assert row["q"] == bandit.value(arm) or (row["count"] == 0 and math.isnan(row["q"]))
    assert repr(snapshot_of(policy)) == repr(rows)
    assert snapshot_of(make_policy("avoid", make_setting())) == []


def test_the_random_policy_fights_others_half_of_the_time_and_its_own_swarm_never() -> None:
    policy = make_policy("random", make_setting(swarms=3))
    assert {policy.choose(1) for _ in range(100)} == {FLIGHT}
    counts = Counter((opponent, policy.choose(opponent).name) for _ in range(2000) for opponent in (0, 2))
    assert chisquare(list(counts.values())).pvalue > 1e-4
    assert len(counts) == 4


def test_an_inter_learner_needs_another_swarm() -> None:
    with pytest.raises(InputError, match=r"^policy.about='inter': needs another swarm"):
        make_policy("inter-learner", make_setting(swarm=0, swarms=1))
    assert set(learner(swarm=0, swarms=1).bandits) == {0}


def test_an_array_is_no_choice_of_swarms() -> None:
    with pytest.raises(InputError, match=r"^about=.*must be inter, intra or both"):
        Learner(make_setting(swarm=0, swarms=2), about=cast(Any, np.array(["inter", "intra"])))
