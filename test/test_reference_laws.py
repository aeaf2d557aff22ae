# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The laws from force to position, alone and in closed loop."""

from __future__ import annotations

from contact_estimation.estimation.parameters import EstimationParameters
from contact_estimation.exceptions import ParameterRangeError
from contact_estimation.parameters.values import build
from contact_estimation.reference.laws import eq20_compliance, series_compliance
from core_runs import closed_loop
import numpy as np
import pytest


def test_eq20_reaches_as_deep_as_the_estimated_spring_bends() -> None:
    assert 50.0 * eq20_compliance(5000.0, 1e4) == pytest.approx(0.01)


def test_series_compliance_makes_two_springs_carry_the_force() -> None:
    K_e, K_t, F_r = 4800.0, 5000.0, 50.0
    x_r = F_r * series_compliance(K_e, K_t)
    _, F_e = np.linalg.solve([[K_t, -1.0], [K_e, 1.0]], [K_t * x_r, 0.0])
    assert -F_e == pytest.approx(F_r)


@pytest.mark.slow
def test_eq20_settles_at_its_static_formula() -> None:
    run = closed_loop({'reference_law': 'eq20'}, experiment='none', duration=8.6)
    F_r, K_hat, K_e, K_t = 50.0, run.last.stiffness, 4800.0, 5000.0
    # K_t (x - F_r / K_hat) - F_e = 0 and F_e + K_e x = 0, in (x, F_e) with x_e = 0.
    _, F_e = np.linalg.solve([[K_t, -1.0], [K_e, 1.0]], [K_t * F_r / K_hat, 0.0])
    assert run.force_at(8.0, 8.5) == pytest.approx(-F_e, rel=0.01)


def test_series_gives_the_wanted_force() -> None:
    run = closed_loop({'reference_law': 'series'})
    assert run.force_at(7.0, 8.5) == pytest.approx(50.0, rel=0.02)


def test_force_tracking_gives_the_wanted_force() -> None:
    run = closed_loop(
        {'reference.robot_force_tracking': True}, {'robot.force_tracking': True}, duration=8.6
    )
    assert run.force_at(7.0, 8.5) == pytest.approx(50.0, rel=0.02)


def test_both_together_are_refused_by_the_parameters() -> None:
    with pytest.raises(ParameterRangeError, match='reference_law series.*force_tracking'):
        build(EstimationParameters,
              {'reference_law': 'series', 'reference.robot_force_tracking': True})
