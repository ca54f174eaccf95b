"""Bodies in contact obey section 2.5, in generated states and in cases with a known outcome."""

import math

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from scipy.spatial.distance import pdist

from kswarms.agents.body import KREMBOT_SIM
from kswarms.agents.common.arrays import Floats
from kswarms.agents.robot.state import ACTION
from tests.reference.contacts import Ground, translate
from tests.reference.states import Scene, clone, crowded, game_of, make_scene, scenes, unit

R = KREMBOT_SIM.radius
STRIDE = 0.015
LARGEST_OVERLAP = 1e-4
EXACT = 1e-12

angles = st.floats(-math.pi, math.pi)
frictions = st.sampled_from((0.0, 0.18, 0.45, 1.5))


def drive(scene: Scene, periods: int = 1) -> Floats:
    """Move the robots of a scene without decisions; return their displacements (m)."""
    before = scene.states.positions.copy()
    advance, tick = scene.kernel().advance, 0
    while tick < periods:
        tick, _ = advance(tick, periods)
    return scene.states.positions - before


# --------------------------------------------------------------------------------------------- general states


def assert_apart(positions: Floats, radius: float, half: float) -> None:
    """Check that no bodies overlap by more than 0.1 mm and all are inside the walls."""
    distance = np.hypot(*(positions[:, None] - positions[None]).T)
    np.fill_diagonal(distance, np.inf)
    assert distance.min() >= 2 * radius - LARGEST_OVERLAP
    assert np.abs(positions).max() <= half - radius + EXACT


@settings(deadline=None, max_examples=150)
@given(scenes())
def test_bodies_stay_apart_and_inside(scene: Scene) -> None:
    scene.states.bodies.phase[:] = ACTION
    scene.states.bodies.carrying[:] = 0
    for _ in range(10):
        drive(scene)
        assert_apart(scene.states.positions, scene.game.body.radius, scene.arena.half)


@settings(deadline=None, max_examples=300)
@given(scenes(), st.integers(0, 2**32 - 1))
def test_the_outcome_does_not_depend_on_the_last_bit(scene: Scene, seed: int) -> None:
    # Stopped bodies touch each other; an overlap of 1e-17 m must have no effect.
    scene = crowded(scene)
    other = clone(scene)
    other.states.positions += np.random.default_rng(seed).uniform(-1e-13, 1e-13, other.states.positions.shape)
    np.testing.assert_allclose(drive(other), drive(scene), rtol=0, atol=1e-9)


@pytest.mark.parametrize("second", [(2 * R - 1.1e-4, 0.0), (1.0 - R + 1e-9, 0.0), (0.5, R - 1.001)])
def test_overlapping_bodies_are_detected(second: tuple[float, float]) -> None:
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
    moved: tuple[float, float] = (0.0, 0.0),
) -> tuple[Scene, Floats]:
    """Return a scene of two robots with a gap, and the unit vector from the first to the second.

    `moved` are their displacements along it in the last period (m).
    """
    normal = unit(direction)
    first = np.array((0.1, -0.05))
    positions = np.array((first, first + (2 * R + gap) * normal))
    game = game_of(2, friction, push_share)
    scene = make_scene(game, positions, np.add(direction, headings), np.array(strides))
    scene.states.bodies.moved_x[:], scene.states.bodies.moved_y[:] = np.outer(normal, moved)
    return scene, normal


def slide(normal: Floats, gap: float, turn: float, friction: float) -> Floats:
    """Return the displacement of a robot that drives at `turn` from `normal` into an obstacle at rest."""
    blocked = max(0.0, STRIDE * math.cos(turn) - gap)
    along = max(0.0, STRIDE * abs(math.sin(turn)) - friction * blocked)
    tangent = np.array((-normal[1], normal[0]))
    return (STRIDE * math.cos(turn) - blocked) * normal + math.copysign(along, turn) * tangent


@settings(deadline=None, max_examples=50)
@given(angles, st.floats(0, 0.01), st.floats(-1.5, 1.5), st.floats(-1.5, 1.5), frictions, st.floats(0, 1))
def test_two_robots_that_drive_apart_are_not_slowed(
    direction: float, gap: float, turn: float, other_turn: float, friction: float, push_share: float
) -> None:
    scene, _ = pair(direction, gap, (math.pi + turn, other_turn), (STRIDE, STRIDE), friction, push_share)
    expected = STRIDE * np.array((unit(direction + math.pi + turn), unit(direction + other_turn)))
    np.testing.assert_allclose(drive(scene), expected, rtol=0, atol=EXACT)


@settings(deadline=None, max_examples=50)
@given(angles, st.floats(0, 0.01), st.floats(-1.5, 1.5), frictions)
def test_a_contact_removes_the_normal_motion_and_friction(
    direction: float, gap: float, turn: float, friction: float
) -> None:
    scene, normal = pair(direction, gap, (turn, 0.0), (STRIDE, 0.0), friction)
    moved = drive(scene)
    np.testing.assert_allclose(moved[0], slide(normal, gap, turn, friction), rtol=0, atol=EXACT)
    assert not moved[1].any()  # a standing robot is not moved


