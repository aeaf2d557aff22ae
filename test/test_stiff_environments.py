# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Stiff walls at 500 Hz with positions read to a micrometre: what is claimed, and what is not."""

from __future__ import annotations

from typing import Any

from contact_estimation.estimators.estimate import Estimate, EstimateStatus
from contact_estimation.pipeline.axis_pipeline import LOCATING
from contact_estimation.signals.contact_sample import ContactSample
from core_runs import closed_loop, contact_samples, estimates_of, pipeline_with
import numpy as np
import pytest

RESOLUTION = 1e-6
SENSORS = {
    'sensors.force_noise': 1.0, 'sensors.distribution': 'uniform',
    'sensors.position_quantisation': RESOLUTION, 'sensors.publish_velocity': False,
}
TUNING: dict[str, dict[str, Any]] = {
    'multiple_model': {},
    'rls': {},
    'kalman': {},
    'indirect_adaptive': {'tuning.indirect_adaptive.normalised': True},
}
EACH = pytest.mark.parametrize('name', TUNING)
STIFF = pytest.mark.parametrize('K_e', [1e5, 1e6])
FORCE_STD = 0.58


def gentle_samples(
    K_e: float, B_e: float = 200.0, amplitude: float = 8.0, seed: int = 0
) -> list[ContactSample]:
    """Touch softly, then 50.4 N and a slow sine, positions rounded, velocity not measured."""
    samples = contact_samples(
        2.0, K_e, B_e, depth=50.4 / K_e, amplitude=amplitude / K_e, force_noise=FORCE_STD,
        with_velocity=False, seed=seed,
    )
    return [s._replace(position=round(s.position / RESOLUTION) * RESOLUTION) for s in samples]


def gentle(name: str, K_e: float, **settings: Any) -> list[Estimate]:
    """Estimate on the soft touch, the location known."""
    named = {key.replace('.', '__'): value for key, value in TUNING[name].items()}
    pipeline = pipeline_with(estimator=name, tuning__kalman__location_std=0.0, **named)
    return estimates_of(gentle_samples(K_e, **settings), pipeline)


@pytest.mark.slow
@EACH
@pytest.mark.parametrize('K_e, B_e, experiment', [
    (1e5, 200.0, 'sine'), (1e5, 2000.0, 'none'), (1e6, 200.0, 'none'), (1e6, 2000.0, 'sine')])
def test_closed_loop_errors_are_within_3_claimed_std(
    name: str, K_e: float, B_e: float, experiment: str
) -> None:
    # Bouncing at touch-down, up to 583 N, is what excites here.
    world = {**SENSORS, 'environment.stiffness': K_e, 'environment.damping': B_e}
    last = closed_loop({'estimator': name, **TUNING[name]}, world, experiment).last
    assert abs(last.stiffness - K_e) < 3.0 * last.stiffness_std
    assert abs(last.damping - B_e) < 3.0 * last.damping_std


@pytest.mark.slow
@pytest.mark.parametrize('name, share', [
    ('multiple_model', 0.02), ('rls', 0.02), ('kalman', 0.02),
    ('indirect_adaptive', 0.15),  # a gradient follows the noise of the last rows, and says so
])
@STIFF
def test_closed_loop_claims_the_stiffness(name: str, share: float, K_e: float) -> None:
    world = {**SENSORS, 'environment.stiffness': K_e}
    without_lag = {'synchronisation.timing_std': 0.0}  # these sensors have none
    last = closed_loop({'estimator': name, **TUNING[name], **without_lag}, world, 'sine').last
    assert last.stiffness_std < share * K_e


@EACH
@pytest.mark.parametrize('K_e, B_e, amplitude', [
    (1e5, 200.0, 0.0), (1e5, 5000.0, 0.0), (1e6, 200.0, 0.0), (1e6, 200.0, 8.0),
    (1e6, 5000.0, 0.0),
])
def test_soft_touch_says_how_badly_damping_can_be_told(
    name: str, K_e: float, B_e: float, amplitude: float
) -> None:
    # 200 N s/m times 20 rad/s times 8 N / 1e6 N/m: 0.03 N, far below the noise.
    last = gentle(name, K_e, B_e=B_e, amplitude=amplitude)[-1]
    if name == 'multiple_model' and not amplitude and last.reason == LOCATING:
        return  # at rest 50 um inside a surface told within 2 mm, nothing may be known of K_e
    assert last.status is EstimateStatus.ESTIMATING
    assert abs(last.damping - B_e) < 3.0 * last.damping_std


@EACH
@pytest.mark.parametrize('K_e, B_e', [(1e5, 200.0), (1e5, 5000.0), (1e6, 200.0), (1e6, 5000.0)])
def test_rows_of_a_contact_at_rest_teach_no_damping(name: str, K_e: float, B_e: float) -> None:
    if name != 'multiple_model':  # which needs no such rule: its prior holds what is not told
        last = gentle(name, K_e, B_e=B_e, amplitude=0.0)[-1]
        assert last.reason == 'damping frozen: weak excitation'


@EACH
@pytest.mark.parametrize('K_e, B_e', [(1e5, 200.0), (1e5, 5000.0), (1e6, 5000.0)])
def test_damping_that_the_sine_tells_is_within_3_claimed_std(
    name: str, K_e: float, B_e: float
) -> None:
    last = gentle(name, K_e, B_e=B_e)[-1]
    assert last.reason == '' and abs(last.damping - B_e) < 3.0 * last.damping_std


@EACH
def test_damping_that_was_never_told_has_a_band_as_wide_as_itself(name: str) -> None:
    assert gentle(name, 1e6)[-1].damping_std > 200.0


@pytest.mark.slow
@EACH
@pytest.mark.parametrize('K_e, B_e, amplitude', [
    (1e5, 200.0, 0.0), (1e5, 5000.0, 8.0), (1e6, 200.0, 8.0), (1e6, 5000.0, 0.0)])
def test_stiffness_of_a_soft_touch_is_within_2_claimed_std(
    name: str, K_e: float, B_e: float, amplitude: float
) -> None:
    # The reading at rest is off by a constant 0.4 micrometre: 0.8 % of K_e at 1e6 N/m.
    for seed in range(3):
        last = gentle(name, K_e, B_e=B_e, amplitude=amplitude, seed=seed)[-1]
        if last.reason != LOCATING:  # 50 micrometres within a surface known to 2 mm claim nothing
            assert abs(last.stiffness - K_e) < 2.0 * last.stiffness_std


@EACH
def test_claim_is_of_use_all_the_same(name: str) -> None:
    assert gentle(name, 1e6)[-1].stiffness_std < 0.05e6


@pytest.mark.slow
@EACH
def test_sensor_that_reads_exactly_0_out_of_contact_does_not_make_sure(name: str) -> None:
    errors, claims = [], []
    for seed in range(12):
        samples = [
            s if s.position > 0.0 else s._replace(force=0.0)
            for s in contact_samples(1.0, force_noise=FORCE_STD, seed=seed)
        ]
        named = {key.replace('.', '__'): value for key, value in TUNING[name].items()}
        pipeline = pipeline_with(estimator=name, contact__minimum_force=3.0,
                                 synchronisation__timing_std=0.0, **named)
        last = estimates_of(samples, pipeline)[-1]
        errors.append([last.stiffness - 4800.0, last.damping - 200.0])
        claims.append([last.stiffness_std, last.damping_std])
    ratio = np.sqrt(np.mean(np.square(errors), 0)) / np.mean(claims, 0)
    assert np.all((ratio > 0.2) & (ratio < 2.0)), ratio
