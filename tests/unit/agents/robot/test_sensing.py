"""The ring of eight sensors and the walls, compared with geometry computed by hand (sections 2.2, 2.3)."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from kswarms.agents.common.arrays import Rows
from kswarms.agents.robot.sensing import SECTOR, heads_for, read_sensors, sense, wall_ray, walls_met, wrap

angles = st.floats(-math.pi, math.pi)
coordinates = st.floats(-0.99, 0.99)
RIGHT, LEFT, TOP, BOTTOM = 1, 2, 4, 8
RADIUS = 0.1


@pytest.mark.parametrize(
    ("angle", "wrapped"),
    [(0.0, 0.0), (1.0, 1.0), (-1.0, 1.0), (3.5, -0.5), (-1.5, 0.5), (4.0, 0.0)],  # in half turns
)
def test_wrap(angle: float, wrapped: float) -> None:
    assert wrap(angle * math.pi) == pytest.approx(wrapped * math.pi, abs=1e-12)


@given(st.floats(-100.0, 100.0))
def test_wrapping_keeps_the_direction(angle: float) -> None:
    wrapped = wrap(angle)
    assert -math.pi - 1e-12 < wrapped <= math.pi + 1e-12
    assert math.dist((math.cos(wrapped), math.sin(wrapped)), (math.cos(angle), math.sin(angle))) < 1e-9


@given(coordinates, coordinates, angles)
def test_a_ray_ends_at_a_wall(x: float, y: float, direction: float) -> None:
    dx, dy = math.cos(direction), math.sin(direction)
    distance = wall_ray(x, y, dx, dy, 1.0)
    end = x + distance * dx, y + distance * dy
    assert distance > 0
    assert max(abs(end[0]), abs(end[1])) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("dx", "dy", "distance"), [(1.0, 0.0, 1.5), (-1.0, 0.0, 0.5), (0.0, 1.0, 0.75), (0.0, -1.0, 1.25)]
)
def test_a_ray_along_an_axis(dx: float, dy: float, distance: float) -> None:
    assert wall_ray(-0.5, 0.25, dx, dy, 1.0) == distance


@pytest.mark.parametrize(
    ("x", "y", "heading", "half_angle", "met"),
    [
        (0.95, 0.0, 0.0, 0.0, RIGHT),
        (0.89, 0.0, 0.0, 0.0, 0),
        (0.95, 0.0, math.pi, 0.0, 0),
        (0.95, 0.0, 1.0, 0.0, RIGHT),  # 0.093 m along the heading
        (0.95, 0.0, 1.1, 0.0, 0),  # 0.110 m
        (0.95, 0.0, 1.1, math.pi / 4, RIGHT),  # 0.053 m along the ray at its right
        (0.95, 0.0, -1.1, math.pi / 4, RIGHT),
        (0.95, 0.0, 1.58, math.pi / 4, 0),  # heads away, whatever its rays meet
        (-0.95, 0.0, math.pi, 0.0, LEFT),
        (0.0, 0.95, math.pi / 2, 0.0, TOP),
        (0.0, -0.95, -math.pi / 2, 0.0, BOTTOM),
        (0.95, 0.95, math.pi / 4, 0.0, RIGHT + TOP),
        (-0.95, -0.95, -3 * math.pi / 4, 0.0, LEFT + BOTTOM),
        (0.95, 0.95, 3 * math.pi / 4, 0.0, TOP),
        (0.0, 0.0, 0.3, math.pi / 4, 0),
    ],
)
def test_walls_within_a_tenth_ahead(x: float, y: float, heading: float, half_angle: float, met: int) -> None:
    assert walls_met(x, y, heading, 1.0, 0.1, half_angle) == met


@given(coordinates, coordinates, angles, st.floats(0.01, 3.0))
def test_a_single_ray_meets_the_wall_at_its_end(x: float, y: float, heading: float, reach: float) -> None:
    distance = wall_ray(x, y, math.cos(heading), math.sin(heading), 1.0)
    assume(abs(distance - reach) > 1e-9)
    assert (walls_met(x, y, heading, 1.0, reach, 0.0) != 0) == (distance < reach)


@given(coordinates, coordinates, angles, st.floats(0.01, 1.0), st.floats(0.0, 1.5))
def test_walls_met_lie_ahead(x: float, y: float, heading: float, reach: float, half_angle: float) -> None:
    met = walls_met(x, y, heading, 1.0, reach, half_angle)
    assert heads_for(heading, met) == (met != 0)
    for wall in (RIGHT, LEFT, TOP, BOTTOM):
        assert not met & wall or heads_for(heading, wall)
    # Additional rays never meet fewer walls.
    assert walls_met(x, y, heading, 1.0, reach, 0.0) & ~met == 0


def test_heading_for_a_wall() -> None:
    towards = [(0.0, RIGHT), (1.5, RIGHT), (1.6, LEFT), (-2.0, BOTTOM), (2.0, RIGHT + TOP)]
    away = [(1.6, RIGHT), (-2.0, TOP), (2.0, RIGHT + BOTTOM), (0.0, 0)]
    assert all(heads_for(heading, walls) for heading, walls in towards)
    assert not any(heads_for(heading, walls) for heading, walls in away)


def rows(n: int) -> Rows:
    return np.arange(n, dtype=np.uint32)


def ring(
    heading: float, *others: tuple[float, float], at: tuple[float, float] = (0.0, 0.0), limit: float = 9.0
) -> list[float]:
    """Return the sensor readings in a square of 4 m, with other robots given by bearing and distance."""
    x, y = at
    places = [(x + d * math.cos(heading + b), y + d * math.sin(heading + b)) for b, d in others]
    positions = np.array([at, *places])
    forward, free = (math.cos(heading), math.sin(heading)), np.empty(8)
    sense(0, *forward, *positions.T.copy(), rows(len(positions)), len(positions), RADIUS, 2.0, limit, free)
    return [float(distance) for distance in free]


def test_walls_are_sensed_counter_clockwise_from_ahead() -> None:
    diagonal = 2.0 * math.sqrt(2) - RADIUS
    assert ring(0.0) == pytest.approx([1.9, diagonal] * 4)
    assert ring(math.pi / 2, at=(1.0, 0.0))[:7:2] == pytest.approx([1.9, 2.9, 1.9, 0.9])


@given(angles, st.floats(-0.499, 7.499), st.floats(0.2, 1.5))
def test_a_robot_is_sensed_by_the_sensor_of_its_bearing(heading: float, bearing: float, far: float) -> None:
    assume(abs(bearing % 1.0 - 0.5) > 1e-6)
    alone, seen = ring(heading), ring(heading, (bearing * SECTOR, far))
    sensor = round(bearing)
    assert seen[sensor] == pytest.approx(far - 2 * RADIUS)
    assert seen[:sensor] + seen[sensor + 1 :] == alone[:sensor] + alone[sensor + 1 :]


def test_a_sensor_reports_the_nearest_robot() -> None:
    seen = ring(0.4, (0.1, 0.9), (-0.2, 0.5), (math.pi, 0.7), (0.3, 1.1))
    assert (seen[0], seen[4]) == pytest.approx((0.3, 0.5))


def test_robots_beyond_the_limit_are_skipped() -> None:
    assert ring(0.0, (0.0, 0.71), limit=0.5)[0] == pytest.approx(1.9)
    assert ring(0.0, (0.0, 0.69), limit=0.5)[0] == pytest.approx(0.49)


def test_only_the_given_robots_count() -> None:
    positions = np.array([[0.0, 0.0], [0.5, 0.0], [0.3, 0.0]])
    free = np.empty(8)
    sense(0, 1.0, 0.0, *positions.T.copy(), rows(3), 2, RADIUS, 2.0, 9.0, free)
    assert free[0] == pytest.approx(0.3)


def polar(distance: float, angle: float) -> tuple[float, float]:
    return distance * math.cos(angle), distance * math.sin(angle)


def read(
    positions: list[tuple[float, float]], met: int, heading: float = 0.0, reach: float = 0.3
) -> list[int]:
    forward = math.cos(heading), math.sin(heading)
    nearest, read = np.full(8, reach), np.full(8, -1)
    read_sensors(0, met, *forward, *np.array(positions).T.copy(), RADIUS, 1.0, nearest, read)
    return read.tolist()


def test_an_active_sensor_reads_the_nearest_robot_in_its_sector() -> None:
    # Gaps of 0.2 m ahead and 0.25 m behind it, 0.15 m at the back, and 0.31 m at the left, beyond the range.
    others = [polar(0.4, 0.0), polar(0.45, 0.35), polar(0.35, math.pi), polar(0.51, math.pi / 2)]
    assert read([(0.0, 0.0), *others], met=1) == [1, -1, -1, -1, 3, -1, -1, -1]


def test_the_opponent_is_read_even_if_another_robot_is_nearer() -> None:
    others = [polar(0.3, 0.9), polar(0.25, 1.15)]
    assert read([(0.0, 0.0), *others], met=1) == [-1, 1, -1, -1, -1, -1, -1, -1]
    assert read([(0.0, 0.0), *others], met=2) == [-1, 2, -1, -1, -1, -1, -1, -1]


def test_a_wall_hides_robots_except_the_opponent() -> None:
    # The wall is 0.29 m off along the middle of the sensor ahead; the robot, nearly parallel to it, 0.35 m.
    heading = math.pi / 8
    x, y = polar(0.55, 0.09)
    positions = [(0.0, 0.85), (x, 0.85 + y), (0.0, 0.6)]
    assert read(positions, met=2, heading=heading, reach=0.5)[0] == -1
    assert read(positions, met=1, heading=heading, reach=0.5)[0] == 1
    nearer = [(0.0, 0.85), (0.85 * x, 0.85 + 0.85 * y), (0.0, 0.6)]
    assert read(nearer, met=2, heading=heading, reach=0.5)[0] == 1


@given(st.lists(st.tuples(coordinates, coordinates), min_size=2, max_size=8, unique=True), angles)
def test_the_robots_read_have_the_distances_that_sensors_measure(
    positions: list[tuple[float, float]], heading: float
) -> None:
    forward = math.cos(heading), math.sin(heading)
    free = np.zeros(8)
    columns = np.array(positions).T.copy()
    sense(0, *forward, *columns, rows(len(positions)), len(positions), RADIUS, 1.0, 0.3, free)
    met = min(range(1, len(positions)), key=lambda other: math.dist(positions[0], positions[other]))
    seen = read(positions, met, heading)
    gaps = {other: math.dist(positions[0], positions[other]) - 2 * RADIUS for other in seen if other >= 0}
    assert met in gaps
    for sensor, other in enumerate(seen):
        if other >= 0 and other != met:
            assert gaps[other] == pytest.approx(free[sensor])
            assert gaps[other] <= 0.3
