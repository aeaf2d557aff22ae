# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A lag of the force: not taken for a surface elsewhere, and contained in the band of B_hat."""

from __future__ import annotations

from contact_estimation.signals.contact_sample import ContactSample
from core_runs import contact_samples, estimates_of, pipeline_with
import pytest

K, B, LAG_SAMPLES, RATE = 4800.0, 240.0, 2, 2000.0  # 1 ms


def late_samples(
    K_e: float = K, B_e: float = B, depth: float = 8e-3, amplitude: float = 1e-3
) -> list[ContactSample]:
    """Return a contact whose force comes 1 ms late."""
    samples = contact_samples(
        3.0, K_e, B_e, depth, amplitude, omega=40.0, force_noise=0.1, rate=RATE)
    forces = [sample.force for sample in samples]
    late = [*forces[:LAG_SAMPLES], *forces[:-LAG_SAMPLES]]
    return [sample._replace(force=force) for sample, force in zip(samples, late)][::4]


@pytest.mark.slow
@pytest.mark.parametrize(
    'estimator', ['multiple_model', 'kalman', 'indirect_adaptive', 'instrumental_variable'])
def test_a_lag_within_its_band_moves_no_surface(estimator: str) -> None:
    last = estimates_of(late_samples(), pipeline_with(estimator=estimator))[-1]
    assert last.location == pytest.approx(0.0, abs=1e-5)
    assert last.stiffness == pytest.approx(K, abs=2.0 * last.stiffness_std)


@pytest.mark.slow
@pytest.mark.parametrize(
    'estimator', ['multiple_model', 'kalman', 'rls_adaptive', 'indirect_adaptive', 'rls'])
def test_the_band_at_the_limit_of_no_damping_contains_the_truth(estimator: str) -> None:
    samples = late_samples(3e4, 15.0, depth=1.5e-3, amplitude=2e-4)  # B_e - K_e tau < 0
    tuning = {'tuning__indirect_adaptive__normalised': True}
    last = estimates_of(samples, pipeline_with(estimator=estimator, **tuning))[-1]
    assert abs(last.damping - 15.0) < 2.0 * last.damping_std
