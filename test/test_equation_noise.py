# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""The noise of the equation against simulated noise and batch least squares."""

from __future__ import annotations

from contact_estimation.estimators.environment_parameters import EnvironmentParameters
from contact_estimation.estimators.equation_noise import EquationNoise, residual_variance
from contact_estimation.estimators.indirect_adaptive import (
    IndirectAdaptive,
    IndirectAdaptiveParameters,
)
from contact_estimation.estimators.row_sums import Window
from contact_estimation.signals.butterworth import ButterworthBank
from core_runs import contact_samples, estimates_of, pipeline_with
import numpy as np
from numpy.typing import NDArray
import pytest

K, B, T, SIGMA = 4800.0, 200.0, 0.002, 0.5


def rows_of(count: int, sigma: float = SIGMA) -> NDArray[np.float64]:
    """Rows (y, d, v, 1, 0) of a sine contact with white noise."""
    t = T * np.arange(count)
    d, v = 0.01 + 0.002 * np.sin(20.0 * t), 0.04 * np.cos(20.0 * t)
    noise = sigma * np.random.default_rng(3).standard_normal(count)
    return np.column_stack([K * d + B * v + noise, d, v, np.ones(count), np.zeros(count)])


@pytest.mark.parametrize('with_location', [False, True])
def test_residual_variance_is_that_of_the_batch_fit(with_location: bool) -> None:
    rows = rows_of(400)
    phi = rows[:, 1:4] if with_location else rows[:, 1:3]
    left = rows[:, 0] - phi @ np.linalg.lstsq(phi, rows[:, 0], rcond=None)[0]
    expected = left @ left / (400 - phi.shape[1])
    got = residual_variance(rows.T @ rows, 400.0, with_location)
    assert got == pytest.approx(expected, rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize('cutoff', [20.0, 50.0, 100.0])
def test_residual_of_filtered_rows_gives_the_noise_before_the_filter(cutoff: float) -> None:
    bank = ButterworthBank(5, cutoff, 500.0)
    rows = np.array([bank.take(row) for row in rows_of(50_000).tolist()])[500:]
    effective = len(rows) * bank.noise_gain()
    assert residual_variance(rows.T @ rows, effective, False) == pytest.approx(
        SIGMA**2, rel=0.05
    )


def test_residual_of_too_short_a_window_says_nothing() -> None:
    rows = rows_of(20)
    assert residual_variance(rows.T @ rows, 20.0, False) is None


def test_rows_without_any_motion_do_not_break_the_fit() -> None:
    rows = np.tile([48.0, 0.01, 0.0, 1.0, 0.0], (100, 1))
    assert residual_variance(rows.T @ rows, 100.0, True) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize('weights', [(1.0,), (0.5, 0.5), (0.25, 0.5, 0.25)])
@pytest.mark.parametrize('cutoff', [0.0, 50.0])
def test_noise_gain_is_the_share_of_white_noise_that_passes(
    cutoff: float, weights: tuple[float, ...]
) -> None:
    noise = np.convolve(np.random.default_rng(4).standard_normal(200_000), weights)
    bank = ButterworthBank(1, cutoff, 500.0)
    passed = np.var(np.array([bank.take(row) for row in noise[:, None].tolist()]))
    assert bank.noise_gain(weights) == pytest.approx(passed, rel=0.03)


def noise_with(position_noise: float) -> EquationNoise:
    """Judge a window of 10 mm depth with an estimator at its first guess, 3000 N/m."""
    estimator = IndirectAdaptive(IndirectAdaptiveParameters(), EnvironmentParameters(), T)
    noise, rows = EquationNoise(), rows_of(500, 0.0)
    noise.judge(Window(500.0, 0.0, rows.T @ rows), 0.25, position_noise, estimator)
    return noise


def test_position_noise_enters_times_the_stiffness() -> None:
    assert noise_with(1e-4).variance == pytest.approx(0.25 + (3000.0 * 1e-4) ** 2)


def test_unmodelled_friction_widens_the_claim() -> None:
    clean = contact_samples(2.0, force_noise=0.3)
    rubbing = [s._replace(force=s.force - 6.0 * np.tanh(s.velocity / 4e-4)) for s in clean]
    claims = [
        estimates_of(samples, pipeline_with(
            estimator='kalman', synchronisation__timing_std=0.0))[-1].stiffness_std
        for samples in (clean, rubbing)
    ]
    assert claims[1] > 3.0 * claims[0]
