"""Bodies in contact obey section 2.5: whatever the state, and in cases whose outcome is known on paper."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.distance import pdist

from kswarms.agents.body import KREMBOT_SIM, SENSORS
from kswarms.agents.common.arrays import Floats, Integers
from kswarms.agents.robot.state import ACTION
from kswarms.model.description.game import Game, Swarm
from kswarms.model.description.parameters import PRESETS
from kswarms.model.kernel.arrays import CONFLICT, HOMING, PICK_UP
from tests.reference.contacts import Ground, translate
from tests.reference.states import Scene, clone, make_scene, mirrored, scenes, unit

R = KREMBOT_SIM.radius
STRIDE = 0.015
LARGEST_OVERLAP = 1e-4
EXACT = 1e-12

angles = st.floats(-math.pi, math.pi)
frictions = st.sampled_from((0.0, 0.18, 0.45, 1.5))


def game_of(n: int, friction: float = 0.18, push_share: float = 0.0) -> Game:
    parameters = PRESETS["fitted"].replace(friction=friction, push_share=push_share)
    return Game(swarms=(Swarm(policy="avoid", size=n),), parameters=parameters)


def drive(scene: Scene, periods: int = 1) -> Floats:
    """Move the robots of a scene, none of which decides anything; return by how much each was displaced."""
    before = scene.states.positions.copy()
    advance, tick = scene.kernel().advance, 0
    while tick < periods:
        tick, _ = advance(tick, periods)
    return scene.states.positions - before


def play_period(scene: Scene) -> dict[tuple[int, int], tuple[int, int, int, float]]:
    """Play one period without decisions; return what each robot was told, by (robot, kind)."""
    kernel, told = scene.kernel(), {}
    while size := kernel.advance(0, 1)[1]:
        for robot, kind, other, active, vacant, angle in kernel.events[:size].tolist():
            told[robot, kind] = (
                other if kind in (CONFLICT, PICK_UP) else 0,
                active if kind == CONFLICT else 0,
                vacant if kind == CONFLICT else 0,
                angle if kind in (CONFLICT, HOMING) else 0.0,
            )
    return told


def crowded(scene: Scene) -> Scene:
    """Play two periods, after which many bodies touch, and have the robots perceive nothing from now on.

    A robot that touches two has no nearest one: the last bit would choose.
    """
    for _ in range(2):
        play_period(scene)
    scene.states.robots["phase"] = ACTION
    return replace(scene, game=scene.game.replace(parameters=scene.game.parameters.replace(preempt=False)))


# ----------------------------------------------------------------------------------------- whatever the state


def assert_apart(positions: Floats, radius: float, half: float) -> None:
    """Check that no bodies overlap by more than 0.1 mm and none sticks in a wall."""
    distance = np.hypot(*(positions[:, None] - positions[None]).T)
    np.fill_diagonal(distance, np.inf)
    assert distance.min() >= 2 * radius - LARGEST_OVERLAP
    assert np.abs(positions).max() <= half - radius + EXACT


@settings(deadline=None, max_examples=150)
@given(scenes())
def test_bodies_stay_apart_and_inside(scene: Scene) -> None:
    scene.states.robots["phase"] = ACTION
    scene.states.robots["carrying"] = 0
    for _ in range(10):
        drive(scene)
        assert_apart(scene.states.positions, scene.game.body.radius, scene.arena.half)


@settings(deadline=None, max_examples=300)
@given(scenes(), st.integers(0, 2**32 - 1))
def test_the_outcome_does_not_hang_on_the_last_bit(scene: Scene, seed: int) -> None:
    # Bodies that were stopped, or parted, just touch: whether they overlap by 1e-17 m must not matter.
    scene = crowded(scene)
    other = clone(scene)
    other.states.positions += np.random.default_rng(seed).uniform(-1e-13, 1e-13, other.states.positions.shape)
    np.testing.assert_allclose(drive(other), drive(scene), rtol=0, atol=1e-9)


@pytest.mark.parametrize("second", [(2 * R - 1.1e-4, 0.0), (1.0 - R + 1e-9, 0.0), (0.5, R - 1.001)])
def test_bodies_that_overlap_or_stick_in_a_wall_are_found(second: tuple[float, float]) -> None:
    assert_apart(np.array([[0.0, 0.0], [2 * R - 0.9e-4, 0.0]]), R, 1.0)
    with pytest.raises(AssertionError):
        assert_apart(np.array([[0.0, 0.0], second]), R, 1.0)


# ------------------------------------------------------------------------------------------------- two bodies


def pair(
    direction: float,
    gap: float,
    headings: tuple[float, float],
    strides: tuple[float, float],
    friction: float = 0.0,
    push_share: float = 0.0,
) -> tuple[Scene, Floats]:
    """Place two robots with a gap between them; return also the unit vector from the first to the second."""
    normal = unit(direction)
    first = np.array((0.1, -0.05))
    positions = np.array((first, first + (2 * R + gap) * normal))
    game = game_of(2, friction, push_share)
    return make_scene(game, positions, np.add(direction, headings), np.array(strides)), normal


@settings(deadline=None, max_examples=50)
@given(angles, st.floats(0, 0.01), st.floats(-1.5, 1.5), st.floats(-1.5, 1.5), frictions, st.floats(0, 1))
def test_two_that_drive_apart_part_freely(
    direction: float, gap: float, turn: float, other_turn: float, friction: float, push_share: float
) -> None:
    scene, _ = pair(direction, gap, (math.pi + turn, other_turn), (STRIDE, STRIDE), friction, push_share)
    expected = STRIDE * np.array((unit(direction + math.pi + turn), unit(direction + other_turn)))
    np.testing.assert_allclose(drive(scene), expected, rtol=0, atol=EXACT)


@settings(deadline=None, max_examples=50)
@given(angles, st.floats(0, 0.01), st.floats(-1.5, 1.5), frictions)
def test_a_contact_takes_the_normal_part_and_its_friction(
    direction: float, gap: float, turn: float, friction: float
) -> None:
    scene, normal = pair(direction, gap, (turn, 0.0), (STRIDE, 0.0), friction)
    moved = drive(scene)
    blocked = max(0.0, STRIDE * math.cos(turn) - gap)
    along = max(0.0, STRIDE * abs(math.sin(turn)) - friction * blocked)
    expected = (STRIDE * math.cos(turn) - blocked) * normal
    expected += math.copysign(along, turn) * np.array((-normal[1], normal[0]))
    np.testing.assert_allclose(moved[0], expected, rtol=0, atol=EXACT)
    assert not moved[1].any()  # who stands is not moved


@settings(deadline=None, max_examples=50)
@given(angles, st.floats(0, 0.01), st.floats(0, 1), frictions)
def test_a_push_moves_who_stands_by_its_share(
    direction: float, gap: float, push_share: float, friction: float
) -> None:
    scene, normal = pair(direction, gap, (0.0, 0.0), (STRIDE, 0.0), friction, push_share)
    blocked = STRIDE - gap
    expected = np.array(((STRIDE - (1 - push_share) * blocked) * normal, push_share * blocked * normal))
    np.testing.assert_allclose(drive(scene), expected, rtol=0, atol=EXACT)


@settings(deadline=None, max_examples=50)
@given(angles, st.floats(0, 0.01), st.floats(0.2, 1))
def test_two_that_meet_share_the_gap_by_speed(direction: float, gap: float, part: float) -> None:
    scene, normal = pair(direction, gap, (0.0, math.pi), (STRIDE, part * STRIDE))
    free = min(gap, (1 + part) * STRIDE) / (1 + part)
    np.testing.assert_allclose(drive(scene), (free * normal, -free * part * normal), rtol=0, atol=EXACT)


@settings(deadline=None, max_examples=50)
@given(st.integers(0, 3), st.floats(0, 0.01), st.floats(-1.5, 1.5), frictions, st.floats(0, 1))
def test_a_wall_takes_the_normal_part_and_its_friction(
    side: int, gap: float, turn: float, friction: float, push_share: float
) -> None:
    outwards = unit(side * math.pi / 2).round()
    scene = make_scene(
        game_of(1, friction, push_share),
        [(1 - R - gap) * outwards],
        [side * math.pi / 2 + turn],
        STRIDE,
    )
    blocked = max(0.0, STRIDE * math.cos(turn) - gap)
    along = max(0.0, STRIDE * abs(math.sin(turn)) - friction * blocked)
    expected = (STRIDE * math.cos(turn) - blocked) * outwards
    expected += math.copysign(along, turn) * np.array((-outwards[1], outwards[0]))
    np.testing.assert_allclose(drive(scene)[0], expected, rtol=0, atol=EXACT)


# ----------------------------------------------------------------------------------------------------- wedges


@pytest.mark.parametrize("aside", [0.001, 0.002, -0.01])
@pytest.mark.parametrize("turn", [0.0, 0.3, 2.0, -2.8])
def test_a_wedge_gives_way_a_little(turn: float, aside: float) -> None:
    # Two stand, less than a body apart; a third drives in between, and in the end through.
    turned = np.array((unit(turn), unit(turn + math.pi / 2)))
    positions = np.array(((0.0, 1.75 * R), (0.0, -1.75 * R), (-1.1 * R, aside))) @ turned
    game = game_of(3)
    scene = make_scene(game, positions, [0.0, 0.0, turn], np.array((0.0, 0.0, STRIDE)))
    moved = drive(scene, 60) @ turned.T
    assert moved[2, 0] > 2 * R
    assert min(moved[0, 1], -moved[1, 1]) > 0.1 * R
    # Half a radius in all would let it through.
    assert moved[0, 1] - moved[1, 1] == pytest.approx(0.5 * R, abs=0.01 * R)
    # Equal shares over and over, and nothing else, would share it between the two in the same way.
    plain = Ground(R, game.side / 2, game.parameters.friction, 0.0, most_momentum=0.0)
    slow = positions.copy()
    for _ in range(60):
        translate(slow, STRIDE * np.array(((0, 0), (0, 0), unit(turn))), plain)
    given_way = (slow - positions) @ turned.T
    np.testing.assert_allclose(moved[:2], given_way[:2], rtol=0, atol=0.01 * R)


@pytest.mark.parametrize("across", [0.0, 0.4, 1 - R])
@pytest.mark.parametrize("turn", [0.0, math.pi / 2, math.pi, -math.pi / 2])
def test_a_straight_row_from_wall_to_wall_gives_way(turn: float, across: float) -> None:
    # Twelve where there is room for less, exactly in line; one of them drives on.
    along = np.linspace(R - 1, 1 - R, 12)
    turned = np.array((unit(turn), unit(turn + math.pi / 2)))
    positions = np.column_stack((along, np.full(12, across))) @ turned
    scene = make_scene(game_of(12), positions, np.full(12, turn), STRIDE * (np.arange(12) == 3))
    drive(scene)
    assert pdist(scene.states.positions).min() > 2 * R - LARGEST_OVERLAP
    assert np.abs(scene.states.positions).max() <= 1 - R + EXACT


def test_what_cannot_be_parted_is_told() -> None:
    # A hundred bodies that have grown since they were placed: they would cover more than there is.
    side = np.linspace(R - 1, 1 - R, 10)
    scene = make_scene(game_of(100), np.array([(x, y) for x in side for y in side]), 0.0, STRIDE)
    kernel = scene.kernel()
    kernel.memory.scalars["radius"] = 0.11
    assert kernel.advance(0, 1)[0] == 0  # some perceive something, and decide nothing
    with pytest.raises(ValueError, match="nothing parts them"):
        kernel.advance(0, 1)


@settings(deadline=None, max_examples=20)
@given(angles, st.floats(-0.4, 0.4), st.floats(-0.01, 0.01), st.floats(-0.01, 0.01), frictions)
def test_a_robot_between_two_is_not_frozen(
    direction: float, turn: float, above: float, below: float, friction: float
) -> None:
    # Two drive at each other with a third between them, which drives across, steeper than friction holds it.
    turned = np.array((unit(direction), unit(direction + math.pi / 2)))
    positions = np.array(((-2.01 * R, above), (2.01 * R, below), (0.0, 0.0))) @ turned
    headings = [direction, direction + math.pi, direction + math.pi / 2 + turn]
    scene = make_scene(game_of(3, friction), positions, headings, STRIDE)
    assert drive(scene, 60)[2] @ turned[1] > R


@settings(deadline=None, max_examples=20)
@given(st.floats(-0.3, 0.3), st.floats(-0.4, 0.4), frictions)
def test_a_robot_between_a_wall_and_another_is_not_frozen(turn: float, place: float, friction: float) -> None:
    # It drives along the wall, somewhat into it or into the robot that presses it there.
    positions = (1 - R, 0.0) - np.outer((0, 2.01 * R), unit(place))
    scene = make_scene(game_of(2, friction), positions, [math.pi / 2 + turn, 0.0], STRIDE)
    assert drive(scene, 60)[0, 1] > R


# ------------------------------------------------------------------------------------------------- symmetries


def assert_permuted(scene: Scene, image: Scene, order: Integers) -> None:
    """Check that robot k of the image does what robot ``order[k]`` of the scene does."""
    told, image_told = play_period(scene), play_period(image)
    assert {(order[robot], kind) for robot, kind in image_told} == set(told)
    for (robot, kind), (other, *rest) in image_told.items():
        assert (order[other] if kind == CONFLICT else other, *rest) == told[order[robot], kind]
    np.testing.assert_allclose(image.states.positions, scene.states.positions[order], rtol=0, atol=1e-9)
    assert (image.states.robots["heading"] == scene.states.robots["heading"][order]).all()


@settings(deadline=None, max_examples=300)
@given(scenes(), st.integers(0, 2**32 - 1))
def test_no_number_is_favoured(scene: Scene, seed: int) -> None:
    order = np.random.default_rng(seed).permutation(len(scene.states.positions))
    for state in (clone(scene), crowded(scene)):
        for numbers in (order, np.sort(order)[::-1]):
            assert_permuted(clone(state), clone(state, numbers), numbers)


def assert_mirrored(scene: Scene, image: Scene) -> None:
    """Check that two scenes end as each other's mirror image."""
    told, image_told = play_period(scene), play_period(image)
    assert set(image_told) == set(told)
    for key, (other, active, vacant, angle) in image_told.items():
        sensors = sum(1 << (-s % SENSORS) for s in range(SENSORS) if vacant >> s & 1)
        assert (other, active, sensors) == told[key][:3]
        assert math.remainder(angle + told[key][3], 2 * math.pi) == pytest.approx(0, abs=1e-9)
    np.testing.assert_allclose(image.states.positions, scene.states.positions * (-1, 1), rtol=0, atol=1e-9)
    turned = image.states.robots["heading"] + scene.states.robots["heading"] - math.pi
    np.testing.assert_allclose(np.sin(turned / 2), 0, atol=1e-9)


@settings(deadline=None, max_examples=300)
@given(scenes())
def test_a_mirrored_state_has_a_mirrored_outcome(scene: Scene) -> None:
    for state in (clone(scene), crowded(scene)):
        assert_mirrored(clone(state), mirrored(state))


def touching() -> Scene:
    """Return two robots that touch, one at rest."""
    return make_scene(game_of(2), [(0.0, 0.0), (2 * R, 0.001)], [0.8, 1.0], np.array((STRIDE, 0.0)))


def test_a_favoured_number_is_found() -> None:
    order = np.array((1, 0))
    assert_permuted(touching(), clone(touching(), order), order)
    favoured = clone(touching(), order)
    favoured.states.robots["stride"][1] *= 1.001
    with pytest.raises(AssertionError):
        assert_permuted(touching(), favoured, order)


def test_a_bent_mirror_is_found() -> None:
    assert_mirrored(touching(), mirrored(touching()))
    bent = mirrored(touching())
    bent.states.robots["stride"][0] *= 1.001
    with pytest.raises(AssertionError):
        assert_mirrored(touching(), bent)
