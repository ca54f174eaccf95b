"""Utilities of a table of conflicts, computed by hand (section 1.3)."""

from typing import Any

import pandas as pd
import pytest

from kswarms.agents.common.errors import InputError
from kswarms.analysis.measures.utilities import Weights, robot_utilities, utilities_by_swarm

# Robots 0 and 1 are of S1, robot 2 of S2, for ten seconds. Their conflicts:
#   0 at 0 s: two seconds in A; it meets 2 and sees 1 as well.
#   2 at 1 s: three seconds in A; it meets 0, which stays in A for one more second.
#   1 at 6 s: three seconds in A; it meets 0.
ROWS = [
    {"robot": 0, "swarm": 1, "opponent": 2, "opponent_swarm": 2, "start": 0.0, "t_a": 2.0, "t_p": 8.0},
    {"robot": 2, "swarm": 2, "opponent": 0, "opponent_swarm": 1, "start": 1.0, "t_a": 3.0, "t_p": 6.0},
    {"robot": 1, "swarm": 1, "opponent": 0, "opponent_swarm": 1, "start": 6.0, "t_a": 3.0, "t_p": 1.0},
]
SEEN = [[[1], [2]], [[0], []], [[0], []]]


def table(**columns: Any) -> pd.DataFrame:
    return pd.DataFrame(ROWS).assign(**{"phase": "game", "seen": SEEN, **columns})


def measured(alpha: Weights = 1.0, beta: Weights = 1.0) -> list[tuple[float, ...]]:
    """Return u_1, u_2, U and W of each robot."""
    robots = robot_utilities(table(), alpha, beta)
    assert robots["robot"].tolist() == [0, 1, 2]
    assert robots["swarm"].tolist() == [1, 1, 2]
    assert robots["conflicts"].tolist() == [1, 1, 1]
    return [tuple(row) for row in robots[["u_1", "u_2", "utility", "wlu"]].to_numpy().tolist()]


def test_utilities_match_a_calculation_by_hand() -> None:
    # Conflict of 0, from 0 to 10 s: own 8 − 2 = 6; robot 1 has 3 s in A and 7 in P, robot 2 has 3 and 7.
    #   u_0^1 = 6, u_0^2 = 6 − 4 = 2, so u_2^1 = −2; W_0 = 3 · 6 − (3 + 3) + (2 · 3 + 3 − 7) = 14.
    # Conflict of 2, from 1 to 10 s: own 6 − 3 = 3; robot 0 has 1 s in A and 8 in P.
    #   u_2^1 = 3 − 7 = −4, so u_0^2 = 4; W_2 = 2 · 3 + (2 · 1 + 1 − 8) = 1.
    # Conflict of 1, from 6 to 10 s: own 1 − 3 = −2; robot 0 has 4 s in P. u_1^1 = −2 = W_1.
    assert measured() == [(6, 6, 12, 14), (-2, 0, -2, -2), (-6, 0, -6, 1)]


def test_swarm_utilities_match_a_calculation_by_hand() -> None:
    swarms = utilities_by_swarm(robot_utilities(table()))
    assert swarms.to_dict("list") == {"swarm": [1, 2], "utility": [10.0, -6.0], "sud": [16.0, -16.0]}


def test_weights_can_differ_by_swarm_and_opponent() -> None:
    # Conflict of 0, S1 against S2: own 3 · 8 − 2 · 2 = 20; robot 1 within S1: α = 2, β = 1; robot 2: 7 − 3.
    #   u_0^1 = 20, u_0^2 = 16; W_0 = 3 · 20 − (2 · 3 + 3) + (2 · 3 + 3 − 7) = 53.
    # Conflict of 2: own 3; robot 0: 3 · 8 − 2 · 1 = 22. u_2^1 = −19; W_2 = 2 · 3 + (2 · 2 + 3 − 24) = −11.
    # Conflict of 1, within S1: 1 − 2 · 3 = −5.
    alpha = {1: 2.0, 2: 1.0}
    beta = {(1, 1): 1.0, (1, 2): 3.0, (2, 1): 1.0, (2, 2): 7.0}
    assert measured(alpha, beta) == [(20, 35, 55, 53), (-5, 0, -5, -5), (-35, 0, -35, -11)]


