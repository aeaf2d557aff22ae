# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The Kalman filter against a plain recursion, a displaced wall and the spread over seeds."""

from __future__ import annotations

from typing import Any

from contact_estimation.estimators.estimate import Frozen
from contact_estimation.estimators.kalman import Kalman, KalmanParameters
from contact_estimation.estimators.parameters import EnvironmentParameters
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


def test_free_filter_equals_the_textbook_recursion() -> None:
    tuning = {'stiffness_std': 1e3, 'damping_std': 10.0, 'location_std': 2e-5}
    q, R = KalmanParameters(**tuning), 0.25  # far from all limits
    kalman = estimator(**tuning)
    x = np.array([3000.0, 50.0, 0.0])
    P = np.diag([1e3, 10.0, q.location_std * 3000.0]) ** 2
    for y, d, v, c in rows_of(200).tolist():
        walk = [q.relative_walk * x[0], q.relative_walk * max(x[1], 50.0), q.location_walk * x[0]]
        P = P + T * np.diag(walk) ** 2
        H = np.array([d, v, -c])
        gain = P @ H / (H @ P @ H + R)
        x, P = x + gain * (y - H @ x), P - np.outer(gain, H @ P)
        learn(kalman, T, (y, d, v, c), R)
    expected = [x[0], x[1], x[2] / x[0], P[0, 0] ** 0.5, P[1, 1] ** 0.5]
    now = known(kalman)
    got = [now.stiffness, now.damping, now.location_shift, now.stiffness_std, now.damping_std]
    np.testing.assert_allclose(got, expected, rtol=1e-6)


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
@pytest.mark.parametrize('wall', [1e-3, -1e-3])
def test_wall_that_is_1_mm_elsewhere_leaves_the_stiffness_right(wall: float) -> None:
    run = closed_loop(
        {'estimator': 'kalman', 'tuning.kalman.location_std': 1e-3},
        {**PAPER_SENSORS, 'environment.location': wall},
    )
    assert run.last.stiffness == pytest.approx(4800.0, rel=0.02)


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


def test_wall_at_rest_teaches_nothing_below_the_resting_speed() -> None:
    kalman = estimator(resting_speed=0.005)
    learn(kalman, T, (60.0, 0.01, 0.004, 1.0), 0.25)
    assert (kalman.stiffness, kalman.damping) == (3000.0, 50.0)
    learn(kalman, T, (60.0, 0.01, -0.006, 1.0), 0.25)
    assert kalman.stiffness != 3000.0


@pytest.mark.parametrize('frozen', [Frozen(True, False), Frozen(False, True), Frozen(True, True)])
def test_frozen_parameters_do_not_move(frozen: Frozen) -> None:
    kalman = estimator()
    for row in rows_of(60).tolist():
        learn(kalman, T, row, 0.25, frozen)
    moved = [kalman.stiffness != 3000.0, kalman.damping != 50.0]
    assert moved == [not frozen.stiffness, not frozen.damping]


def test_uncertainty_of_a_held_damping_weighs_on_the_stiffness() -> None:
    frozen, free = estimator(damping_std=1e4), estimator(damping_std=1e-3)
    for kalman in (frozen, free):
        learn(kalman, T, (60.0, 0.01, 0.05, 1.0), 0.25, Frozen(False, True))
    assert known(frozen).stiffness_std > 10.0 * known(free).stiffness_std


def test_known_location_does_not_move() -> None:
    kalman = estimator(location_std=0.0)
    for row in rows_of(300, shift=1e-3).tolist():
        learn(kalman, T, row, 0.25)
    assert known(kalman).location_shift == 0.0


@pytest.mark.parametrize('wall', [5e-3, -5e-3])
def test_location_stays_within_5_standard_deviations_of_its_prior(wall: float) -> None:
    kalman, furthest = estimator(location_std=1e-4), 0.0
    for row in rows_of(600, shift=wall).tolist():
        learn(kalman, T, row, 0.25)
        furthest = max(furthest, abs(known(kalman).location_shift))
    assert furthest == pytest.approx(5e-4)


def test_damping_is_never_negative() -> None:
    kalman, smallest = estimator(), 0.0
    for _, d, v, c in rows_of(300).tolist():
        learn(kalman, T, (K * d - 50.0 * v, d, v, c), 0.25)
        smallest = min(smallest, kalman.damping)
    assert smallest == 0.0


def test_reset_goes_back_to_the_first_guess() -> None:
    kalman = estimator()
    for row in rows_of(60).tolist():
        learn(kalman, T, row, 0.25)
    kalman.reset()
    assert (kalman.stiffness, kalman.damping, known(kalman).location_shift) == (3000.0, 50.0, 0.0)
