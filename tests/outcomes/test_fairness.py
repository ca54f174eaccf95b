"""Nobody is favoured: not a swarm for its label or side, not a robot for its number (specification, 2.5).

Statistical where chance decides, with tolerances from the seeds; exact where it can be, by playing a game
again with robots, sides and every draw exchanged.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from numpy.random import Generator
from numpy.typing import NDArray

from kswarms.agents.robot.krembot import Krembot
from kswarms.agents.streams import Purpose, stream
from kswarms.model.description.game import Game, Swarm
from kswarms.model.description.parameters import PRESETS
from kswarms.model.game_model import GameModel

Values = NDArray[np.float64]


def make_game(policies: str, n: int, duration: float = 600.0, drive: float = 0.6, **changes: Any) -> Game:
    """Return a game of equal swarms, the first with a drive of its own."""
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
    """Return whether 0 lies in the 99 % interval of the mean of independent values (40 and more)."""
    values = np.asarray(values)
    return bool(abs(values.mean()) <= 2.7 * values.std(ddof=1) / math.sqrt(len(values)))


def test_the_interval_detects_a_difference() -> None:
    noise = np.random.default_rng(0).normal(size=60)
    assert may_be_zero(noise - noise.mean())
    assert not may_be_zero(noise - noise.mean() + 0.5)


def lead(game: Game, seeds: int) -> list[int]:
    """Return S1's pucks less S2's, for each seed."""
    return [models.pucks[0] - models.pucks[1] for models in (play(game, seed) for seed in range(seeds))]


@pytest.mark.slow
@pytest.mark.parametrize("policies", ["avoid,avoid", "attack,attack", "mixed,mixed"])
def test_equal_swarms_score_alike(policies: str) -> None:
    assert may_be_zero(lead(make_game(policies, 20, duration=400.0), 60))


@pytest.mark.slow
def test_a_faster_swarm_scores_more() -> None:
    # The same test finds the difference that there is.
    assert not may_be_zero(lead(make_game("avoid,avoid", 20, duration=400.0, drive=0.7), 240))


@pytest.mark.slow
@pytest.mark.parametrize("n", [10, 30])
def test_swapping_labels_and_sides_mirrors_the_results(n: int) -> None:
    differences: dict[str, list[float]] = {name: [] for name in ("avoid", "attack", "t_a", "conflicts")}
    for seed in range(40):
        attack, avoid = play(make_game("attack,avoid", n, duration=400.0), seed).results()
        avoid_there, attack_there = play(make_game("avoid,attack", n, duration=400.0), 40 + seed).results()
        differences["avoid"].append(avoid["pucks"] - avoid_there["pucks"])
        differences["attack"].append(attack["pucks"] - attack_there["pucks"])
        differences["t_a"].append(attack["t_a_inter"] - attack_there["t_a_inter"])
        differences["conflicts"].append(avoid["conflicts_inter"] - avoid_there["conflicts_inter"])
    assert {name: may_be_zero(values) for name, values in differences.items()} == dict.fromkeys(
        differences, True
    )


def correlations_with_index(models: Sequence[GameModel], of: Callable[[Krembot], float]) -> list[float]:
    """Return the correlation of a quantity with the number in the swarm, for each swarm of each game."""
    found = []
    for model in models:
        for members in model.members:
            values = [of(robot) for robot in members]
            if len(set(values)) > 1:
                found.append(float(np.corrcoef(range(len(members)), values)[0, 1]))
    return found


@pytest.mark.slow
@pytest.mark.parametrize(
    ("policies", "n"), [("avoid,avoid", 20), ("avoid,attack", 36), ("aggressive,attack", 40)]
)
def test_the_order_of_robots_has_no_effect(policies: str, n: int) -> None:
    models = [play(make_game(policies, n, duration=300.0), seed) for seed in range(50)]
    assert may_be_zero(correlations_with_index(models, lambda robot: robot.pucks))
    assert may_be_zero(correlations_with_index(models, lambda robot: sum(robot.t_a)))
    assert may_be_zero(correlations_with_index(models, lambda robot: sum(robot.conflicts)))
    # Nor among all robots, where the swarms are equal.
    if policies == "avoid,avoid":
        halves = [
            sum(robot.pucks for robot in model.robots[::2]) - sum(robot.pucks for robot in model.robots[1::2])
            for model in models
        ]
        assert may_be_zero(halves)


@dataclass
class Exchange:
    """A symmetry of the symmetric arena, and an exchange of robots that goes with it.

    Attributes
    ----------
    name : str
        For the test's name.
    signs : tuple of int
        Factors of x and y.
    twins : callable
        Number of a robot's twin, of the robot's number and N.
    swaps : bool
        Whether the swarms change places.
    """

    name: str
    signs: tuple[int, int]
    twins: Callable[[int, int], int]
    swaps: bool

    @property
    def turns_over(self) -> bool:
        """Whether left and right are exchanged."""
        return self.signs[0] * self.signs[1] < 0

    def heading(self, heading: float) -> float:
        return math.atan2(self.signs[1] * math.sin(heading), self.signs[0] * math.cos(heading))


class Exchanged:
    """A stream with the mirrored draws of the twin."""

    def __init__(self, exchange: Exchange, draws: Generator, purpose: Purpose) -> None:
        self._exchange, self._draws, self._purpose = exchange, draws, purpose

    def exponential(self, mean: float) -> float:
        return self._draws.exponential(mean)

    def random(self) -> float:
        return self._draws.random()

    def uniform(self, low: float, high: float) -> float:
        drawn = self._draws.uniform(low, high)
        if self._purpose == Purpose.WALL:  # a heading
            return self._exchange.heading(drawn)
        assert self._purpose == Purpose.WANDER
        return -drawn if self._exchange.turns_over else drawn


def exchange_draws(model: GameModel, exchange: Exchange, monkeypatch: pytest.MonkeyPatch) -> None:
    """Give all robots the draws of their twins from now on."""
    n = model.game.size
    monkeypatch.setattr(
        "kswarms.agents.streams.stream",
        lambda seed, robot, purpose: Exchanged(
            exchange, stream(seed, exchange.twins(robot, n), purpose), purpose
        ),
    )
    if exchange.turns_over:
        choose = Krembot._vacant_direction

        def choose_in_the_mirror(robot: Krembot, vacant: int) -> float:
            mirrored = sum(1 << (-sensor % 8) for sensor in range(8) if vacant >> sensor & 1)
            return -choose(robot, mirrored)

        monkeypatch.setattr(Krembot, "_vacant_direction", choose_in_the_mirror)


def put_twins(model: GameModel, original: GameModel, exchange: Exchange) -> None:
    """Put every robot where its twin stands, seen in the mirror."""
    states, source = model.states, original.states
    for robot in range(model.game.size):
        twin = exchange.twins(robot, model.game.size)
        states.positions[robot] = source.positions[twin] * exchange.signs
        heading = exchange.heading(source.heading[twin])
        states.robots["heading"][robot] = heading
        states.robots["forward_x"][robot] = math.cos(heading)
        states.robots["forward_y"][robot] = math.sin(heading)


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
    """Play a game and its image, and return how far apart they ever are (m), compared every period.

    Infinity if rounding decided which of two, equally near, a robot met, or which way it turned round.
    It must have been rounding.
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
        robots = model.states.robots[twins]
        turns = -robots["turn_rate"] if exchange.turns_over else robots["turn_rate"]
        path.append((model.states.positions[twins] * exchange.signs, image_of[robots["opponent"]], turns))
    apart, tied = 0.0, False
    with pytest.MonkeyPatch.context() as monkeypatch:
        exchange_draws(image, exchange, monkeypatch)
        for positions, met, turns in path:
            before = image.states.positions.copy()
            image.step()
            apart = max(apart, float(np.abs(image.states.positions - positions).max()))
            opposite = abs(turns + image.states.robots["turn_rate"]) < 1e-12
            for turn in turns[opposite & (turns != 0)]:
                # Whoever drives home, flees straight back and turns home again turns by exactly half a turn.
                tied |= apart < 1e-6 and abs(math.remainder(math.pi, turn)) < 1e-9
            for robot in np.flatnonzero(image.states.robots["opponent"] != met):
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


