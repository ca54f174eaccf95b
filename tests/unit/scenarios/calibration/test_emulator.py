"""The linear emulator on known functions."""

import numpy as np
import pytest

from kswarms.scenarios.calibration.emulator import Emulator

RNG = np.random.default_rng(1)


def test_linear_outputs_are_predicted() -> None:
    positions, others = RNG.random((40, 6)), RNG.random((100, 6)) * 0.5 + 0.25
    slope = RNG.normal(size=(6, 3))
    emulator = Emulator.fit(positions, 2 + positions @ slope)
    assert emulator.predict(others) == pytest.approx(2 + others @ slope, abs=1e-3)


def test_noise_is_not_learned() -> None:
    """With as many parameters as positions, an unregularized fit would repeat the noise."""
    positions, others = RNG.random((20, 16)), RNG.random((1000, 16))
    noise = RNG.normal(size=(20, 1))
    emulator = Emulator.fit(positions, 10 + noise)
    assert emulator.predict(others).std() < 0.5 * noise.std()
    signal = Emulator.fit(positions, 10 * positions[:, :1] + 0.1 * noise)
    assert np.corrcoef(signal.predict(others)[:, 0], others[:, 0])[0, 1] > 0.9


def test_predictions_stay_within_the_known_outputs() -> None:
    positions = np.array([[0.4], [0.5], [0.6]])
    predicted = Emulator.fit(positions, 10 * positions).predict(np.array([[0.0], [0.5], [1.0]]))
    assert predicted[:, 0] == pytest.approx([4, 5, 6])


def test_equal_positions_and_constant_outputs() -> None:
    same = Emulator.fit(np.full((3, 2), 0.5), np.array([[1.0], [2.0], [3.0]]))
    assert same.predict(np.array([[0.1, 0.9]])) == pytest.approx(np.array([[2.0]]))
    constant = Emulator.fit(RNG.random((5, 2)), np.ones((5, 1)))
    assert constant.predict(RNG.random((4, 2))) == pytest.approx(np.ones((4, 1)))
