"""What Mesa offers in public works on a game, or is refused with a reason."""

import copy
import gc
import pickle
import warnings
import weakref
from collections.abc import Callable
from typing import Any

import mesa
import numpy as np
import pytest
from mesa.experimental.continuous_space import ContinuousSpace, ContinuousSpaceAgent

from kswarms import ForagingModel, GameModel, InputError
from kswarms.agents.robot.krembot import Krembot
from tests.conftest import Scene
from tests.games import check_times_and_pucks, game_under_way, make_game, play


def small_model(**arguments: Any) -> ForagingModel:
    return ForagingModel(**{"n": 6, "seed": 1, "duration": 60.0, **arguments})


# Seeds.


def test_a_game_without_a_seed_draws_one_that_replays_it() -> None:
    first, second = (small_model(seed=None) for _ in range(2))
    assert first.seed != second.seed
    first.play()
    again = small_model(seed=first.seed)
    again.play()
    assert again.results() == first.results()
    assert first.datacollector.model_vars["run_seed"] == [first.seed] * 7
    assert GameModel(make_game("avoid")).seed != GameModel(make_game("avoid")).seed


@pytest.mark.parametrize("seed", [43, "43", " 43 ", 43.0, np.int64(43), np.float64(43)])
def test_a_seed_may_be_a_text_or_any_number(seed: Any) -> None:
    assert small_model(seed=seed).seed == 43


def test_rng_is_taken_as_mesa_takes_it() -> None:
    assert small_model(seed=None, rng=7).seed == small_model(seed=None, rng=np.int32(7)).seed == 7
    of_sequence = [small_model(seed=None, rng=np.random.SeedSequence(5)).seed for _ in range(2)]
    assert of_sequence[0] == of_sequence[1]
    assert small_model(seed=None, rng=[1, 2]).seed == small_model(seed=None, rng=[1, 2]).seed
    generator, twin = np.random.default_rng(3), np.random.default_rng(3)
    models = [small_model(seed=None, rng=generator) for _ in range(2)]
    assert models[0].seed != models[1].seed
    assert models[0].rng is generator
    assert small_model(seed=None, rng=twin).seed == models[0].seed
    assert small_model(seed=None, rng=np.random.PCG64(3)).seed == models[0].seed


@pytest.mark.parametrize(
    ("arguments", "field"),
    [
        ({"seed": "x"}, "seed"),
        ({"seed": "-3"}, "seed"),
        ({"seed": "9" * 5000}, "seed"),
        ({"seed": ""}, "seed"),
        ({"seed": -1.0}, "seed"),
        ({"seed": float("nan")}, "seed"),
        ({"seed": [1]}, "seed"),
        ({"seed": None, "rng": "x"}, "rng"),
        ({"seed": None, "rng": -1}, "rng"),
        ({"seed": None, "rng": True}, "rng"),
        ({"seed": None, "rng": 1.5}, "rng"),
        ({"seed": None, "rng": [-1]}, "rng"),
        ({"seed": 1, "rng": 1}, "rng"),
    ],
)
def test_other_seeds_are_refused(arguments: dict[str, Any], field: str) -> None:
    with pytest.raises(InputError) as refusal:
        small_model(**arguments)
    assert refusal.value.field == field


@pytest.mark.parametrize("game", ["fig-6.1c", None, 3, {"swarms": []}])
def test_only_a_game_can_be_played(game: Any) -> None:
    with pytest.raises(InputError, match="must be a Game"):
        GameModel(game)


def test_mesas_random_generators_do_not_affect_the_game() -> None:
    model = game_under_way()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FutureWarning)  # Mesa 3.5 deprecates it
        model.reset_randomizer(5)
    model.reset_rng(5)
    model.random.random()
    model.agents.shuffle_do("step").shuffle(inplace=True).do("advance")
    model.play()
    twin = game_under_way()
    twin.play()
    assert model.results() == twin.results()


# Memory.


def test_models_are_freed_whether_they_were_played_or_not() -> None:
    def use(k: int) -> "weakref.ref[GameModel]":
        model = small_model(seed=k)
        if k > 0:
            model.step()
        if k > 1:
            Marker(model)
        if k > 2:
            with pytest.raises(InputError):
                Krembot.create_agents(model, 1, 0, 0, None, "", None, 0.0, 0.0, 2)
        if k > 3:
            model.play()
        return weakref.ref(model)

    models = [use(k) for k in range(5)]
    gc.collect()
    assert [model() for model in models] == [None] * 5


# Agents.


class Marker(mesa.Agent):
    """An agent that is not a robot."""

    colour = "red"


def test_agents_that_are_no_robots_may_join() -> None:
    model = small_model(record="model,agents,trajectory")
    marker, *others = Marker.create_agents(model, 3)
    assert [agent.unique_id for agent in model.agents] == list(range(1, 10))
    assert list(model.agents_by_type[Marker]) == [marker, *others]
    model.datacollector._new_agent_reporter("colour", lambda agent: getattr(agent, "colour", None))
    model.play()
    frame = model.datacollector.get_agent_vars_dataframe()
    last = frame.loc[frame.index.levels[0][-1]]
    assert last["colour"].dropna().tolist() == ["red"] * 3
    assert last["swarm"].isna().sum() == 3
    assert set(model.tables()["trajectory"]["robot"]) == set(range(6))
    marker.remove()
    assert len(model.agents) == 8


