"""The compiled kernel equals the plain reference, in generated states and in whole games."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings

from kswarms.agents.common.arrays import Records
from kswarms.agents.robot.state import IDLE, RobotStates
from kswarms.model.description.game import Game
from kswarms.model.game_model import GameModel
from kswarms.model.kernel.arrays import CONFLICT, EVENT, HOMING, LEG_DUE, PICK_UP
from tests.games import make_game
from tests.reference.compare import assert_same_events, assert_same_state, compared
from tests.reference.kernel import Event, ReferenceKernel, State
from tests.reference.states import Scene, make_scene, scenes


@pytest.mark.slow
@settings(deadline=None, max_examples=150)
@given(scenes())
def test_a_period_equals_the_reference(scene: Scene) -> None:
    check_periods(scene)


@pytest.mark.full
@settings(deadline=None, max_examples=2000)
@given(scenes())
def test_a_period_equals_the_reference_in_many_scenes(scene: Scene) -> None:
    check_periods(scene)


def check_periods(scene: Scene) -> None:
    """Compare the kernel with the reference for some periods."""
    kernel = scene.kernel()
    advance = compared(kernel, ReferenceKernel(scene.game, scene.arena), scene.states, [])
    for tick in range(3):
        while advance(tick, tick + 1)[1]:
            pass  # without decisions, the next stage of the same period follows


def test_percepts_follow_pick_ups_in_the_same_period() -> None:
    game = make_game("avoid", size=1, duration=10)
    scene = make_scene(game, game.arena(0).stations[:1], [0.0], 0.015)
    scene.states.bodies.phase[:] = IDLE
    kernel, calls = scene.kernel(), list[int]()
    advance = compared(kernel, ReferenceKernel(game, scene.arena), scene.states, calls)
    found = [(advance(0, until)[1], int(kernel.events["kind"][0])) for until in (0, 1, 0)]
    assert found == [(0, 0), (1, PICK_UP), (1, LEG_DUE)]
    assert advance(0, 0) == (0, 0)
    assert calls == [0, 0, 0, 0]
    assert advance(0, 1) == (1, 0)


def play_compared(game: Game, seed: int, spoil_skin: float | None = None) -> tuple[GameModel, list[int]]:
    """Play a game and compare each call of the kernel; return also the numbers of periods of the calls."""
    model = GameModel(game, seed)
    kernel = model._kernel
    calls: list[int] = []
    if spoil_skin is not None:
        kernel.blocks.scalars["skin"] = spoil_skin
    kernel.advance = compared(kernel, ReferenceKernel(game, model.arena), model.states, calls)
    model.play()
    return model, calls


@pytest.mark.parametrize(
    "game",
    [
        make_game("avoid", "attack", size=10, duration=25),
        make_game("aggressive", "mixed", "avoid", size=10, parameters="argos", duration=20),
        make_game("attack", "attack", size=20, parameters="fitted, preempt=1, push_share=0.5", duration=10),
        make_game("avoid", size=60, parameters="argos, preempt=1", body="krembot", duration=10),
    ],
    ids=lambda game: f"{game.body}-{game.size}",
)
def test_a_game_equals_the_reference(game: Game) -> None:
    model, calls = play_compared(game, seed=1)
    assert sum(calls) == round(game.duration / game.parameters.period)
    assert sum(t_a for k in range(len(game.swarms)) for t_a in model.times(k)[0]) > 0


def test_long_calls_use_current_neighbours() -> None:
    # A call with few robots has many periods, in which all robots leave the cells of the lists.
    parameters = "fitted, leg_mean=60, wall_distance=0.3"
    game = make_game("avoid", "attack", size=3, parameters=parameters, body="krembot", duration=200)
    _, calls = play_compared(game, seed=3)
    assert max(calls) * 0.015 > 10 * game.body.radius


# ------------------------------------------------------------------------- the comparison detects differences


def test_a_stale_neighbour_list_is_detected() -> None:
    game = make_game("avoid", "attack", size=10, duration=60)
    with pytest.raises(AssertionError):
        play_compared(game, seed=1, spoil_skin=100.0)


@pytest.mark.parametrize(
    "change", [{"friction": 0.2}, {"push_share": 0.1}, {"conflict_distance": 0.2}, {"active_range": 0.25}]
)
def test_a_different_rule_is_detected(change: dict[str, float]) -> None:
    game = make_game("avoid", "aggressive", size=15, duration=60)
    other = game.replace(parameters=game.parameters.replace(**change))
    model = GameModel(game, seed=1)
    reference = ReferenceKernel(other, model.arena)
    model._kernel.advance = compared(model._kernel, reference, model.states, [])
    with pytest.raises(AssertionError):
        model.play()


def events_of_a_kernel() -> Records:
    found = np.zeros(4, dtype=EVENT)
    found["robot"] = 0, 2, 3, 4
    found["kind"] = PICK_UP, CONFLICT, HOMING, LEG_DUE
    found["other"] = 1, 3, 0, 0
    found["active"][1], found["vacant"][1] = 2, 5
    found["angle"] = 0.0, 0.5, -1.0, 0.0
    return found


EVENTS = (
    Event(0, PICK_UP, other=1),
    Event(2, CONFLICT, active=2, vacant=5, rivals=((3, 0.5), (4, -0.5))),
    Event(3, HOMING, angle=-1.0),
    Event(4, LEG_DUE),
)


def test_equal_events_pass() -> None:
    assert_same_events(events_of_a_kernel(), list(EVENTS))


@pytest.mark.parametrize(
    ("index", "change"),
    [
        (0, {"other": 0}),
        (0, {"robot": 1}),
        (1, {"active": 3}),
        (1, {"vacant": 4}),
        (1, {"rivals": ((4, 0.5),)}),
        (1, {"rivals": ((3, 0.51), (4, 0.5))}),
        (2, {"angle": 1.0}),
        (3, {"kind": HOMING}),
    ],
)
def test_a_different_event_is_detected(index: int, change: dict[str, Any]) -> None:
    expected = list(EVENTS)
    expected[index] = expected[index]._replace(**change)
    with pytest.raises(AssertionError):
        assert_same_events(events_of_a_kernel(), expected)


def test_an_extra_event_is_detected() -> None:
    with pytest.raises(AssertionError):
        assert_same_events(events_of_a_kernel(), list(EVENTS[:-1]))


@pytest.mark.parametrize("field", ["positions", "heading", "forward_x", "forward_y", "moved_x"])
def test_a_different_state_is_detected(field: str) -> None:
    states = RobotStates(np.zeros((2, 2)), np.zeros(2, dtype=np.int64), np.zeros(2))
    state = State.of(states)
    assert_same_state(states, state)
    changed = states.positions if field == "positions" else getattr(states.bodies, field)
    changed[1] += 1e-8
    with pytest.raises(AssertionError):
        assert_same_state(states, state)
