# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Discrete dynamics against independent integration; innovations of right and wrong models."""

from __future__ import annotations


from contact_estimation.diagnosis.observe.observer import (
    innovations,
    kalman_filter,
    run,
    run_velocity,
)
from contact_estimation.physics.second_order import discretise
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.linalg import solve_discrete_are
from scipy.signal import lsim

Array = NDArray[np.float64]

H, CUTOFF = 0.004, 50.0
T = H * np.arange(1200)
SYSTEMS = [(12.0, 350.0, 2500.0), (2.0, 1.5, 5000.0), (50.0, 1000.0, 5000.0), (3.0, 0.0, 0.0)]
EVERY = pytest.mark.parametrize('M, B, K', SYSTEMS)
PUSH = 40.0 * np.sin(9.0 * T) + 15.0 * np.sin(31.0 * T)


def matrix(M: float, B: float, K: float) -> Array:
    """Give the continuous system matrix of position and velocity."""
    return np.array([[0.0, 1.0], [-K / M, -B / M]])


@EVERY
def test_run_is_that_of_lsim(M: float, B: float, K: float) -> None:
    plant = (matrix(M, B, K), [[0.0], [1.0 / M]], np.eye(2), np.zeros((2, 1)))
    _, states, _ = lsim(plant, PUSH, T, interp=True)
    system = discretise(M, B, K, H)
    for got, expected in zip((run, run_velocity), states.T):
        np.testing.assert_allclose(got(system, PUSH, 0.0, K), expected,
                                   atol=1e-8 * np.max(np.abs(expected)))


def test_innovations_of_a_right_model_are_white_and_no_larger_than_the_noise() -> None:
    system, noise = discretise(*SYSTEMS[0], H), 3e-6
    measured = noise * np.random.default_rng(1).standard_normal(20000)
    left = innovations(measured, system, CUTOFF, H)
    assert np.std(left) == pytest.approx(noise, rel=0.15)
    for lag in range(1, 8):
        assert abs(np.corrcoef(left[lag:], left[:-lag])[0, 1]) < 0.2


@EVERY
@pytest.mark.parametrize('force_noise, position_noise', [(0.3, 1e-6), (0.01, 3e-6)])
def test_kalman_filter_is_that_of_the_riccati_equation(
    M: float, B: float, K: float, force_noise: float, position_noise: float
) -> None:
    system = discretise(M, B, K, H)
    denominator, std = kalman_filter(system, force_noise, position_noise)
    # The difference equation as a state space: y = b_0 f + z_1, z' = shift z - a y + b f.
    A = np.array([[-system.denominator[1], 1.0], [-system.denominator[2], 0.0]])
    b = system.position
    G = (b[1:] - system.denominator[1:] * b[0])[:, None] * force_noise
    cross, C = G * b[0] * force_noise, np.array([[1.0, 0.0]])
    R = np.array([[position_noise**2 + (b[0] * force_noise) ** 2]])
    scale = 1.0 / R[0, 0]  # or the solver sees rounding alone
    P = solve_discrete_are(A.T, C.T, G @ G.T * scale, R * scale, s=cross * scale) / scale
    S = (C @ P @ C.T + R)[0, 0]
    gain = (A @ P @ C.T + cross) / S
    np.testing.assert_allclose(denominator, np.poly(A - gain @ C), atol=1e-5)
    assert std == pytest.approx(np.sqrt(S), rel=1e-4)
