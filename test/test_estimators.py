# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Contracts of all estimators, the Kalman filter, and the refined signal processing."""

from functools import lru_cache
from itertools import product
from math import isfinite
from typing import Any

from contact_estimation.estimators import ESTIMATORS, OFFLINE_ESTIMATORS
from contact_estimation.estimators.estimate import EstimateStatus
from contact_estimation.estimators.kalman import Kalman, KalmanParameters
from contact_estimation.estimators.offline_estimator import OfflineEstimate, TargetImpedance
from contact_estimation.estimators.parameters import EnvironmentParameters
from contact_estimation.estimators.three_states import correct, Covariance
from contact_estimation.parameters import specifications
from contact_estimation.signals.contact_sample import ContactRecording
from contact_estimation.studies.paper_cases import step_recording
from contact_estimation.studies.testbed_arm import B_E, K_E
from core_runs import (
    closed_loop, contact_samples, estimates_of, known, learn, PAPER_SENSORS, pipeline_with)
from filterpy.kalman import KalmanFilter
import numpy as np
from numpy.typing import NDArray
import pytest

EACH = pytest.mark.parametrize('name', ESTIMATORS)
SAMPLES = contact_samples(2.5, force_noise=0.3)


@pytest.fixture(scope='module', params=ESTIMATORS)
def estimates(request: pytest.FixtureRequest) -> Any:
    return estimates_of(SAMPLES, pipeline_with(estimator=request.param))


def test_sine_contact_gives_the_stiffness(estimates: Any) -> None:
    assert estimates[-1].stiffness == pytest.approx(4800.0, rel=0.02)


def test_sine_contact_gives_the_damping(estimates: Any) -> None:
    assert estimates[-1].damping == pytest.approx(200.0, rel=0.06)


def test_status_is_free_before_contact(estimates: Any) -> None:
    before = [e for e, s in zip(estimates, SAMPLES) if s.position < 0.0]
    assert {e.status for e in before} == {EstimateStatus.FREE}


def test_claimed_std_is_never_negative_nor_infinite(estimates: Any) -> None:
    claimed = np.array([e[3:5] for e in estimates])
    claimed = claimed[~np.isnan(claimed)]  # nothing is claimed before a row was learned
    assert len(claimed) > len(estimates)
    assert np.all(claimed >= 0.0) and np.all(np.isfinite(claimed))


def test_stiffness_damping_and_location_are_always_finite(estimates: Any) -> None:
    assert all(isfinite(v) for e in estimates for v in (e.stiffness, e.damping, e.location))


@pytest.mark.slow
@EACH
def test_paper_s_loop_ends_within_the_paper_s_errors(name: str) -> None:
    last = closed_loop({'estimator': name}, PAPER_SENSORS).last
    rtol = 0.1 if name == 'hunt_crossley' else 0.03  # whose law is another
    np.testing.assert_allclose([last.stiffness, last.damping], [4800.0, 200.0], rtol=rtol)


@EACH
def test_tuning_says_what_every_parameter_means(name: str) -> None:
    assert all(len(s.description) > 8 for s in specifications(ESTIMATORS[name].Parameters))


@EACH
def test_tuning_bounds_every_number(name: str) -> None:
    numbers = [s for s in specifications(ESTIMATORS[name].Parameters)
               if type(s.default) in (int, float)]
    assert all(s.minimum is not None for s in numbers)


@EACH
def test_start_from_begins_at_the_given_values(name: str) -> None:
    cls = ESTIMATORS[name]
    estimator = cls(cls.Parameters(), EnvironmentParameters(), 0.002)
    estimator.start_from(7000.0, 80.0)
    assert (estimator.stiffness, estimator.damping) == (7000.0, 80.0)


@pytest.mark.slow
def test_other_sample_rates_give_the_stiffness_too() -> None:
    for name in ESTIMATORS:
        for rate in [125.0, 1000.0]:
            pipeline = pipeline_with(estimator=name, sample_rate=rate)
            last = estimates_of(contact_samples(2.0, rate=rate), pipeline)[-1]
            assert last.stiffness == pytest.approx(4800.0, rel=0.03), (name, rate)


K, B, T = 4800.0, 200.0, 0.002


def estimator(**tuning: Any) -> Kalman:
    """Make a filter with the default first guess."""
    return Kalman(KalmanParameters(**tuning), EnvironmentParameters(), T)


def rows_of(count: int, shift: float = 0.0) -> NDArray[np.float64]:
    """Noisy rows (y, delta, v, 1) of a sine contact with a wall that is `shift` away."""
    t = T * np.arange(count)
    d, v = 0.01 + 0.002 * np.sin(20.0 * t), 0.04 * np.cos(20.0 * t)
    noise = 0.5 * np.random.default_rng(10).standard_normal(count)
    return np.column_stack([K * (d - shift) + B * v + noise, d, v, np.ones(count)])


