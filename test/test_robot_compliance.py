# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The robot's compliance in series with the wall, against simulated positions."""

from __future__ import annotations

from contact_estimation.estimation.robot_compliance import (
    of_the_wall,
    RobotParameters,
    seen_by_the_robot,
)
from contact_estimation.estimators.estimate import ParameterEstimate
from core_runs import contact_samples, estimates_of, pipeline_with
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


def test_the_reference_uses_the_stiffness_between_measured_position_and_force() -> None:
    robot = RobotParameters(compliance=C)
    wall = of_the_wall(ParameterEstimate(2e4, 0.0, 0.0, 0.0, 0.0, 0.0), robot)
    assert seen_by_the_robot(wall.stiffness, robot) == pytest.approx(2e4)
    assert seen_by_the_robot(2e4, RIGID) == 2e4
