# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The environment equations against springs and dampers worked out by hand."""

from __future__ import annotations

from contact_estimation.estimators.contact_model import kelvin_voigt_force
from contact_estimation.exceptions import ParameterRangeError, SignalShapeError
import numpy as np
import pytest


def test_force_on_a_pressing_tool_is_negative_by_hand() -> None:
    assert kelvin_voigt_force(0.01, 0.1, 4800.0, 200.0) == pytest.approx(-(48.0 + 20.0))


def test_wall_cannot_pull_while_withdrawing_inside_the_surface() -> None:
    speeds = np.linspace(-10.0, 10.0, 401)
    force = kelvin_voigt_force(np.full(401, 0.001), speeds, 4800.0, 200.0)
    assert np.all(force <= 0.0)
    assert np.all(force[speeds < -4.8 / 200.0 - 1e-9] == 0.0)


def test_different_shapes_are_refused() -> None:
    with pytest.raises(SignalShapeError, match=r'one shape, got \(3,\) and \(2,\)'):
        kelvin_voigt_force([1.0, 2.0, 3.0], [1.0, 2.0], 4800.0, 200.0)


@pytest.mark.parametrize('K_e', [0.0, -5.0, float('nan')])
def test_stiffness_that_is_not_positive_is_refused(K_e: float) -> None:
    with pytest.raises(ParameterRangeError, match='K_e must be > 0 N/m'):
        kelvin_voigt_force(0.0, 0.0, K_e, 0.0)
