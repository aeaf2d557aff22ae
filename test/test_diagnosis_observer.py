# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Discrete dynamics against independent integration; innovations of right and wrong models."""

from __future__ import annotations

from math import exp

from contact_estimation.diagnosis.observe.observer import (
    coast,
    innovations,
    innovations_of,
    innovations_under,
    kalman_filter,
    run,
    run_velocity,
)
from contact_estimation.physics.numeric import discretise
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm, solve_discrete_are
from scipy.signal import lfilter, lsim

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


def test_run_is_that_of_an_integration_with_straight_lines_of_force() -> None:
    M, B, K = SYSTEMS[0]
    short = slice(0, 100)

    def rates(t: float, s: Array) -> list[float]:
        return [s[1], (np.interp(t, T, PUSH) - B * s[1] - K * s[0]) / M]

    solved = solve_ivp(rates, (0.0, T[99]), [0.0, 0.0], t_eval=T[short], max_step=H / 4.0,
                       rtol=1e-9, atol=1e-12)
    got = run(discretise(M, B, K, H), PUSH, 0.0, K)[short]
    np.testing.assert_allclose(got, solved.y[0], atol=1e-8)


@EVERY
def test_what_holds_it_leaves_it_at_rest(M: float, B: float, K: float) -> None:
    held = run(discretise(M, B, K, H), np.full(500, K * 0.013), 0.013, K)
    np.testing.assert_allclose(held, 0.013, atol=1e-12)


@EVERY
def test_poles_are_those_of_the_dynamics(M: float, B: float, K: float) -> None:
    poles = np.exp(np.linalg.eigvals(matrix(M, B, K)) * H)
    expected = np.poly(poles).real
    np.testing.assert_allclose(discretise(M, B, K, H).denominator, expected, atol=1e-9)


@EVERY
@pytest.mark.parametrize('scale', [1.0, 1.3])
def test_innovations_of_a_force_are_those_of_its_motion(
    M: float, B: float, K: float, scale: float
) -> None:
    system, observer = discretise(M, scale * B, K, H), discretise(M, B, K, H)
    moved = lsim((matrix(M, scale * B, K), [[0.0], [1.0 / M]], [[1.0, 0.0]], [[0.0]]), PUSH, T)[1]
    expected = innovations(np.asarray(moved).ravel(), observer, CUTOFF, H)
    got = innovations_of(PUSH, system, observer, CUTOFF, H)
    np.testing.assert_allclose(got, expected, atol=1e-7 * np.max(np.abs(expected)))


@EVERY
def test_innovations_under_a_force_are_those_of_the_misfit_of_its_run(
    M: float, B: float, K: float
) -> None:
    system, start, c = discretise(M, B, K, H), 0.02, np.array([1.0, -1.3, 0.47, -0.035])
    position = start + 1e-3 * np.sin(7.0 * T)
    expected = lfilter(system.denominator, c, position - run(system, PUSH, start, K))
    got = innovations_under(PUSH, position, start, system, c, K)
    np.testing.assert_allclose(got, expected, atol=1e-9 * np.max(np.abs(expected)))


@EVERY
def test_innovations_are_those_of_an_observer(M: float, B: float, K: float) -> None:
    noisy = run(discretise(M, B, K, H), PUSH, 0.0, K)
    noisy[300:] += 1e-4
    step, pole = expm(matrix(M, B, K) * H), exp(-CUTOFF * H)
    # Ackermann: the gain L that gives A - L C both poles, C = (1, 0).
    polynomial = (step - pole * np.eye(2)) @ (step - pole * np.eye(2))
    observability = np.array([[1.0, 0.0], step[0]])
    gain = polynomial @ np.linalg.solve(observability, [0.0, 1.0])
    error, expected = np.zeros(2), []
    misfit = noisy - run(discretise(M, B, K, H), PUSH, 0.0, K)
    for measured in misfit.tolist():  # the state here is that of the observer less the free run
        expected.append(measured - error[0])
        error = step @ error + gain * expected[-1]
    got = innovations(misfit, discretise(M, B, K, H), CUTOFF, H)
    np.testing.assert_allclose(got, expected, atol=1e-12)


def test_innovations_forget_an_impulse_that_the_free_run_remembers() -> None:
    M, B, K = 50.0, 1000.0, 5000.0
    system, push = discretise(M, B, K, H), np.zeros(500)
    push[100] = 10.0
    misfit = run(system, push, 0.0, K)
    left = np.abs(innovations(misfit, system, CUTOFF, H))
    later = 100 + round(5.0 / (CUTOFF * H))
    # The answer to an impulse is t exp(-w t): a tenth of its peak is left at 5 / w.
    assert np.max(left[later:]) < 0.1 * np.max(left)
    assert np.max(left[later + round(5.0 / (CUTOFF * H)):]) < 0.003 * np.max(left)
    assert np.abs(misfit[later]) > 0.5 * np.max(np.abs(misfit))


def test_innovations_of_a_right_model_are_white_and_no_larger_than_the_noise() -> None:
    system, noise = discretise(*SYSTEMS[0], H), 3e-6
    measured = noise * np.random.default_rng(1).standard_normal(20000)
    left = innovations(measured, system, CUTOFF, H)
    assert np.std(left) == pytest.approx(noise, rel=0.15)
    for lag in range(1, 8):
        assert abs(np.corrcoef(left[lag:], left[:-lag])[0, 1]) < 0.2


def test_innovations_of_a_wrong_model_are_not_white() -> None:
    right, wrong = discretise(*SYSTEMS[0], H), discretise(12.0, 350.0, 3000.0, H)
    measured = run(right, PUSH, 0.0, 2500.0)
    left = innovations(measured - run(wrong, PUSH, 0.0, 3000.0), wrong, CUTOFF, H)
    assert np.corrcoef(left[1:], left[:-1])[0, 1] > 0.9
    assert np.std(left) > 1e-5


def test_innovations_of_nothing_are_nothing() -> None:
    assert not innovations(np.zeros(100), discretise(*SYSTEMS[1], H), CUTOFF, H).any()


@EVERY
def test_coasting_is_the_exponential_of_the_dynamics(M: float, B: float, K: float) -> None:
    motions = coast(discretise(M, B, K, H), 200)
    for k in (0, 1, 17, 199):
        np.testing.assert_allclose(motions[:, :, k].T, expm(matrix(M, B, K) * H * k), atol=1e-7)


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


def test_with_a_force_that_is_known_innovations_are_the_misfit_itself() -> None:
    system = discretise(*SYSTEMS[1], H)
    denominator, std = kalman_filter(system, 0.0, 2e-6)
    np.testing.assert_allclose(denominator, system.denominator, atol=1e-6)
    assert std == pytest.approx(2e-6, rel=1e-3)
