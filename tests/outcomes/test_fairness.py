"""Labels and sides of swarms and numbers of robots have no effect (specification, section 2.5).

Some tests are statistical, with tolerances from the seeds. Others are exact: they play a game and its image
under a symmetry of the arena, with the robots and their random draws exchanged.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.random import Generator
from numpy.typing import NDArray

from kswarms.agents.robot.krembot import Krembot
from kswarms.agents.streams import Purpose, Streams, stream
from kswarms.model.description.game import Game, Swarm
from kswarms.model.description.presets import PRESETS
from kswarms.model.game_model import GameModel

Values = NDArray[np.float64]


def make_game(policies: str, n: int, duration: float = 600.0, drive: float = 0.6, **changes: Any) -> Game:
    """Return a game of equal swarms; `drive` is the drive of the first."""
    names = policies.split(",")
    return Game(
        swarms=tuple(
            Swarm(policy=name, size=n // len(names), drive=drive if k == 0 else 0.6)
            for k, name in enumerate(names)
        ),
        parameters=PRESETS["fitted"].replace(**changes),
        duration=duration,
    )


def play(game: Game, seed: int) -> GameModel:
    model = GameModel(game, seed)
    model.play()
    return model


def may_be_zero(values: Sequence[float] | Values) -> bool:
    """Return whether 0 is in the 99 % interval of the mean of 40 or more independent values."""
    values = np.asarray(values)
    return bool(abs(values.mean()) <= 2.7 * values.std(ddof=1) / math.sqrt(len(values)))


def test_the_interval_detects_a_difference() -> None:
    noise = np.random.default_rng(0).normal(size=60)
    assert may_be_zero(noise - noise.mean())
    assert not may_be_zero(noise - noise.mean() + 0.5)


def score_differences(game: Game, seeds: int) -> list[int]:
    """Return the pucks of S1 minus those of S2, for each seed."""
    return [model.pucks[0] - model.pucks[1] for model in (play(game, seed) for seed in range(seeds))]


@pytest.mark.slow
@pytest.mark.parametrize(
    "policies", ["avoid,avoid", "attack,attack", pytest.param("mixed,mixed", marks=pytest.mark.full)]
)
def test_equal_swarms_score_alike(policies: str) -> None:
    assert may_be_zero(score_differences(make_game(policies, 20, duration=400.0), 60))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("drive", "seeds"),
    [
        (0.8, 60),  # as many as above; the mean is 4.6 times its standard error
        pytest.param(0.7, 240, marks=pytest.mark.full),
    ],
)
def test_a_faster_swarm_scores_more(drive: float, seeds: int) -> None:
    game = make_game("avoid,avoid", 20, duration=400.0, drive=drive)
    assert not may_be_zero(score_differences(game, seeds))


@pytest.mark.slow
@pytest.mark.parametrize("n", [10, pytest.param(30, marks=pytest.mark.full)])
def test_swapping_labels_and_sides_mirrors_the_results(n: int) -> None:
    differences = []
    for seed in range(40):
        attack, avoid = play(make_game("attack,avoid", n, duration=400.0), seed).results()
        other_avoid, other_attack = play(make_game("avoid,attack", n, duration=400.0), 40 + seed).results()
        pucks = [avoid["pucks"] - other_avoid["pucks"], attack["pucks"] - other_attack["pucks"]]
        time_in_conflict = attack["t_a_inter"] - other_attack["t_a_inter"]
        conflicts = avoid["conflicts_inter"] - other_avoid["conflicts_inter"]
        differences.append([*pucks, time_in_conflict, conflicts])
    assert [may_be_zero(values) for values in np.transpose(differences)] == [True] * 4


def correlations_with_index(models: Sequence[GameModel], of: Callable[[Krembot], float]) -> list[float]:
    """Return the correlation of a quantity with the number of the robot, for each swarm of each game."""
    found = []
    for model in models:
        for members in model.members:
            values = [of(robot) for robot in members]
            if len(set(values)) > 1:
                found.append(float(np.corrcoef(range(len(members)), values)[0, 1]))
    return found


@pytest.mark.slow
@pytest.mark.parametrize(
    ("policies", "n"),
    [
        ("avoid,avoid", 20),
        pytest.param("avoid,attack", 36, marks=pytest.mark.full),
        ("aggressive,attack", 40),
    ],
)
def test_the_order_of_robots_has_no_effect(policies: str, n: int) -> None:
    models = [play(make_game(policies, n, duration=300.0), seed) for seed in range(100)]
    assert may_be_zero(correlations_with_index(models, lambda robot: robot.pucks))
    assert may_be_zero(correlations_with_index(models, lambda robot: sum(robot.t_a)))
    assert may_be_zero(correlations_with_index(models, lambda robot: sum(robot.conflicts)))
    if policies == "avoid,avoid":  # equal swarms: even numbers against odd numbers of all robots
        pucks = np.array([[robot.pucks for robot in model.robots] for model in models])
        assert may_be_zero(pucks[:, ::2].sum(axis=1) - pucks[:, 1::2].sum(axis=1))


@dataclass
class Exchange:
    """A symmetry of the symmetric arena, and the exchange of robots that belongs to it."""

    name: str
    signs: tuple[int, int]  # factors of x and y
    twins: Callable[[int, int], int]  # number of a robot's twin, from the robot's number and N
    swaps: bool  # whether the swarms change places

    @property
    def is_reflection(self) -> bool:
        """Whether left and right turns are exchanged."""
        return self.signs[0] * self.signs[1] < 0

    def heading(self, heading: float) -> float:
        return math.atan2(self.signs[1] * math.sin(heading), self.signs[0] * math.cos(heading))


class ExchangedStream:
    """Random stream of a robot's twin, with mirrored draws."""

    def __init__(self, exchange: Exchange, generator: Generator, purpose: Purpose) -> None:
        self._exchange, self._generator, self._purpose = exchange, generator, purpose

    def exponential(self, mean: float, size: int) -> Values:
        return self._generator.exponential(mean, size)

    def random(self, size: int) -> Values:
        return self._generator.random(size)

    def uniform(self, low: float, high: float, size: int) -> Values:
        drawn = self._generator.uniform(low, high, size)
        if self._purpose == Purpose.WALL:  # headings
            return np.array([self._exchange.heading(heading) for heading in drawn])
        assert self._purpose == Purpose.WANDER
        return -drawn if self._exchange.is_reflection else drawn


