"""The learning phase and the measured game share one world (specification, section 3.1)."""

import json
import math
from contextlib import suppress
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from simpy.core import StopSimulation

from kswarms.agents.actions import AWAY, Action
from kswarms.agents.policies.saved import snapshot_of
from kswarms.agents.robot.state import ACTION
from kswarms.model.description.game import Game
from kswarms.model.description.presets import PRESETS
from kswarms.model.game_model import GameModel
from tests.games import check_times_and_pucks, conflicts_of, make_game, play, play_learning_phase

LEARNING, MEASURED = 120.0, 60.0
SWITCH = 1200
"""Control periods of learning."""
ONE_AND_THE_SAME = (
    Action(name="flight", direction=AWAY, duration=1.8),
    Action(name="other-flight", direction=AWAY, duration=1.8),
)
"""Two actions with the same effect."""


def game(*policies: str, **fields: Any) -> Game:
    return make_game(*policies, **{"learning": LEARNING, "duration": MEASURED, **fields})


def world(model: GameModel) -> bytes:
    """Return the state of the world: bodies, actions, carried pucks, supplies."""
    positions = model.space.agent_positions.tobytes()
    return positions + np.array(model.states.bodies).tobytes() + json.dumps(model.supply).encode()


# The measured game continues the world.


@pytest.mark.parametrize("policies", ["avoid,attack", "aggressive,mixed"])
@pytest.mark.parametrize("preempt", [False, True])
def test_the_switch_changes_nothing_in_the_world(policies: str, preempt: bool) -> None:
    """Without learners, two phases equal one game of their total length."""
    rest = {"supply": 9, "parameters": PRESETS["fitted"].replace(preempt=preempt)}
    phased = play_learning_phase(game(*policies.split(","), **rest))
    rest |= {"duration": LEARNING + MEASURED, "sample_period": LEARNING}
    whole = GameModel(game(*policies.split(","), learning=0.0, **rest), 0)
    whole.step()
    assert world(phased) == world(whole)
    # Actions and transports are under way, which a restart would interrupt.
    assert ACTION in phased.states.phase.tolist()
    assert phased.carried_at_start == sum(phased.states.carrying.tolist()) > 0
    assert 0 < sum(phased.supply) < 18
    before = (whole.pucks.copy(), whole.picked_up)
    for model in (phased, whole):
        model.play()
    assert world(phased) == world(whole)
    assert [a + b for a, b in zip(before[0], phased.pucks, strict=True)] == whole.pucks
    assert before[1] + phased.picked_up == whole.picked_up


def test_draws_of_a_learner_do_not_change_other_streams() -> None:
    for policy in (
        "learner(rule='uniform-random')",
        "learner(rule='periodic-random(every=2)')",
        "learner",
        "inter-learner(rule='greedy')",
    ):
        learners = play(game("avoid", policy, actions=ONE_AND_THE_SAME))
        fixed = play(game("avoid", "avoid", actions=ONE_AND_THE_SAME))
        actions = {row["action"] for row in conflicts_of(learners, "learning") if row["swarm"] == 2}
        assert actions == {"flight", "other-flight"}
        assert world(learners) == world(fixed)
        assert learners.pucks == fixed.pucks


def test_scores_times_and_conflicts_restart() -> None:
    model = play_learning_phase(game("avoid", "learner"))
    assert model.pucks == [0, 0]
    assert (model.picked_up, model.duration) == (0, 0.0)
    for row in model.results():
        counts = ("pucks", "sud", "t_a_intra", "t_a_inter", "t_p", "conflicts_intra", "conflicts_inter")
        assert [row[name] for name in counts] == [0] * 7
    for robot in model.robots:
        assert robot.times() == ([0, 0], 0)
        assert (robot.pucks, robot.conflicts) == (0, [0, 0])
    learned = conflicts_of(model, "learning")
    assert learned
    model.play()
    assert json.dumps(conflicts_of(model, "learning")) == json.dumps(learned)
    began = [sum(row["swarm"] == k for row in conflicts_of(model, "game")) for k in (1, 2)]
    assert [row["conflicts_intra"] + row["conflicts_inter"] for row in model.results()] == began


@pytest.mark.parametrize("policies", ["attack,learner", "avoid,inter-learner,aggressive", "learner"])
@pytest.mark.parametrize("end", [{}, {"puck_limit": 5, "duration": 600.0}, {"puck_limit": 500}])
def test_times_and_pucks_of_the_measured_game_add_up(policies: str, end: dict[str, Any]) -> None:
    check_times_and_pucks(play(game(*policies.split(","), **end)))


def test_a_running_action_is_split_at_the_switch() -> None:
    model = play_learning_phase(game("attack", "attack"))
    acting = [robot for robot in model.robots if robot.state == "A"]
    assert acting
    model.env.run(until=SWITCH + 1)
    continued = [robot for robot in acting if sum(robot.conflicts) == 0 and robot.state == "A"]
    assert continued
    for robot in continued:
        assert (sum(robot.times()[0]), robot.times()[1]) == (1, 0)


# Learned values.


