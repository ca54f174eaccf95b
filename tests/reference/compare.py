"""Comparison of the compiled kernel with the reference."""

import math
from collections.abc import Callable

import numpy as np

from kswarms.agents.common.arrays import Records
from kswarms.agents.robot.state import RobotStates
from kswarms.model.kernel.arrays import CONFLICT, HOMING, PICK_UP
from kswarms.model.kernel.kernel import Kernel
from tests.reference.kernel import Event, ReferenceKernel, State

PRECISION = 1e-9
"""Tolerance (m, rad); a jam amplifies rounding errors."""


def assert_same_events(found: Records, expected: list[Event]) -> None:
    """Compare events: order, kinds, and the fields that a kind uses."""
    assert [(event["robot"], event["kind"]) for event in found] == [event[:2] for event in expected]
    for event, reference in zip(found, expected, strict=True):
        if reference.kind == PICK_UP:
            assert event["other"] == reference.other, reference
        elif reference.kind == HOMING:
            assert _same_angle(event["angle"], reference.angle), reference
        elif reference.kind == CONFLICT:
            assert (event["active"], event["vacant"]) == (reference.active, reference.vacant), reference
            assert any(
                event["other"] == other and _same_angle(event["angle"], angle)
                for other, angle in reference.rivals
            ), reference


def _same_angle(angle: float, other: float) -> bool:
    return abs(math.remainder(angle - other, 2 * math.pi)) < PRECISION


def assert_same_state(states: RobotStates, expected: State) -> None:
    """Compare positions, motions and headings; check that the stored direction is that of the heading."""
    np.testing.assert_allclose(states.positions, expected.positions, rtol=0, atol=PRECISION)
    bodies = states.bodies
    moved = np.column_stack((bodies.moved_x, bodies.moved_y))
    np.testing.assert_allclose(moved, expected.moved, rtol=0, atol=PRECISION)
    np.testing.assert_allclose(bodies.heading, expected.heading, rtol=0, atol=PRECISION)
    np.testing.assert_allclose(bodies.forward_x, np.cos(expected.heading), rtol=0, atol=PRECISION)
    np.testing.assert_allclose(bodies.forward_y, np.sin(expected.heading), rtol=0, atol=PRECISION)


def compared(
    kernel: Kernel, reference: ReferenceKernel, states: RobotStates, calls: list[int]
) -> Callable[[int, int], tuple[int, int]]:
    """Return the kernel's `advance` with a comparison of each call to the reference.

    Each call starts the reference from the kernel's state and adds the number of its periods to `calls`.
    """
    advance = kernel.advance

    def advance_both(tick: int, until: int) -> tuple[int, int]:
        state = State.of(states)
        reference.supply = kernel.supply.tolist()
        expected_tick, expected = reference.advance(state, tick, until)
        reached, size = advance(tick, until)
        assert reached == expected_tick
        assert_same_events(kernel.events[:size], expected)
        assert_same_state(states, state)
        calls.append(reached - tick)
        return reached, size

    return advance_both
