"""The same seed gives the same bytes in any process and order, with and without recording."""

import hashlib
import pickle
import random
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np
import pytest

from kswarms.model.description.game import Game, Swarm
from kswarms.model.foraging import ForagingModel
from kswarms.model.game_model import GameModel
from kswarms.model.recorder import RECORDS
from tests.games import make_game

ALL = ",".join(RECORDS)

GAMES = {
    "three": make_game("attack", "mixed", "avoid", duration=40.0),
    "random-stations": Game(
        swarms=(Swarm(policy="avoid", size=10, drive=0.7), Swarm(policy="attack", size=10)),
        layout="random-stations",
        duration=40.0,
        supply=2,
    ),
    "preempt": make_game(
        "aggressive", "attack", size=20, parameters="argos, preempt=true, push_share=0.5", duration=20.0
    ),
    "learning": make_game("learner", "inter-learner(rule='greedy')", learning=40.0, duration=20.0),
    "absent": make_game(
        "attack", "learner+random", learning=40.0, duration=20.0, absent=(1, 7), absent_from="game"
    ),
}


def digest(job: tuple[str, int]) -> str:
    """Play a game with all records, and return a digest of its results."""
    name, seed = job
    model = GameModel(GAMES[name].replace(sample_period=5.0), seed, record=ALL)
    model.play()
    outcome = model.results(), model.tables(), model.datacollector.model_vars
    # As text: pickle also stores which equal objects are identical.
    return hashlib.sha256(repr(outcome).encode()).hexdigest()


def test_the_same_seed_gives_the_same_bytes_in_one_process() -> None:
    for name in GAMES:
        assert digest((name, 1)) == digest((name, 1))


@pytest.mark.slow
def test_the_same_seed_gives_the_same_bytes_in_fresh_processes_in_any_order() -> None:
    jobs = [(name, seed) for name in GAMES for seed in range(4)]
    here = {job: digest(job) for job in jobs}
    shuffled = random.Random(5).sample(jobs, len(jobs))
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        there = dict(zip(shuffled, pool.map(digest, shuffled), strict=True))
    assert here == there
    assert len(set(here.values())) == len(jobs)


def test_global_generators_are_not_used() -> None:
    random.seed(1)
    np.random.seed(1)  # noqa: NPY002  # the global generator
    state = pickle.dumps((random.getstate(), np.random.get_state()))  # noqa: NPY002
    first = digest(("three", 1))
    assert pickle.dumps((random.getstate(), np.random.get_state())) == state  # noqa: NPY002
    random.seed(2)
    np.random.seed(2)  # noqa: NPY002
    assert digest(("three", 1)) == first


@pytest.mark.parametrize("name", GAMES)
@pytest.mark.parametrize(("record", "sample_period"), [("", 10.0), ("model", 0.1), (ALL, 3.7), (ALL, 1e9)])
def test_recording_does_not_change_the_game(name: str, record: str, sample_period: float) -> None:
    game = GAMES[name]
    plain, watched = GameModel(game, 7), GameModel(game.replace(sample_period=sample_period), 7, record)
    plain.env.run()
    watched.play()
    assert watched.results() == plain.results()
    assert watched.states.positions.tobytes() == plain.states.positions.tobytes()
    assert np.array_equal(watched.states.bodies, plain.states.bodies)


@pytest.mark.parametrize("name", GAMES)
def test_other_seeds_give_other_games(name: str) -> None:
    assert len({digest((name, seed)) for seed in range(5)}) == 5


def start(**arguments: object) -> tuple[np.ndarray, ForagingModel]:
    """Return the poses at the start of a game, and the game."""
    model = ForagingModel(**{"n": 12, "seed": 4, **arguments})  # type: ignore[arg-type]
    return np.column_stack([model.states.positions, model.states.bodies.heading]), model


@pytest.mark.parametrize(
    "changes",
    [
        {"policies": "attack,aggressive"},
        {"policies": "mixed,flight"},
        {"drives": "0.7,0.6/0.65"},
        {"parameters": "fitted, friction=0.4, conflict_distance=0.1, preempt=true"},
        {"puck_limit": 50, "supply": 3, "duration": 36_000.0},
        {"record": "agents", "sample_period": 1.0},
    ],
)
def test_starting_poses_depend_on_the_seed_alone(changes: dict[str, object]) -> None:
    assert (start(**changes)[0] == start()[0]).all()


def test_stations_depend_on_the_seed_alone() -> None:
    arguments = {"layout": "random-stations", "seed": 9}
    stations = start(**arguments)[1].arena.stations
    other = start(**arguments, n=30, policies="mixed,attack", drives="0.7,0.6")[1].arena.stations
    assert (stations == other).all()
    assert (start(**{**arguments, "seed": 10})[1].arena.stations != stations).all()
