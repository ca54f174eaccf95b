"""Conflicts of a run, with the knowledge that follows from earlier rewards."""

import math
from itertools import pairwise

import pytest

from kswarms.agents.policies.learner import Learner
from kswarms.model.description.game import Game, Swarm
from kswarms.model.game_model import GameModel
from kswarms.scenarios.runs.run import Run, digest
from kswarms.scenarios.watch.conflicts import (
    ConflictReader,
    WatchedConflict,
    arms_of,
    conflict_cells,
    conflicts_of,
    format_number,
)


def _run(policy: str, seed: int = 0, learning: float = 300.0, absent: tuple[int, ...] = ()) -> Run:
    swarms = (Swarm(policy="attack", size=5), Swarm(policy=policy, size=5))
    game = Game(swarms=swarms, learning=learning, duration=120.0, absent=absent)
    return Run(digest(game, seed), game, seed, (("mine", ""),))


@pytest.mark.parametrize("rule", ["ucb", "discounted-ucb(discount=0.9)", "greedy"])
def test_knowledge_of_the_latest_conflicts_equals_the_bandits_of_the_robots(rule: str) -> None:
    # Robot 0 is absent, so the rows of the others differ from their numbers.
    run = _run(f"inter-learner(rule='{rule}')", absent=(0,))
    model = GameModel(run.game, seed=run.seed, record="conflicts")
    model.play()
    conflicts = conflicts_of(run)
    for robot in model.members[1]:
        assert isinstance(robot.policy, Learner)
        own = [a for a in conflicts if a.row["robot"] == robot.number and a.row["opponent_swarm"] == 1]
        last = [a for a in own if a.row["phase"] == "game"]
        recorded, known = last[-1].known, arms_of(robot.policy, robot.policy.bandits[0])
        for then, now in zip(recorded, known, strict=True):
            assert then.action == now.action
            assert (then.n, then.q, then.bound) == pytest.approx((now.n, now.q, now.bound), nan_ok=True)


@pytest.fixture(scope="module")
def conflicts() -> list[WatchedConflict]:
    return conflicts_of(_run("inter-learner"))


def test_a_conflict_changes_the_knowledge_about_its_action_only(conflicts: list[WatchedConflict]) -> None:
    own = [a for a in conflicts if a.row["robot"] == 7 and a.row["opponent_swarm"] == 1]
    learned = [(a, b) for a, b in pairwise(own) if not math.isnan(a.row["reward"])]
    assert len(learned) > 10
    for earlier, later in learned:
        for before, after in zip(earlier.known, later.known, strict=True):
            if before.action == earlier.row["action"]:
                assert after.n == before.n + 1
                assert after.q == pytest.approx(earlier.row["q"])
            else:
                assert after[:3] == pytest.approx(before[:3], nan_ok=True)


def test_the_action_chosen_during_learning_has_the_greatest_bound(conflicts: list[WatchedConflict]) -> None:
    learning, game = (
        [a for a in conflicts if a.row["phase"] == phase and a.known] for phase in ("learning", "game")
    )
    compared = [a for a in learning if not math.isnan(a.known[0].bound)]
    assert len(compared) > 50
    for conflict in compared:
        bounds = {arm.action: arm.bound for arm in conflict.known}
        assert bounds[conflict.row["action"]] == pytest.approx(max(bounds.values()))
    for conflict in game:
        values = {arm.action: arm.q for arm in conflict.known if arm.n > 0}
        assert values[conflict.row["action"]] == pytest.approx(max(values.values()))


def test_robots_that_do_not_learn_know_nothing(conflicts: list[WatchedConflict]) -> None:
    assert all(a.known == () for a in conflicts if a.row["swarm"] == 1 or a.row["opponent_swarm"] == 2)
    assert [a.row["start"] for a in conflicts] == sorted(a.row["start"] for a in conflicts)
    assert {a.row["phase"] for a in conflicts} == {"learning", "game"}


def test_conflicts_are_read_once_and_removed_from_the_table() -> None:
    run = _run("inter-learner", learning=0.0)
    model = GameModel(run.game, seed=0, record="conflicts")
    reader = ConflictReader(model)
    model.step()
    first = list(reader.read())
    assert list(reader.read()) == []
    assert not any(model.datacollector.tables["conflicts"].values())
    while model.running:
        model.step()
    whole = sorted([*first, *reader.read()], key=lambda each: (each.row["start"], each.row["robot"]))
    again = [conflict_cells(conflict, 0.0) for conflict in conflicts_of(run)]
    assert [conflict_cells(conflict, 0.0) for conflict in whole] == again
    assert 0 < len(first) < len(whole)


def test_the_cells_of_a_conflict(conflicts: list[WatchedConflict]) -> None:
    conflict = next(a for a in conflicts if a.known and a.known[0].n > 0 and a.row["phase"] == "learning")
    cells = conflict_cells(conflict, 300.0)
    assert cells[0] == f"{conflict.row['start'] - 300:.1f}"
    assert cells[1] == f"{conflict.row['robot']} of S2"
    assert cells[4].startswith("flight ")
    assert cells[5] == conflict.row["action"]
    assert format_number(math.nan) == "–"
