# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The robot's compliance in series with the wall, against simulated positions."""

from __future__ import annotations

from core_runs import contact_samples, estimates_of, pipeline_with
import pytest

C = 2e-5


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