def exchange_draws(model: GameModel, exchange: Exchange, monkeypatch: pytest.MonkeyPatch) -> None:
    """Give all robots the random streams of their twins."""
    n = model.game.size

    @cache
    def exchanged_stream(streams: Streams, purpose: Purpose) -> ExchangedStream:
        twin = exchange.twins(streams.robot, n)
        return ExchangedStream(exchange, stream(streams.seed, twin, purpose), purpose)

    monkeypatch.setattr(Streams, "generator", lambda self, purpose: exchanged_stream(self, purpose))
    if exchange.is_reflection:
        for robot in model.robots:
            mirrored = [
                robot._flights[sum(1 << (-sensor % 8) for sensor in range(8) if vacant >> sensor & 1)]
                for vacant in range(256)
            ]
            robot._flights = [[(periods, -rate) for periods, rate in turns] for turns in mirrored]


def put_twins(model: GameModel, original: GameModel, exchange: Exchange) -> None:
    """Place each robot at the mirrored pose of its twin."""
    states, source = model.states, original.states
    for robot in range(model.game.size):
        twin = exchange.twins(robot, model.game.size)
        states.positions[robot] = source.positions[twin] * exchange.signs
        heading = exchange.heading(source.heading[twin])
        states.bodies.heading[robot] = heading
        states.bodies.forward_x[robot] = math.cos(heading)
        states.bodies.forward_y[robot] = math.sin(heading)


def reverse_within_swarms(robot: int, n: int) -> int:
    half = n // 2
    return half - 1 - robot if robot < half else n + half - 1 - robot


