"""Outcomes of a period do not depend on the order of robots; a mirrored state has the mirrored outcome."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kswarms.agents.body import KREMBOT_SIM, SENSORS
from kswarms.agents.common.arrays import Integers
from kswarms.model.kernel.arrays import CONFLICT
from tests.reference.states import Scene, clone, crowded, game_of, make_scene, mirrored, play_period, scenes

R = KREMBOT_SIM.radius
STRIDE = 0.015


def assert_permuted(scene: Scene, image: Scene, order: Integers) -> None:
    """Check that robot k of the image behaves as robot ``order[k]`` of the scene."""
    events, image_events = play_period(scene), play_period(image)
    assert {(order[robot], kind) for robot, kind in image_events} == set(events)
    for (robot, kind), (other, *rest) in image_events.items():
        assert (order[other] if kind == CONFLICT else other, *rest) == events[order[robot], kind]
    np.testing.assert_allclose(image.states.positions, scene.states.positions[order], rtol=0, atol=1e-9)
    assert (image.states.bodies.heading == scene.states.bodies.heading[order]).all()


@settings(deadline=None, max_examples=300)
@given(scenes(), st.integers(0, 2**32 - 1))
def test_the_order_of_robots_has_no_effect(scene: Scene, seed: int) -> None:
    order = np.random.default_rng(seed).permutation(len(scene.states.positions))
    for state in (clone(scene), crowded(scene)):
        for numbers in (order, np.sort(order)[::-1]):
            assert_permuted(clone(state), clone(state, numbers), numbers)


def assert_mirrored(scene: Scene, image: Scene) -> None:
    """Check that the outcome of `image` is the mirror image of that of `scene`."""
    events, image_events = play_period(scene), play_period(image)
    assert set(image_events) == set(events)
    for key, (other, active, vacant, angle) in image_events.items():
        sensors = sum(1 << (-s % SENSORS) for s in range(SENSORS) if vacant >> s & 1)
        assert (other, active, sensors) == events[key][:3]
        assert math.remainder(angle + events[key][3], 2 * math.pi) == pytest.approx(0, abs=1e-9)
    np.testing.assert_allclose(image.states.positions, scene.states.positions * (-1, 1), rtol=0, atol=1e-9)
    turned = image.states.bodies.heading + scene.states.bodies.heading - math.pi
    np.testing.assert_allclose(np.sin(turned / 2), 0, atol=1e-9)


@settings(deadline=None, max_examples=300)
@given(scenes())
def test_a_mirrored_state_has_a_mirrored_outcome(scene: Scene) -> None:
    for state in (clone(scene), crowded(scene)):
        assert_mirrored(clone(state), mirrored(state))


def touching() -> Scene:
    """Return two robots that touch, one at rest."""
    return make_scene(game_of(2), [(0.0, 0.0), (2 * R, 0.001)], [0.8, 1.0], np.array((STRIDE, 0.0)))


def test_an_effect_of_the_order_is_detected() -> None:
    order = np.array((1, 0))
    assert_permuted(touching(), clone(touching(), order), order)
    favoured = clone(touching(), order)
    favoured.states.bodies.stride[1] *= 1.001
    with pytest.raises(AssertionError):
        assert_permuted(touching(), favoured, order)


def test_a_wrong_mirror_image_is_detected() -> None:
    assert_mirrored(touching(), mirrored(touching()))
    bent = mirrored(touching())
    bent.states.bodies.stride[0] *= 1.001
    with pytest.raises(AssertionError):
        assert_mirrored(touching(), bent)
