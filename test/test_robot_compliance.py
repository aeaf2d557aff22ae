# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The robot's compliance in series with the wall, against simulated positions."""

from __future__ import annotations

from contact_estimation.estimators.estimate import ParameterEstimate
from contact_estimation.pipeline.parameters import (
    add_robot_compliance, remove_robot_compliance, RobotParameters)
from core_runs import contact_samples, estimates_of, pipeline_with
import numpy as np
import pytest

C = 2e-5
RIGID = RobotParameters()


@pytest.mark.parametrize('K_e', [5e3, 3e4])
def test_the_estimate_is_that_of_the_wall_behind_a_compliant_robot(K_e: float) -> None:
    samples = [
        s._replace(position=s.position - C * s.force, velocity=float('nan'))
        for s in contact_samples(2.0, K_e=K_e, B_e=K_e * 2e-3, depth=50.0 / K_e,
                                 amplitude=10.0 / K_e)
    ]
    plain, known = (
        estimates_of(samples, pipeline_with(
            estimator='rls_adaptive', contact__force_noise=1e-3, robot__compliance=compliance))[-1]
        for compliance in (0.0, C)
    )
    assert plain.stiffness == pytest.approx(K_e / (1.0 + C * K_e), rel=3e-3)
    assert known.stiffness == pytest.approx(K_e, rel=3e-3)
    assert known.damping == pytest.approx(K_e * 2e-3, rel=0.1)


def test_deviations_are_those_of_drawn_estimates_and_compliances() -> None:
    estimate = ParameterEstimate(2e4, 150.0, 100.0, 5.0, 0.0, 0.0)
    draw = np.random.default_rng(1)
    walls = [
        remove_robot_compliance(
            estimate._replace(stiffness=K, damping=B), RobotParameters(compliance=float(c)))[:2]
        for K, B, c in zip(draw.normal(2e4, 100.0, 4000), draw.normal(150.0, 5.0, 4000),
                           draw.normal(C, 1e-6, 4000))
    ]
    got = remove_robot_compliance(estimate, RobotParameters(compliance=C, compliance_std=1e-6))
    assert (got.stiffness_std, got.damping_std) == pytest.approx(np.std(walls, axis=0), rel=0.05)


def test_an_uncertain_compliance_widens_what_no_residual_shows() -> None:
    estimate = ParameterEstimate(3e4, 100.0, 10.0, 1.0, 0.0, 0.0)
    got = remove_robot_compliance(estimate, RobotParameters(compliance_std=1e-5))
    assert got[:2] == estimate[:2]
    assert got.stiffness_std == pytest.approx(np.hypot(10.0, 3e4**2 * 1e-5))


def test_a_stiffness_beyond_that_of_the_robot_stays_finite_with_a_wide_band() -> None:
    got = remove_robot_compliance(
        ParameterEstimate(6e4, 10.0, 100.0, 1.0, 0.0, 0.0), RobotParameters(C, 0.0))
    assert np.isfinite(got.stiffness) and got.stiffness_std > 0.05 * got.stiffness


def test_the_reference_uses_the_stiffness_between_measured_position_and_force() -> None:
    robot = RobotParameters(compliance=C)
    wall = remove_robot_compliance(ParameterEstimate(2e4, 0.0, 0.0, 0.0, 0.0, 0.0), robot)
    assert add_robot_compliance(wall.stiffness, robot) == pytest.approx(2e4)
    assert add_robot_compliance(2e4, RIGID) == 2e4