EXCHANGES = [
    Exchange("numbers reversed", (1, 1), reverse_within_swarms, swaps=False),
    Exchange("half a turn", (-1, -1), lambda robot, n: (robot + n // 2) % n, swaps=True),
    Exchange("left to right", (-1, 1), lambda robot, n: n - 1 - robot, swaps=True),
    Exchange("upside down", (1, -1), lambda robot, n: robot, swaps=False),
]


def play_exchanged(game: Game, seed: int, exchange: Exchange) -> float:
    """Play a game and its image; return the maximum distance of a robot from its image in any period (m).

    Return infinity if rounding decided which of two equally near robots a robot met, or the sense of a half
    turn.
    """
    twins = [exchange.twins(robot, game.size) for robot in range(game.size)]
    game = game.replace(sample_period=game.parameters.period)
    model = GameModel(game, seed)
    if exchange.swaps:
        game = game.replace(swarms=game.swarms[::-1])
    image = GameModel(game, seed)
    put_twins(image, model, exchange)
    image_of = np.append(np.argsort(twins), -1)  # −1, no opponent, stays −1
    path = []
    while not model.ended:
        model.step()
        bodies = model.states.bodies
        turns = -bodies.turn_rate[twins] if exchange.is_reflection else bodies.turn_rate[twins]
        path.append((model.states.positions[twins] * exchange.signs, image_of[bodies.opponent[twins]], turns))
    apart, tied = 0.0, False
    with pytest.MonkeyPatch.context() as monkeypatch:
        exchange_draws(image, exchange, monkeypatch)
        for positions, met, turns in path:
            before = image.states.positions.copy()
            image.step()
            apart = max(apart, float(np.abs(image.states.positions - positions).max()))
            opposite = abs(turns + image.states.bodies.turn_rate) < 1e-12
            for turn in turns[opposite & (turns != 0)]:
                # A robot that drives home, flees straight back and turns home again makes a half turn.
                tied |= apart < 1e-6 and abs(math.remainder(math.pi, turn)) < 1e-9
            for robot in np.flatnonzero(image.states.bodies.opponent != met):
                if apart < 1e-6 and not tied:
                    opponents = (image.states.opponent[robot], met[robot])
                    distances = [math.dist(before[robot], before[k]) for k in opponents]
                    assert distances[0] == pytest.approx(distances[1], rel=0, abs=1e-12)
                    tied = True
    if apart < 1e-6 and tied:
        return math.inf
    if apart < 1e-6:
        order = slice(None, None, -1 if exchange.swaps else 1)
        assert image.pucks == model.pucks[order]
        assert [robot.pucks for robot in image.robots] == [model.robots[twin].pucks for twin in twins]
        assert [robot.t_a for robot in image.robots] == [model.robots[twin].t_a[order] for twin in twins]
        assert sum(sum(robot.conflicts) for robot in model.robots) > 50
    return apart


def each_rule(policies: str, *marks: pytest.MarkDecorator) -> list[Any]:
    """Return parameters with the policies: changes of the rules of contacts and of walls."""
    changes = ({"preempt": True, "push_share": 0.5}, {"wall_escape": "away", "wall_half_angle": 0.7})
    return [pytest.param(policies, changed, marks=marks, id=f"{policies}-{changed}") for changed in changes]


@pytest.mark.slow
@pytest.mark.parametrize("exchange", EXCHANGES, ids=lambda exchange: exchange.name)
@pytest.mark.parametrize(
    ("policies", "changes"),
    [
        ("avoid,attack", {}),
        ("aggressive,attack", {}),
        *each_rule("aggressive,attack"),
        *each_rule("avoid,attack", pytest.mark.full),
    ],
)
def test_an_exchanged_game_has_the_exchanged_outcome(
    exchange: Exchange, policies: str, changes: dict[str, Any]
) -> None:
    game = make_game(policies, 24, 20.0, station_radius=0.3, **changes)
    apart = [play_exchanged(game, seed, exchange) for seed in range(5)]
    # Rounding differs between the two games and sometimes decides a contact. A rule that favours a robot or
    # a swarm would make all pairs of games differ.
    assert sum(distance < 1e-6 for distance in apart) >= 3, apart


def test_an_effect_of_the_order_on_a_game_is_detected(monkeypatch: pytest.MonkeyPatch) -> None:
    meet = Krembot.meet

    def meet_unfairly(robot: Krembot, *arguments: Any) -> None:
        meet(robot, *arguments)
        robot._turn_rate[robot.index] += 1e-3 * (robot.index == 3 and robot._turn_rate[robot.index] != 0)

    monkeypatch.setattr(Krembot, "meet", meet_unfairly)
    game = make_game("avoid,attack", 24, 20.0)
    assert min(play_exchanged(game, seed, EXCHANGES[0]) for seed in range(3)) > 1e-6