@pytest.mark.parametrize("policy", ["learner", "inter-learner", "learner(rule='uniform-random')"])
def test_after_the_switch_nothing_is_learned_or_explored(policy: str) -> None:
    base = game("attack", policy)
    model = play_learning_phase(base)
    learned = repr([snapshot_of(robot.policy) for robot in model.robots])
    model.play()
    assert repr([snapshot_of(robot.policy) for robot in model.robots]) == learned
    played = [row for row in conflicts_of(model, "game") if row["swarm"] == 2]
    assert len(played) > 30
    assert all(math.isnan(row["reward"]) and math.isnan(row["q"]) for row in played)
    taken = set()
    for row in played:
        arms = snapshot_of(model.robots[row["robot"]].policy)
        arms = [arm for arm in arms if arm["opponent"] == row["opponent_swarm"] and arm["count"] > 0]
        best = max(arms, key=lambda arm: arm["q"])["action"] if arms else "flight"
        assert row["action"] == best
        taken.add((bool(arms), row["action"]))
    assert (True, "flight") in taken


def test_without_data_the_learned_action_is_flight() -> None:
    # No conflict is closed in such a short learning phase.
    model = play(game("attack", "learner", learning=0.1, actions=PRESETS["fitted"].actions()[::-1]))
    assert all(arm["count"] == 0 for robot in model.members[1] for arm in snapshot_of(robot.policy))
    actions = [row["action"] for row in conflicts_of(model, "game") if row["swarm"] == 2]
    assert len(actions) > 50
    assert set(actions) == {"flight"}


@pytest.mark.parametrize("seed", range(3))
def test_the_conflict_open_at_the_switch_gets_no_reward(seed: int) -> None:
    model = play(game("attack", "learner"), seed)
    learned = [row for row in conflicts_of(model, "learning") if row["swarm"] == 2]
    last = {row["robot"]: row for row in sorted(learned, key=lambda row: row["start"])}
    assert len(last) == 6
    for row in learned:
        is_open = row is last[row["robot"]]
        assert math.isnan(row["reward"]) == math.isnan(row["q"]) == is_open
        ends = row["start"] + row["t_a"] + row["t_p"]
        assert ends == pytest.approx(LEARNING) if is_open else ends < LEARNING - 0.05
    # The bandits do not count it.
    for robot in model.members[1]:
        rewarded = sum(row["robot"] == robot.index for row in learned) - 1
        assert sum(arm["count"] for arm in snapshot_of(robot.policy)) == rewarded


def test_the_first_conflict_of_the_measured_game_rewards_nothing() -> None:
    """The conflict that was open at the switch is already closed."""
    model = play(game("attack", "learner"))
    for robot in model.members[1]:
        rows = [row for phase in ("learning", "game") for row in conflicts_of(model, phase)]
        rows = sorted((row for row in rows if row["robot"] == robot.index), key=lambda row: row["start"])
        for row, following in pairwise(rows):
            ends = row["start"] + row["t_a"] + row["t_p"]
            if row["phase"] == following["phase"]:
                assert ends == pytest.approx(following["start"])
            else:
                assert ends == pytest.approx(LEARNING)
                assert following["start"] >= LEARNING


# Ends of the phases.


def test_simpy_events_end_both_phases() -> None:
    model = GameModel(game("attack", "learner"), 0, "conflicts")
    while model.phase == "learning":
        model.env.step()
    assert model.env.now == SWITCH
    assert sum(sum(robot.conflicts) for robot in model.robots) == 0  # the phase ends before all other events
    with suppress(StopSimulation):
        while True:
            model.env.step()
    assert (model.env.now, model.ended) == (SWITCH + 600, "time")


@pytest.mark.parametrize(
    ("learning", "period", "switch"), [(10.0, 0.1, 100), (9.97, 0.1, 100), (0.3, 0.1, 3), (10.0, 0.05, 200)]
)
def test_learning_takes_whole_periods(learning: float, period: float, switch: int) -> None:
    parameters = PRESETS["fitted"].replace(period=period)
    model = play(game("avoid", "learner", learning=learning, duration=1.0, parameters=parameters))
    assert model.env.now == switch + round(1 / period)
    assert (model.duration, model.ended) == (1.0, "time")


def test_a_puck_limit_counts_from_the_switch() -> None:
    limit = 4
    unlimited = play(game("avoid", "learner", learning=LEARNING, duration=600.0))
    deposited = play(game("avoid", "learner", learning=0.1, duration=LEARNING - 0.1))
    assert sum(deposited.pucks) > limit  # in the learning phase
    model = play(game("avoid", "learner", duration=600.0, puck_limit=limit))
    assert (sum(model.pucks), model.ended) == (limit, "pucks")
    assert SWITCH < model.env.now < unlimited.env.now
    capped = play(game("avoid", "learner", duration=5.0, puck_limit=limit))
    assert sum(capped.pucks) < limit
    assert (capped.ended, capped.duration) == ("cap", 5.0)


def test_samples_show_both_phases() -> None:
    model = play(game("avoid", "learner"), record="model")
    frame = model.datacollector.get_model_vars_dataframe()
    assert frame["time"].tolist() == [10.0 * k for k in range(19)]
    pucks = (frame["pucks_1"] + frame["pucks_2"]).tolist()
    assert pucks[11] > 0
    assert pucks[12] == 0
    for part in (pucks[:12], pucks[12:]):
        assert part == sorted(part)


def test_sampling_does_not_change_what_is_learned() -> None:
    base = game("attack", "learner", sample_period=0.7)
    seen = [play(base, 2, record) for record in ("", "model,agents,conflicts")]
    first, second = (repr([snapshot_of(robot.policy) for robot in model.robots]) for model in seen)
    assert first == second
    assert world(seen[0]) == world(seen[1])
    assert seen[0].results() == seen[1].results()
