"""Invariants of every game: bodies, times, pucks, ends (specification, chapter 2)."""

from typing import Any

import numpy as np
import pytest
from hypothesis import event, example, given, settings
from hypothesis import strategies as st
from scipy.spatial.distance import pdist

from kswarms.agents.actions import TOWARDS
from kswarms.agents.policies.interface import Setting
from kswarms.agents.policies.spec import make_policy
from kswarms.agents.robot.state import ACTION
from kswarms.agents.streams import Streams
from kswarms.model.description.game import Game, Swarm, apportion
from kswarms.model.description.presets import PRESETS
from kswarms.model.game_model import GameModel
from tests.games import check_times_and_pucks, make_game

ROUNDING = 1e-9
POLICIES = ("avoid", "attack", "aggressive", "mixed", "flight", "fight", "aggressive+avoid+attack")


@st.composite
def parameters(draw: st.DrawFn, period: float) -> dict[str, Any]:
    """Draw changes of the fitted parameters; some stations are large, so that short games have pucks."""
    return {
        "period": period,
        "preempt": draw(st.booleans()),
        "push_share": draw(st.sampled_from([0.0, 0.0, 0.5, 1.0])),
        "friction": draw(st.sampled_from([0.18, 0.0, 1.0])),
        "wall_escape": draw(st.sampled_from(["clear", "away"])),
        "wall_half_angle": draw(st.sampled_from([0.0, 0.785])),
        "flight_duration": draw(st.sampled_from([1.8, 0.05, 0.33])),
        "station_radius": draw(st.sampled_from([0.16, 0.3])),
    }


@st.composite
def games(draw: st.DrawFn, swarms: st.SearchStrategy[int] = st.integers(1, 5)) -> Game:  # noqa: B008
    """Draw a game of 5 to 30 s."""
    body = draw(st.sampled_from(["krembot-sim", "krembot"]))
    k = draw(swarms)
    n = draw(st.integers(k, 80))
    sizes = apportion(n - k, draw(st.lists(st.integers(1, 4), min_size=k, max_size=k)))
    layouts = ["symmetric", "random-stations"] + ["nearer-station"] * (k <= 2)
    drive = st.sampled_from([0.6, 0.7, 0.3, 1.0])
    return Game(
        swarms=tuple(
            Swarm(
                policy=draw(st.sampled_from(POLICIES)),
                size=1 + size,
                drive=draw(drive),
                drive_action=draw(drive),
            )
            for size in sizes
        ),
        layout=draw(st.sampled_from(layouts)),
        # A small robot at full drive covers more than half its radius in a period of 0.1 s.
        parameters=PRESETS["fitted"].replace(**draw(parameters(0.1 if body == "krembot-sim" else 0.05))),
        body=body,
        side=draw(st.sampled_from([2.0, 2.5])),
        duration=draw(st.sampled_from([5.0, 30.0, 9.97])),
        puck_limit=draw(st.sampled_from([None, 1, 2])),
        supply=draw(st.sampled_from([None, 1, 4])),
        absent=tuple(draw(st.sets(st.integers(0, n - 1), max_size=min(3, n - 1)))),
    )


def check_bodies(model: GameModel, before: np.ndarray[Any, Any]) -> None:
    """Check that no robots overlap, are outside, or moved much farther than they drive."""
    positions, body = model.states.positions, model.game.body
    if len(positions) == 0:
        return
    if len(positions) > 1:
        assert pdist(positions).min() > 2 * body.radius - 1e-4
    assert np.abs(positions).max() <= model.arena.half - body.radius + ROUNDING
    assert np.abs(model.states.bodies.heading).max() <= np.pi + ROUNDING
    # Drive, shoves and relaxation; a body that moves farther could pass through others.
    drive = max(max(swarm.drive, swarm.drive_action) for swarm in model.game.swarms)
    stride = drive * body.top_speed * model.game.parameters.period
    assert np.hypot(*(positions - before).T).max() < 3 * stride


def check_supply(model: GameModel) -> None:
    """Check that the pucks picked up are those missing at the stations."""
    if model.game.supply is None:
        assert set(model.supply) == {-1}
    else:
        assert min(model.supply) >= 0
        assert model.picked_up == model.game.supply * len(model.supply) - sum(model.supply)


def check_results(model: GameModel) -> None:
    """Check the sums of the rows of results, and the reason for the end of the game."""
    game, rows = model.game, model.results()
    assert [row["swarm"] for row in rows] == list(range(1, len(game.swarms) + 1))
    total = sum(row["pucks"] for row in rows)
    assert sum(row["sud"] for row in rows) == (2 - len(rows)) * total
    period = game.parameters.period
    assert sum(row["size"] for row in rows) == game.size - len(game.absent)
    players = [model.players(swarm) for swarm in range(len(rows))]
    for row, swarm, members in zip(rows, game.swarms, players, strict=True):
        assert (row["size"], row["policy"]) == (len(members), swarm.policy)
        assert row["pucks"] == sum(robot.pucks for robot in members)
        begun = row["conflicts_intra"] + row["conflicts_inter"]
        assert begun == sum(sum(robot.conflicts) for robot in members)
        assert row["duration"] == pytest.approx(model.env.now * period)
    assert {row["ended"] for row in rows} == {model.ended}
    if model.ended == "pucks":
        assert total == game.puck_limit
    else:
        assert model.ended == ("time" if game.puck_limit is None else "cap")
        assert game.puck_limit is None or total < game.puck_limit
        assert game.duration <= model.time + ROUNDING < game.duration + period + ROUNDING
    if len(rows) == 1:
        assert (rows[0]["t_a_inter"], rows[0]["conflicts_inter"]) == (0, 0)