@pytest.mark.slow
@pytest.mark.parametrize("exchange", EXCHANGES, ids=lambda exchange: exchange.name)
@pytest.mark.parametrize("policies", ["avoid,attack", "aggressive,attack"])
@pytest.mark.parametrize(
    "changes",
    [{}, {"preempt": True, "push_share": 0.5}, {"wall_escape": "away", "wall_half_angle": 0.7}],
    ids=str,
)
def test_an_exchanged_game_is_the_game_exchanged(
    exchange: Exchange, policies: str, changes: dict[str, Any]
) -> None:
    game = make_game(policies, 24, 20.0, station_radius=0.3, **changes)
    apart = [play_exchanged(game, seed, exchange) for seed in range(5)]
    # Rounding differs between the two, and now and then a contact is decided by it; a rule that favours
    # anyone would part all of them.
    assert sum(distance < 1e-6 for distance in apart) >= 3, apart


def test_an_effect_of_the_order_on_a_game_is_detected(monkeypatch: pytest.MonkeyPatch) -> None:
    choose = Krembot._vacant_direction
    monkeypatch.setattr(
        Krembot, "_vacant_direction", lambda robot, vacant: choose(robot, vacant) + 1e-3 * (robot.index == 3)
    )
    game = make_game("avoid,attack", 24, 20.0)
    assert min(play_exchanged(game, seed, EXCHANGES[0]) for seed in range(3)) > 1e-6
