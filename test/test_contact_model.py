# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The environment equations against springs and dampers worked out by hand."""

from __future__ import annotations

from contact_estimation.estimators.contact_model import kelvin_voigt_force
from contact_estimation.exceptions import ParameterRangeError, SignalShapeError
import numpy as np
import pytest


def test_pressing_force_has_stiffness_and_damping_as_its_slopes() -> None:
    d, v, h = 0.01, 0.02, 1e-6
    slope_K = (kelvin_voigt_force(d + h, v, 4800.0, 200.0)
               - kelvin_voigt_force(d - h, v, 4800.0, 200.0)) / (2.0 * h)
    slope_B = (kelvin_voigt_force(d, v + h, 4800.0, 200.0)
               - kelvin_voigt_force(d, v - h, 4800.0, 200.0)) / (2.0 * h)
    np.testing.assert_allclose([slope_K, slope_B], [-4800.0, -200.0], rtol=1e-7)


def test_force_on_a_pressing_tool_is_negative_by_hand() -> None:
    assert kelvin_voigt_force(0.01, 0.1, 4800.0, 200.0) == pytest.approx(-(48.0 + 20.0))


@pytest.mark.parametrize('delta', [0.0, -1e-9, -0.1])
def test_there_is_no_force_before_the_surface_whatever_the_speed(delta: float) -> None:
    assert kelvin_voigt_force(delta, 5.0, 4800.0, 200.0) == 0.0


def test_wall_cannot_pull_while_withdrawing_inside_the_surface() -> None:
    speeds = np.linspace(-10.0, 10.0, 401)
    force = kelvin_voigt_force(np.full(401, 0.001), speeds, 4800.0, 200.0)
    assert np.all(force <= 0.0)
    assert np.all(force[speeds < -4.8 / 200.0 - 1e-9] == 0.0)


def test_arrays_give_what_scalars_give() -> None:
    random = np.random.default_rng(1)
    d, v = random.normal(0.0, 0.01, 50), random.normal(0.0, 0.1, 50)
    one_by_one = [float(kelvin_voigt_force(a, b, 4800.0, 200.0)) for a, b in zip(d, v)]
    np.testing.assert_array_equal(kelvin_voigt_force(d, v, 4800.0, 200.0), one_by_one)


def test_different_shapes_are_refused() -> None:
    with pytest.raises(SignalShapeError, match=r'one shape, got \(3,\) and \(2,\)'):
        kelvin_voigt_force([1.0, 2.0, 3.0], [1.0, 2.0], 4800.0, 200.0)


@pytest.mark.parametrize('K_e', [0.0, -5.0, float('nan')])
def test_stiffness_that_is_not_positive_is_refused(K_e: float) -> None:
    with pytest.raises(ParameterRangeError, match='K_e must be > 0 N/m'):
        kelvin_voigt_force(0.0, 0.0, K_e, 0.0)


@pytest.mark.parametrize('B_e', [-1e-9, float('nan')])
def test_negative_damping_is_refused(B_e: float) -> None:
    with pytest.raises(ParameterRangeError, match='B_e must be >= 0 N s/m'):
        kelvin_voigt_force(0.0, 0.0, 1.0, B_e)
