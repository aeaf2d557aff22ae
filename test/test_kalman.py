# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The Kalman filter and its corrections against plain matrices and the spread over seeds."""

from __future__ import annotations

from itertools import product
from typing import Any

from contact_estimation.estimators.kalman import Kalman, KalmanParameters
from contact_estimation.estimators.parameters import EnvironmentParameters
from contact_estimation.estimators.three_states import correct, Covariance
from core_runs import closed_loop, contact_samples, estimates_of, PAPER_SENSORS, pipeline_with
from core_steps import known, learn
from filterpy.kalman import KalmanFilter
import numpy as np
from numpy.typing import NDArray
import pytest

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
        {**PAPER_SENSORS, 'environment.location': wall},
    )
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
