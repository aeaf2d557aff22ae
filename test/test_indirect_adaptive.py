# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Indirect adaptive estimation, eqs. (20) to (27), and the speed of its gains."""

from __future__ import annotations

from typing import Any

from contact_estimation.estimators.gradient_speed import stiffest_wall
from contact_estimation.estimators.indirect_adaptive import (
    IndirectAdaptive, IndirectAdaptiveParameters)
from contact_estimation.estimators.parameters import EnvironmentParameters
from core_runs import pipeline_with
from core_steps import known, learn
import numpy as np
from numpy.typing import NDArray
import pytest

K, B, T = 4800.0, 200.0, 0.002
GAINS = np.array([5.0e4, 2.5e3])


def estimator(start: tuple[float, float] = (3000.0, 50.0), **tuning: Any) -> IndirectAdaptive:
    """Make an estimator with a first guess of K and B."""
    environment = EnvironmentParameters(initial_stiffness=start[0], initial_damping=start[1])
    return IndirectAdaptive(IndirectAdaptiveParameters(**tuning), environment, T)


def theta(of: IndirectAdaptive) -> NDArray[np.float64]:
    """Stack K_hat and B_hat."""
    return np.array([of.stiffness, of.damping])


def sine_rows(
    count: int, period: float = T, K_e: float = K, B_e: float = B
) -> NDArray[np.float64]:
    """Rows (y, delta, v) of 50 N with a sine of 8 N at 20 rad/s, whatever the stiffness."""
    t = period * np.arange(count)
    d = (50.0 + 8.0 * np.sin(20.0 * t)) / K_e
    v = 160.0 * np.cos(20.0 * t) / K_e
    return np.column_stack([K_e * d + B_e * v, d, v])


def learn_all(of: IndirectAdaptive, rows: NDArray[np.float64], period: float = T) -> None:
    """Pass rows through an estimator."""
    for row in rows.tolist():
        learn(of, period, (*row, 1.0))


def test_adaptation_law_is_the_gradient_of_half_the_squared_force_error() -> None:
    def cost(at: NDArray[np.float64]) -> float:
        return 0.5 * float(phi @ at - 50.0) ** 2

    phi, start, dt = np.array([0.012, 0.07]), np.array([3000.0, 50.0]), 1e-7
    steps = np.diag([1e-2, 1e-2])
    gradient = np.array([(cost(start + h) - cost(start - h)) / 2e-2 for h in steps])
    adaptive = estimator()
    learn(adaptive, dt, (50.0, *phi.tolist(), 1.0))
    np.testing.assert_allclose((theta(adaptive) - start) / dt, -GAINS * gradient, rtol=1e-4)


@pytest.mark.parametrize('amplitude', [1e-3, 1e-2, 1.0])
def test_lyapunov_function_falls_in_every_noise_free_step(amplitude: float) -> None:
    random, adaptive, values = np.random.default_rng(5), estimator(), []
    for d, v in random.normal(0.0, amplitude, (500, 2)).tolist():
        error = theta(adaptive) - [K, B]
        values.append(error @ (error / GAINS))
        learn(adaptive, T, (K * d + B * v, d, v, 1.0))
    assert np.all(np.diff(values) <= 1e-12 * values[0])


def test_normalised_finds_a_stiff_wall_where_fixed_gains_starve() -> None:
    fixed, normalised = estimator(), estimator(normalised=True)
    for adaptive in (fixed, normalised):
        learn_all(adaptive, sine_rows(1500, T, 1e5, 200.0))
    assert fixed.stiffness < 0.2e5
    np.testing.assert_allclose(theta(normalised), [1e5, 200.0], rtol=0.01)


@pytest.mark.parametrize('normalised', [False, True])
def test_claimed_std_is_the_spread_over_noise(normalised: bool) -> None:
    period, sigma, runs = 0.01, 1.0, 250
    random, rows, finals = np.random.default_rng(6), sine_rows(400, 0.01), []
    for _ in range(runs):
        adaptive = estimator((K, B), normalised=normalised, adaptation_rate=5.0)
        noisy = rows[:, 0] + sigma * random.standard_normal(len(rows))
        for y, (_, d, v) in zip(noisy.tolist(), rows.tolist()):
            learn(adaptive, period, (y, d, v, 1.0), sigma**2)
        finals.append(theta(adaptive))
    claimed = known(adaptive)[2:4]
    np.testing.assert_allclose(np.std(finals, axis=0), claimed, rtol=0.15)


def test_the_stiffest_wall_is_adapted_to_within_two_seconds_under_50_n() -> None:
    gain, T = 5e4, 1e-4
    K, d, estimate = stiffest_wall(gain), 50.0 / stiffest_wall(gain), 0.0
    for _ in range(round(2.0 / T)):
        estimate -= T * gain * d * (estimate * d - K * d)  # eq. (25)
    assert estimate / K == pytest.approx(1.0 - np.exp(-1.0), rel=1e-3)


def test_normalised_gains_never_starve() -> None:
    tuning = {'tuning__indirect_adaptive__normalised': True}
    pipeline = pipeline_with(estimator='indirect_adaptive', **tuning)
    assert pipeline.limitation == ''


def test_the_paper_s_gains_state_their_limit_and_the_default_has_none() -> None:
    limited = pipeline_with(estimator='indirect_adaptive').limitation
    assert '1.58e+04 N/m' in limited and 'normalised' in limited
    assert pipeline_with().limitation == ''