def test_a_robot_that_was_only_seen_has_utilities() -> None:
    robots = robot_utilities(table().iloc[:1])
    # Robot 2 was in P for all ten seconds: u_0^2 = 6 − 10.
    assert robots[["robot", "conflicts", "u_1", "u_2", "wlu"]].to_numpy().tolist() == [
        [0, 1, 6, -4, 3 * 6 - 0 - 10],
        [1, 0, 0, 0, 0],
        [2, 0, 4, 0, 0],
    ]


def test_games_are_measured_separately_by_run() -> None:
    # The second game has three swarms; robot 1 belongs to S3 and does not notice.
    seen = [[[], [2], [1]], [[0], [], []]]
    second = pd.DataFrame(ROWS[:2]).assign(phase="game", seen=seen, run="b")
    robots = robot_utilities(pd.concat([second, table(run="a")], ignore_index=True))
    columns = ["run", "robot", "swarm", "conflicts", "u_1", "u_2", "u_3", "utility", "wlu"]
    assert list(robots.columns) == columns
    assert robots["run"].tolist() == ["b"] * 3 + ["a"] * 3
    # u_0^3 = 6 − 10; W_0 = 4 · 6 + 2 · 3 + 3 − 7 − 10.
    assert robots[["u_1", "u_2", "u_3", "wlu"]].to_numpy().tolist()[:3] == [
        [0, 6, -4, 16],
        [4, 0, 0, 0],
        [-6, 0, 0, 1],
    ]
    assert robots[["u_1", "u_2", "utility", "wlu"]].to_numpy().tolist()[3:] == [
        list(row) for row in measured()
    ]
    swarms = utilities_by_swarm(robots)
    assert swarms["run"].tolist() == ["b", "b", "b", "a", "a"]
    assert swarms["sud"].tolist() == [2 + 6 - 4, -6 - 2 - 4, 4 - 2 + 6, 16, -16]


def test_the_given_phase_is_measured() -> None:
    learning = table(phase="learning").assign(t_p=[3.0, 3.0, 3.0])
    both = pd.concat([learning, table()], ignore_index=True)
    assert robot_utilities(both).equals(robot_utilities(table()))
    assert robot_utilities(both, phase="learning").equals(robot_utilities(learning, phase="learning"))
    assert not robot_utilities(both, phase="learning").equals(robot_utilities(both))


@pytest.mark.parametrize(
    ("conflicts", "weights", "message"),
    [
        (table().drop(columns=["seen", "t_p"]), {}, r"=\['seen', 't_p'\]: must have these columns too"),
        (table(phase="learning"), {}, "phase='game': must be a phase with conflicts: learning"),
        (table().iloc[:0], {}, "conflicts: none"),
        (table(), {"alpha": 0.0}, "alpha of swarm 1 against 1=0.0: must be a number > 0"),
        (table(), {"beta": {1: 1.0}}, "beta of swarm 2 against 1=None: must be a number > 0"),
        (table(), {"beta": {1: 1.0, (2, 2): 1.0}}, "beta of swarm 2 against 1=None"),
        (table(), {"alpha": float("inf")}, "alpha of swarm 1 against 1=inf"),
        (table(seen=[[[1], [2]], [[0]], [[0], []]]), {}, "must have a list for each swarm"),
        (table(opponent_swarm=[2, 1, 3]), {}, "must have a list for each swarm"),
    ],
)  # fmt: skip
def test_invalid_conflicts_and_weights_are_refused(
    conflicts: pd.DataFrame, weights: Any, message: str
) -> None:
    with pytest.raises(InputError, match=message):
        robot_utilities(conflicts, **weights)