@settings(deadline=None, max_examples=50)
@given(angles, st.floats(0, 0.01), st.floats(0, 1), frictions)
def test_a_robot_that_arrives_pushes_a_standing_one_by_its_momentum(
    direction: float, gap: float, push_share: float, friction: float
) -> None:
    # The drives cancel. In each period, both move by the mean of their last motions, times the push share.
    scene, normal = pair(direction, gap, (0.0, 0.0), (STRIDE, 0.0), friction, push_share, (STRIDE, 0.0))
    common = min(STRIDE - gap / 2, max(gap / 2, push_share * STRIDE / 2))
    expected = np.outer((common + gap / 2, common - gap / 2), normal)
    np.testing.assert_allclose(drive(scene), expected, rtol=0, atol=EXACT)
    for _ in range(3):
        common *= push_share
        np.testing.assert_allclose(drive(scene), np.outer((common, common), normal), rtol=0, atol=EXACT)


@settings(deadline=None, max_examples=50)
@given(angles, st.floats(0, 1), frictions)
def test_a_robot_that_starts_in_contact_pushes_nothing(
    direction: float, push_share: float, friction: float
) -> None:
    scene, _ = pair(direction, 0.0, (0.0, 0.0), (STRIDE, 0.0), friction, push_share)
    np.testing.assert_allclose(drive(scene, 5), 0, atol=EXACT)


@settings(deadline=None, max_examples=50)
@given(angles, st.floats(0, 0.01), frictions, st.floats(-STRIDE, STRIDE))
def test_without_a_push_share_a_standing_robot_is_never_moved(
    direction: float, gap: float, friction: float, moved: float
) -> None:
    scene, normal = pair(direction, gap, (0.0, 0.0), (STRIDE, 0.0), friction, 0.0, (STRIDE, moved))
    np.testing.assert_allclose(drive(scene, 3), (gap * normal, (0, 0)), rtol=0, atol=EXACT)


@settings(deadline=None, max_examples=50)
@given(angles, st.floats(0, 0.01), st.floats(0, 1), st.floats(0, 1))
def test_two_robots_that_meet_share_the_gap_and_then_stand(
    direction: float, gap: float, part: float, push_share: float
) -> None:
    # The slower one takes less than half of the gap if its drive does not reach that far.
    strides = (STRIDE, part * STRIDE)
    scene, normal = pair(direction, gap, (0.0, math.pi), strides, 0.0, push_share)
    slower = min(gap / 2, part * STRIDE)
    free = min(gap - slower, STRIDE)
    np.testing.assert_allclose(drive(scene), np.outer((free, -slower), normal), rtol=0, atol=EXACT)
    # Equal and opposite motions have no momentum.
    scene, _ = pair(direction, 0.0, (0.0, math.pi), (STRIDE, STRIDE), 0.0, push_share, (STRIDE, -STRIDE))
    np.testing.assert_allclose(drive(scene, 3), 0, atol=EXACT)


@settings(deadline=None, max_examples=50)
@given(angles, st.floats(0, 0.002), st.floats(0, 0.8), st.floats(0, 1))
def test_a_follower_does_not_slow_a_slower_robot_down(
    direction: float, gap: float, part: float, push_share: float
) -> None:
    # With momentum it pushes the slower one.
    slow = part * STRIDE
    scene, normal = pair(direction, gap, (0.0, 0.0), (STRIDE, slow), 0.0, push_share, (STRIDE, slow))
    moved = drive(scene) @ normal
    assert slow - EXACT <= moved[1] <= STRIDE + EXACT
    assert moved[0] - moved[1] == pytest.approx(gap, abs=EXACT)
    common = np.clip(push_share * (STRIDE + slow) / 2, slow + gap / 2, STRIDE - gap / 2)
    np.testing.assert_allclose(moved, (common + gap / 2, common - gap / 2), rtol=0, atol=EXACT)


@settings(deadline=None, max_examples=50)
@given(st.integers(0, 3), st.floats(0, 0.01), st.floats(-1.5, 1.5), frictions, st.floats(0, 1))
def test_a_wall_removes_the_normal_motion_and_friction(
    side: int, gap: float, turn: float, friction: float, push_share: float
) -> None:
    outwards = unit(side * math.pi / 2).round()
    scene = make_scene(
        game_of(1, friction, push_share), [(1 - R - gap) * outwards], [side * math.pi / 2 + turn], STRIDE
    )
    np.testing.assert_allclose(drive(scene)[0], slide(outwards, gap, turn, friction), rtol=0, atol=EXACT)