any_game = given(
    games(), st.integers(0, 2**32), st.dictionaries(st.integers(0, 150), st.integers(0, 79), max_size=9)
)
jam_at_the_walls = example(make_game("aggressive", "aggressive", size=25, duration=20.0), 0, {})


@pytest.mark.slow
@settings(max_examples=100)
@any_game
@jam_at_the_walls
def test_bodies_times_and_pucks_in_every_period(game: Game, seed: int, removals: dict[int, int]) -> None:
    check_every_period(game, seed, removals)


@pytest.mark.full
@settings(max_examples=1000)
@any_game
def test_bodies_times_and_pucks_in_every_period_of_many_games(
    game: Game, seed: int, removals: dict[int, int]
) -> None:
    check_every_period(game, seed, removals)


def check_every_period(game: Game, seed: int, removals: dict[int, int]) -> None:
    """Play a game and check it in every period; `removals` are rows of robots that are removed, by period."""
    model = GameModel(game.replace(sample_period=game.parameters.period), seed)
    while not model.ended:
        if model.now in removals and model.robots:
            model.robots[removals[model.now] % len(model.robots)].remove()
        before = model.states.positions.copy()
        model.step()  # one control period
        check_bodies(model, before)
        check_times_and_pucks(model)
        check_supply(model)
    check_results(model)
    event(f"ended: {model.ended}")
    event(f"supply: {'none' if game.supply is None else 'used up' if not any(model.supply) else 'left'}")


@pytest.mark.slow
@pytest.mark.parametrize("policies", ["avoid,avoid", "avoid,attack", "mixed,aggressive,avoid"])
def test_a_puck_limited_game_ends_at_its_limit(policies: str) -> None:
    names = policies.split(",")
    for seed in range(5):
        game = make_game(*names, duration=36_000.0, puck_limit=50)
        model = GameModel(game, seed)
        model.play()
        rows = model.results()
        assert sum(row["pucks"] for row in rows) == 50
        assert {row["ended"] for row in rows} == {"pucks"}
        assert 50 < model.time < 36_000
        short = GameModel(game.replace(duration=50.0), seed)
        short.play()
        assert {row["ended"] for row in short.results()} == {"cap"}
        assert short.time == 50.0
        check_results(short)


def longest_stay(model: GameModel, seconds: float, fights_count: bool) -> float:
    """Continue the game; return the longest time (s) in which a robot moved by no more than its radius.

    Unless `fights_count`, such a time ends when the robot fights or is attacked: then another robot that
    drives against it holds it, not a wedge.
    """
    positions, period = model.states.positions, model.game.parameters.period
    phase, opponent = model.states.bodies.phase, model.states.bodies.opponent
    swarm, everyone = model.states.bodies.swarm, range(len(model.robots))
    fighter = np.array(
        [[robot.policy.choose(k).direction == TOWARDS for k in (0, 1)] for robot in model.robots]
    )
    start, now = positions.copy(), int(model.env.now)
    since, longest = np.full(len(start), now), np.zeros(len(start))
    for tick in range(now + 5, now + round(seconds / period) + 1, 5):
        model.env.run(until=tick)
        free = np.hypot(*(positions - start).T) > model.game.body.radius
        if not fights_count:
            fights = (phase == ACTION) & fighter[everyone, swarm[opponent]]
            free |= fights
            free[opponent[fights]] = True
        longest = np.maximum(longest, tick - since)
        start[free], since[free] = positions[free], tick
    return float(longest.max() * period)


def dense_game(policies: str, n: int, preempt: bool = False) -> Game:
    """Return a game of two swarms at a high density."""
    parameters, side = PRESETS["fitted"].replace(preempt=preempt), 2.0 if n <= 70 else 2.2
    names = policies.split(",")
    return make_game(*names, size=n // 2, parameters=parameters, side=side, duration=1000.0)


@pytest.mark.slow
@pytest.mark.parametrize(
    "policies",
    [
        *("avoid,avoid", "attack,attack", "attack,flight"),
        *(pytest.param(policies, marks=pytest.mark.full) for policies in ("avoid,attack", "flight,fight")),
    ],
)
def test_robots_that_do_not_fight_keep_moving(policies: str) -> None:
    # The maximum in 4 games of 300 s of each kind was 22 s.
    for seed, n in enumerate((50, 70, 80)):
        assert longest_stay(GameModel(dense_game(policies, n), seed), 300.0, fights_count=False) < 45


@pytest.mark.slow
@pytest.mark.parametrize("policies", ["attack,attack", "aggressive,aggressive", "mixed,avoid"])
@pytest.mark.parametrize("preempt", [False, True])
def test_fighters_block_each_other_until_they_flee(policies: str, preempt: bool) -> None:
    stayed = []
    for seed, n in enumerate((50, 70, 80)):
        model = GameModel(dense_game(policies, n, preempt), seed)
        stayed.append(longest_stay(model, 150.0, fights_count=True))
        for robot in model.robots:
            setting = Setting(robot.swarm, len(model.game.swarms), model.game.action_set, Streams(0, 0))
            robot.policy = make_policy("avoid", setting)
        assert longest_stay(model, 90.0, fights_count=True) < 60
    assert max(stayed) > 60


@pytest.mark.slow
@pytest.mark.parametrize(
    "policies",
    [
        *("avoid", "aggressive", "fight"),
        *(pytest.param(policies, marks=pytest.mark.full) for policies in ("attack", "mixed")),
    ],
)
def test_bodies_in_long_jams(policies: str) -> None:
    for seed, n in enumerate((50, 70, 80)):
        model = GameModel(dense_game(f"{policies},{policies}", n), seed)
        before = model.states.positions.copy()
        for tick in range(1, 1001):
            model.env.run(until=tick)
            check_bodies(model, before)
            before = model.states.positions.copy()