def test_robots_cannot_be_added() -> None:
    model, other = game_under_way(), game_under_way()
    robot = model.robots[0]
    robot.remove()
    adding: list[Callable[[], object]] = [
        lambda: model.register_agent(robot),
        lambda: model.register_agent(other.robots[0]),
        lambda: Krembot.create_agents(model, 1, 0, 0, None, "", None, 0.0, 0.0, 2),
        lambda: ContinuousSpaceAgent(model.space, model),
        lambda: ContinuousSpaceAgent(other.space, model),
    ]
    for add in adding:
        with pytest.raises(InputError, match=r"must not be a robot|has only robots"):
            add()
    assert list(model.agents) == model.robots
    model.play()
    check_times_and_pucks(model)


def test_the_sets_of_agents_are_copies() -> None:
    model = game_under_way()
    robots = model.robots
    for agents in (model.agents, model.agents_by_type[Krembot], model.space.agents):
        agents.select(lambda robot: robot.swarm == 1, inplace=True)
        assert len(agents) == 6
        agents.sort("number", inplace=True).shuffle(inplace=True)
    robot = robots[0]
    for change in ("remove", "discard", "add"):
        with pytest.raises(InputError, match=r"cannot be changed: use model\.remove"):
            getattr(model.agents, change)(robot)
    for change in ("clear", "pop"):
        with pytest.raises(InputError, match="cannot be changed"):
            getattr(model.agents, change)()
    with pytest.raises(AttributeError):
        model.agents = []  # type: ignore[misc,assignment]
    assert list(model.agents) == list(model.agents_by_type[Krembot]) == list(model.space.agents) == robots


def test_a_subclass_may_use_the_name_space_for_its_own() -> None:
    model = game_under_way()
    model.space = ContinuousSpace([[0, 1], [0, 1]], random=model.random)
    ContinuousSpaceAgent(model.space, model)
    model.robots[0].remove()
    model.play()
    check_times_and_pucks(model)


# Positions.


@pytest.mark.parametrize(
    "place",
    [
        (1.0, 0.0),
        (0.0, -0.92),
        (np.nan, 0.0),
        (np.inf, 0.0),
        (0.1,),
        (0.1, 0.1, 0.1),
        3,
        None,
        "xy",
        [[0.0, 0.0]],
    ],
)
def test_a_robot_cannot_be_put_outside(place: Any) -> None:
    model = game_under_way()
    before = model.states.positions.copy()
    with pytest.raises(InputError, match=r"must be two numbers from -0.915 to 0.915 \(m\)"):
        model.robots[0].position = place
    assert (model.states.positions == before).all()


def test_a_robot_cannot_be_put_on_another() -> None:
    model = game_under_way()
    first, second = model.robots[:2]
    before = model.states.positions.copy()
    for put in (
        lambda: setattr(first, "position", second.position),
        lambda: model.agents.set("pos", (0.1, 0.2)),
    ):
        model.states.positions[:] = before
        with pytest.raises(InputError, match="must not overlap robot"):
            put()
    first.position = first.position  # where it is
    first.remove()
    with pytest.raises(InputError, match="was removed"):
        first.position = (0.0, 0.0)


def test_positions_cannot_be_written_in_place() -> None:
    model = game_under_way()
    robot = model.robots[0]
    for write in (
        lambda: robot.position.__setitem__(0, 0.3),
        lambda: robot.position.__iadd__(0.1),
        lambda: model.space.agent_positions.__setitem__(3, (0.1, 0.2)),
        lambda: model.space.agent_positions.fill(0.0),
    ):
        with pytest.raises(ValueError, match="read-only"):
            write()
    robot.remove()
    with pytest.raises(ValueError, match="read-only"):
        model.space.agent_positions[0] = 0.0


def test_a_robot_that_is_moved_meets_those_at_its_new_place(scene: Scene) -> None:
    model = scene([(-0.5, -0.5, 0.0)], [(0.5, 0.5, 0.0)], policies="attack,attack")
    model.env.run(until=3)
    first, second = model.robots
    assert first.conflicts == [0, 0]
    first.position = second.position - (0.25, 0.0)
    model.env.run(until=30)
    assert first.conflicts[1] > 0
    assert np.hypot(*(first.position - second.position)) > 0.17 - 1e-4
    check_times_and_pucks(model)


# Steps and copies.


def test_steps_after_the_end_change_nothing() -> None:
    model = small_model()
    model.run_model()
    steps, samples = model.steps, copy.deepcopy(model.datacollector.model_vars)
    assert (steps, len(samples["time"])) == (7, 7)
    for _ in range(3):
        model.running = True
        model.step()
    assert (model.running, model.steps) == (False, steps)
    assert model.datacollector.model_vars == samples


def test_a_stopped_model_can_go_on() -> None:
    model = small_model()
    model.step()
    model.running = False
    model.play()
    assert model.time == 10.0
    model.running = True
    model.play()
    assert model.results() == play(model.game, 1).results()
    assert model.datacollector.model_vars["time"] == [0, 10, 20, 30, 40, 50, 60]


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, pickle.dumps])
def test_a_game_cannot_be_copied(copied: Callable[[object], object]) -> None:
    model = game_under_way()
    with pytest.raises(TypeError, match="a game cannot be copied or pickled; play it again"):
        copied(model)