# ----------------------------------------------------------------------------------------------------- wedges


@pytest.mark.parametrize("aside", [0.001, 0.002, -0.01])
@pytest.mark.parametrize("turn", [0.0, 0.3, 2.0, -2.8])
def test_a_wedge_gives_way_a_little(turn: float, aside: float) -> None:
    # A robot drives through the gap between two robots at rest, which is narrower than a body.
    turned = np.array((unit(turn), unit(turn + math.pi / 2)))
    positions = np.array(((0.0, 1.75 * R), (0.0, -1.75 * R), (-1.1 * R, aside))) @ turned
    game = game_of(3)
    scene = make_scene(game, positions, [0.0, 0.0, turn], np.array((0.0, 0.0, STRIDE)))
    moved = drive(scene, 60) @ turned.T
    assert moved[2, 0] > 2 * R
    assert min(moved[0, 1], -moved[1, 1]) > 0.1 * R
    # Half a radius in all is enough.
    assert moved[0, 1] - moved[1, 1] == pytest.approx(0.5 * R, abs=0.01 * R)
    # Relaxation without momentum gives the same displacements.
    plain = Ground(R, game.side / 2, game.parameters.friction, 0.0, max_momentum=0.0)
    slow, last = positions.copy(), np.zeros_like(positions)
    for _ in range(60):
        translate(slow, last, STRIDE * np.array(((0, 0), (0, 0), unit(turn))), plain)
    given_way = (slow - positions) @ turned.T
    np.testing.assert_allclose(moved[:2], given_way[:2], rtol=0, atol=0.01 * R)


@pytest.mark.parametrize("across", [0.0, 0.4, 1 - R])
@pytest.mark.parametrize("turn", [0.0, math.pi / 2, math.pi, -math.pi / 2])
def test_a_straight_row_from_wall_to_wall_gives_way(turn: float, across: float) -> None:
    # Twelve robots exactly in line, in a row with room for fewer; one of them drives.
    along = np.linspace(R - 1, 1 - R, 12)
    turned = np.array((unit(turn), unit(turn + math.pi / 2)))
    positions = np.column_stack((along, np.full(12, across))) @ turned
    scene = make_scene(game_of(12), positions, np.full(12, turn), STRIDE * (np.arange(12) == 3))
    drive(scene)
    assert pdist(scene.states.positions).min() > 2 * R - LARGEST_OVERLAP
    assert np.abs(scene.states.positions).max() <= 1 - R + EXACT


def test_bodies_that_cannot_be_separated_are_an_error() -> None:
    # A hundred bodies with a radius for which they would cover more than the arena.
    side = np.linspace(R - 1, 1 - R, 10)
    scene = make_scene(game_of(100), np.array([(x, y) for x in side for y in side]), 0.0, STRIDE)
    kernel = scene.kernel()
    kernel.blocks.scalars["radius"] = 0.11
    assert kernel.advance(0, 1)[0] == 0  # stops at the first decision
    with pytest.raises(ValueError, match="overlapping bodies cannot be separated"):
        kernel.advance(0, 1)


@settings(deadline=None, max_examples=20)
@given(angles, st.floats(-0.4, 0.4), st.floats(-0.01, 0.01), st.floats(-0.01, 0.01), frictions)
@example(0.0, 0.375, 0.0, 0.0, 1.5)  # it drives away from one of them, which follows and must not hold it
def test_a_robot_between_two_is_not_frozen(
    direction: float, turn: float, above: float, below: float, friction: float
) -> None:
    # Two robots drive at each other; the third, between them, drives across, too steeply for friction.
    turned = np.array((unit(direction), unit(direction + math.pi / 2)))
    positions = np.array(((-2.01 * R, above), (2.01 * R, below), (0.0, 0.0))) @ turned
    headings = [direction, direction + math.pi, direction + math.pi / 2 + turn]
    scene = make_scene(game_of(3, friction), positions, headings, STRIDE)
    assert drive(scene, 60)[2] @ turned[1] > R


@settings(deadline=None, max_examples=20)
@given(st.floats(-0.3, 0.3), st.floats(-0.4, 0.4), frictions)
@example(0.3, -0.4, 1.5)  # held
def test_a_robot_between_a_wall_and_another_is_held_by_friction_alone(
    turn: float, place: float, friction: float
) -> None:
    # The robot drives along the wall, partly into it or into the robot that presses it there. Its heading
    # and the tangent of that contact differ by turn - place; friction holds it if μ tan(turn - place) > 1.
    held = friction * math.tan(turn - place)
    assume(abs(held - 1) > 0.02)
    positions = (1 - R, 0.0) - np.outer((0, 2.01 * R), unit(place))
    scene = make_scene(game_of(2, friction), positions, [math.pi / 2 + turn, 0.0], STRIDE)
    assert (drive(scene, 60)[0, 1] > R) == (held < 1)
