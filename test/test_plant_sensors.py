# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Sensors: seeded noise in independent streams, and quantisation."""

from __future__ import annotations

from typing import Any

from contact_estimation.plant.sensors import Sensors
from contact_estimation.plant.world import Truth
import numpy as np
from numpy.typing import NDArray
import pytest
from world_reference import plant_with

NOISY: dict[str, Any] = {
    'sensors__force_noise': 1.0, 'sensors__position_noise': 1e-5, 'sensors__velocity_noise': 1e-3,
}


def measured(count: int = 3000, **values: Any) -> NDArray[np.float64]:
    """Measure 12.3 mm, 0.2 m/s and -49 N, which the sensor takes for -50 N; (count, 3)."""
    sensors = Sensors(plant_with(**values))
    return np.array([
        sensors.measure(Truth(0.002 * k, 0.0123, 0.2, 0.0, -49.0, -50.0)) for k in range(count)
    ])


@pytest.mark.parametrize('off, column', [('force', 0), ('position', 1), ('velocity', 2)])
def test_switching_one_noise_off_leaves_the_others(off: str, column: int) -> None:
    rest = [k for k in range(3) if k != column]
    quiet = measured(**{**NOISY, f'sensors__{off}_noise': 0.0})
    np.testing.assert_array_equal(quiet[:, rest], measured(**NOISY)[:, rest])


def test_normal_noise_has_the_given_standard_deviation() -> None:
    np.testing.assert_allclose(measured(**NOISY).std(axis=0), [1.0, 1e-5, 1e-3], rtol=0.05)


def test_uniform_noise_has_the_spread_of_a_uniform_distribution() -> None:
    error = measured(**NOISY, sensors__distribution='uniform')[:, 0] + 50.0
    assert np.std(error) == pytest.approx(1.0 / np.sqrt(3.0), rel=0.03)


def test_position_is_quantised_after_its_noise() -> None:
    x = measured(**NOISY, sensors__position_quantisation=5e-6)[:, 1] / 5e-6
    np.testing.assert_allclose(x, np.round(x), atol=1e-6)
    assert len(set(np.round(x))) > 3


def test_velocity_is_nan_where_it_is_not_published() -> None:
    assert np.all(np.isnan(measured(5, sensors__publish_velocity=False)[:, 2]))