def test_free_filter_equals_that_of_filterpy() -> None:
    tuning = {'stiffness_std': 1e3, 'damping_std': 10.0, 'location_std': 2e-5}
    q, R = KalmanParameters(**tuning), 0.25  # far from all limits
    kalman = estimator(**tuning)
    peer = KalmanFilter(dim_x=3, dim_z=1)
    peer.x = np.array([[3000.0], [50.0], [0.0]])
    peer.P = np.diag([1e3, 10.0, q.location_std * 3000.0]) ** 2
    for y, d, v, c in rows_of(200).tolist():
        K_hat, B_hat, _ = peer.x[:, 0]
        walk = [q.relative_walk * K_hat, q.relative_walk * max(B_hat, 50.0),
                q.location_walk * K_hat]
        peer.predict(Q=T * np.diag(walk) ** 2)
        peer.update(y, R=R, H=np.array([[d, v, -c]]))
        learn(kalman, T, (y, d, v, c), R)
        now = known(kalman)
        got = [now.stiffness, now.damping, now.location_shift, now.stiffness_std, now.damping_std]
        x, P = peer.x[:, 0], peer.P
        expected = [x[0], x[1], x[2] / x[0], P[0, 0] ** 0.5, P[1, 1] ** 0.5]
        np.testing.assert_allclose(got, expected, rtol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize('wall', [1e-3, -1e-3])
def test_closed_loop_recovers_a_wall_that_is_1_mm_elsewhere(wall: float) -> None:
    run = closed_loop(
        {'estimator': 'kalman', 'tuning.kalman.location_std': 1e-3},
        {**PAPER_SENSORS, 'environment.location': wall})
    assert run.last.location == pytest.approx(wall, abs=1e-4)


@pytest.mark.slow
def test_claimed_std_is_within_a_factor_2_of_the_errors_over_20_seeds() -> None:
    errors = []
    for seed in range(20):
        # No lag and no error of x_e, which the bands would have to contain.
        pipeline = pipeline_with(
            estimator='kalman', contact__force_noise=1.0, synchronisation__timing_std=0.0,
            environment__location_std=0.0)
        samples = contact_samples(0.7, K, B, force_noise=1.0, seed=seed)
        last = estimates_of(samples, pipeline)[-1]
        errors.append([last.stiffness - K, last.damping - B])
    spread = np.sqrt(np.mean(np.square(errors), axis=0))
    ratio = spread / [last.stiffness_std, last.damping_std]
    assert np.all((ratio > 0.5) & (ratio < 2.0)), ratio


UPPER = np.triu_indices(3)
X, H, R = (1.0, -2.0, 0.5), (0.3, 1.1, -0.7), 0.4


def random_covariance(seed: int) -> tuple[NDArray[np.float64], Covariance]:
    """Draw a positive definite matrix."""
    root = np.random.default_rng(seed).standard_normal((3, 3))
    P = root @ root.T
    return P, tuple(P[UPPER].tolist())


@pytest.mark.parametrize('free', list(product([True, False], repeat=3)))
def test_correction_equals_the_schmidt_kalman_filter(free: tuple[bool, bool, bool]) -> None:
    P, triangle = random_covariance(1)
    mask, h = np.array(free), np.array(H)
    gain = P @ h / (h @ P @ h + R) * mask
    # Joseph's form holds for any gain, so also for one that is 0 at consider states.
    left = np.eye(3) - np.outer(gain, h)
    expected = left @ P @ left.T + R * np.outer(gain, gain)
    x, got, spread = correct(X, triangle, H, 0.9, R, free)
    np.testing.assert_allclose(x, np.array(X) + gain * 0.9, rtol=1e-12)
    np.testing.assert_allclose(got, expected[UPPER], rtol=1e-12, atol=1e-12)
    assert spread == pytest.approx(h @ P @ h + R)


TARGET = TargetImpedance()
recorded = lru_cache(maxsize=None)(step_recording)


def estimate(name: str, recording: ContactRecording) -> OfflineEstimate:
    """Run one of the methods with the paper's target impedance."""
    return OFFLINE_ESTIMATORS[name](TARGET).estimate(recording)


@pytest.mark.slow
def test_as_written_it_shows_the_paper_s_stiffness_error() -> None:
    errors = [100.0 * (estimate('signal_processing', recorded(s)).stiffness / K_E - 1.0)
              for s in range(3)]
    assert all(12.0 < error < 15.0 for error in errors)


@pytest.mark.slow
@pytest.mark.parametrize('seed', range(3))
def test_refined_it_is_within_three_standard_deviations(seed: int) -> None:
    found = estimate('signal_processing_refined', recorded(seed))
    assert abs(found.stiffness - K_E) < min(3.0 * found.stiffness_std, 0.015 * K_E)
    assert abs(found.damping - B_E) < min(3.0 * found.damping_std, 0.03 * B_E)
