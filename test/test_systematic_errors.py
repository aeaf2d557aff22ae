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

"""Systematic errors in the published deviations, against batch fits and simulated faults."""

from __future__ import annotations

from math import isnan

from contact_estimation.estimation.supervised_estimator import widened
from contact_estimation.estimators.environment_parameters import EnvironmentParameters
from contact_estimation.estimators.estimate import Frozen, ParameterEstimate
from contact_estimation.estimators.indirect_adaptive import (
    IndirectAdaptive,
    IndirectAdaptiveParameters,
)
from contact_estimation.estimators.row_sums import sum_of, Window
from contact_estimation.estimators.systematic_errors import SystematicErrors
from contact_estimation.estimators.window_fit import fit_window
from core_runs import contact_samples, estimates_of, pipeline_with
import numpy as np
from numpy.typing import NDArray
import pytest

Array = NDArray[np.float64]

K, B, T, SIGMA, OMEGA = 4800.0, 200.0, 0.002, 0.5, 6.0 * np.pi
BOTH = Frozen(False, False)
EXACT = ParameterEstimate(K, B, 0.0, 0.0, 0.0, 0.0)


def motion(count: int = 500) -> tuple[Array, Array, Array]:
    """Return time, penetration and its rate of a sine contact."""
    t = np.arange(0.0, count) * T
    return t, 0.01 + 0.002 * np.sin(OMEGA * t), 0.002 * OMEGA * np.cos(OMEGA * t)


def blocks_of(force: Array, d: Array, v: Array, block: int = 50) -> list[Window]:
    """Return the blocks of a window of rows."""
    rows = np.column_stack([force, d, v, np.ones_like(d), np.zeros_like(d)])
    return [Window(float(block), 0.0, part.T @ part)
            for part in np.split(rows, len(rows) // block)]


def estimator_at(stiffness: float = K, damping: float = B) -> IndirectAdaptive:
    """Return an estimator with a given estimate."""
    estimator = IndirectAdaptive(IndirectAdaptiveParameters(), EnvironmentParameters(), T)
    estimator.start_from(stiffness, damping)
    return estimator


def wide(errors: SystematicErrors, estimate: ParameterEstimate) -> ParameterEstimate:
    """Return an estimate with the errors added to its deviations."""
    return ParameterEstimate(*widened(estimate, errors))


def claimed(
    force: Array, estimator: IndirectAdaptive, noise_variance: float = SIGMA**2,
    timing_std: float = 0.0, own_std: float = 0.0,
) -> ParameterEstimate:
    """Return the estimate of an estimator after a window with a force, widened."""
    _, d, v = motion(len(force))
    errors = SystematicErrors(timing_std)
    errors.judge(blocks_of(force, d, v), noise_variance, SIGMA**2, 0.0, 0.0, estimator)
    errors.note_update(BOTH)
    now = estimator.current()._replace(stiffness_std=own_std, damping_std=own_std)
    return wide(errors, now)


def noise(count: int = 500, seed: int = 1) -> Array:
    return SIGMA * np.random.default_rng(seed).standard_normal(count)


def test_the_fit_of_the_window_is_the_batch_fit() -> None:
    _, d, v = motion()
    force = K * d + B * v + noise()
    phi = np.column_stack([d, v])
    expected = np.linalg.lstsq(phi, force, rcond=None)[0]
    fits = fit_window(blocks_of(force, d, v), SIGMA**2, estimator_at())
    assert fits is not None
    assert fits.mean.values == pytest.approx(tuple(expected), rel=1e-6)
    variances = np.diag(np.linalg.inv(phi.T @ phi))
    assert fits.mean.variances == pytest.approx(tuple(variances), rel=1e-6)


def test_the_scatter_of_the_blocks_is_the_variance_of_repeated_fits() -> None:
    _, d, v = motion()
    phi = np.column_stack([d, v])
    draw = np.random.default_rng(2)
    fitted, scatter = [], []
    for _ in range(300):
        wander = np.repeat(SIGMA * draw.standard_normal(50), 10)  # correlated over 10 samples
        force = K * d + B * v + wander
        fitted.append(np.linalg.lstsq(phi, force, rcond=None)[0])
        fits = fit_window(blocks_of(force, d, v), SIGMA**2, estimator_at())
        assert fits is not None
        scatter.append(fits.mean.scatter)
    assert np.mean(scatter, axis=0) == pytest.approx(np.var(fitted, axis=0), rel=0.25)


def test_a_trend_of_the_stiffness_is_fitted_to_the_end_of_the_window() -> None:
    t, d, v = motion()
    rising = K * (1.0 + 0.05 * t)
    fits = fit_window(blocks_of(rising * d + B * v, d, v), SIGMA**2, estimator_at())
    assert fits is not None and fits.end is not None
    assert fits.mean.values[0] == pytest.approx(np.mean(rising), rel=2e-3)
    assert fits.end.values[0] == pytest.approx(rising[-25], rel=2e-3)  # middle of the last block


def test_a_lag_of_the_force_weighs_on_stiffness_and_damping_as_it_biases_them() -> None:
    lag = 1e-3
    t, d, v = motion()
    late_d = 0.01 + 0.002 * np.sin(OMEGA * (t - lag))
    late = K * late_d + B * 0.002 * OMEGA * np.cos(OMEGA * (t - lag))
    K_late, B_late = np.linalg.lstsq(np.column_stack([d, v]), late, rcond=None)[0]
    got = claimed(K * d + B * v, estimator_at(), timing_std=lag)
    assert got.damping_std == pytest.approx(B - B_late, rel=0.05)
    assert got.stiffness_std == pytest.approx(abs(K_late - K), rel=0.15)


def test_an_estimate_that_agrees_with_the_window_keeps_its_deviation() -> None:
    _, d, v = motion()
    got = claimed(K * d + B * v + noise(), estimator_at(), own_std=3.0)
    assert (got.stiffness_std, got.damping_std) == pytest.approx((3.0, 3.0), rel=0.2)


def test_an_estimate_far_from_the_window_has_their_difference_as_deviation() -> None:
    _, d, v = motion()
    got = claimed(K * d + B * v + noise(), estimator_at(3000.0, 50.0))
    assert got.stiffness_std == pytest.approx(1800.0, rel=0.05)
    assert got.damping_std == pytest.approx(150.0, rel=0.2)


def test_a_wrong_location_has_the_difference_to_the_fit_with_a_free_one_as_deviation() -> None:
    _, d, v = motion()
    force = K * (d - 1e-3) + B * v + noise()
    K_hat, B_hat = np.linalg.lstsq(np.column_stack([d, v]), force, rcond=None)[0]
    got = claimed(force, estimator_at(float(K_hat), float(B_hat)))
    assert got.stiffness_std == pytest.approx(K - K_hat, rel=0.25)


def test_correlated_residuals_widen_by_their_long_run_variance() -> None:
    _, d, v = motion(500)
    slow = np.repeat(noise(20), 25)
    errors = SystematicErrors(0.0)
    for _ in range(100):
        blocks = blocks_of(K * d + B * v + slow, d, v)
        errors.judge(blocks, SIGMA**2, SIGMA**2, 0.0, 0.0, estimator_at())
    errors.note_update(BOTH)
    assert wide(errors, EXACT._replace(damping_std=1.0)).damping_std > 2.0


def test_a_residual_beyond_the_known_noise_does_not_average_out() -> None:
    _, d, v = motion()
    got = claimed(K * d + B * v, estimator_at(), noise_variance=25.0 * SIGMA**2)
    rest = 2.0 * np.sqrt(25.0 - 4.0) * SIGMA  # twice: that of friction in a sine
    assert got.damping_std == pytest.approx(rest / np.sqrt(np.mean(v**2)), rel=0.05)


def test_friction_is_absorbed_twice_as_much_as_it_leaves() -> None:
    _, d, v = motion(5000)
    phi = np.column_stack([d, v])
    theta = np.linalg.lstsq(phi, np.sign(v), rcond=None)[0]
    left = np.std(np.sign(v) - phi @ theta)
    assert abs(theta[1]) * np.sqrt(np.mean(v**2)) == pytest.approx(2.0 * left, rel=0.1)


def test_errors_of_a_frozen_parameter_stay() -> None:
    errors, (_, d, v) = SystematicErrors(0.0), motion()
    blocks = blocks_of(K * d + B * v, d, v)
    errors.judge(blocks, SIGMA**2, SIGMA**2, 0.0, 0.0, estimator_at(2e3, B))
    errors.note_update(BOTH)
    before = wide(errors, EXACT)
    blocks = blocks_of(K * d + B * v, d, v)
    errors.judge(blocks, SIGMA**2, SIGMA**2, 0.0, 0.0, estimator_at(K, B))
    errors.note_update(Frozen(True, True))
    assert wide(errors, EXACT) == before != EXACT


def test_what_was_never_updated_has_no_deviation() -> None:
    got = wide(SystematicErrors(1e-3), EXACT)
    assert isnan(got.stiffness_std) and isnan(got.damping_std)


@pytest.mark.parametrize('stiffness', [K, 2e3])
def test_rows_at_rest_show_the_stiffness_and_no_damping(stiffness: float) -> None:
    at_rest = np.full(500, 0.01)
    errors = SystematicErrors(0.0)
    blocks = blocks_of(K * at_rest, at_rest, np.zeros(500))
    errors.judge(blocks, 25.0 * SIGMA**2, SIGMA**2, 0.0, 0.0, estimator_at(stiffness, 2.0 * B))
    errors.note_update(Frozen(False, True))
    got = wide(errors, EXACT._replace(stiffness=stiffness))
    # Of a residual beyond the noise, which may be friction.
    floor = 2.0 * np.sqrt(25.0 - 4.0) * SIGMA / 0.01
    assert got.stiffness_std == pytest.approx(np.hypot(K - stiffness, floor), rel=0.01)
    assert isnan(got.damping_std)


def window_of(rows: Array, rate_noise: float = 0.0) -> Window:
    """Return the sums over rows (y, d, v, 1, 0)."""
    return Window(float(len(rows)), rate_noise, rows.T @ rows)


def rows_of(d: Array, v: Array) -> Array:
    return np.column_stack([K * d + B * v, d, v, np.ones_like(d), np.zeros_like(d)])


def by_position(d: Array, v: Array, position_noise: float) -> float:
    """Return the deviation of K_hat by an error of the position alone."""
    errors = SystematicErrors(0.0)
    errors.judge_position(window_of(rows_of(d, v)), position_noise, estimator_at())
    errors.note_update(BOTH)
    return wide(errors, EXACT).stiffness_std


def test_constant_position_error_weighs_on_the_stiffness() -> None:
    at_rest = np.full(500, 0.01)
    fit = np.linalg.lstsq(at_rest[:, None], K * (at_rest + 1e-4), rcond=None)[0][0]
    assert by_position(at_rest, np.zeros(500), 1e-4) == pytest.approx(fit - K, rel=1e-6)


def test_motion_over_many_steps_averages_the_quantisation() -> None:
    t, d, v = motion()
    step = 1e-4
    rounded = step * np.round(d / step)
    fit = np.linalg.lstsq(np.column_stack([rounded, v]), K * d + B * v, rcond=None)[0][0]
    claimed_std = by_position(d, v, step / np.sqrt(12.0))
    assert abs(fit - K) < 2.0 * claimed_std < 0.1 * K * step / 0.01


def off_surface(shift: float, draw: np.random.Generator) -> tuple[Array, list[Window]]:
    """Return rows of two seconds after a ramp, as blocks, with the surface elsewhere."""
    t = np.arange(0.0, 1000) * T
    d = np.minimum(0.1 * t, 0.01) + 0.001 * np.sin(OMEGA * t)
    v = np.gradient(d, T)
    force = K * (d - shift) + B * v + SIGMA * draw.standard_normal(1000)
    return np.column_stack([force, d, v]), blocks_of(force, d, v)


def test_a_surface_not_known_weighs_as_the_whole_contact_shows_it() -> None:
    draw, prior_std, z = np.random.default_rng(6), 2e-3, []
    for _ in range(100):
        rows, blocks = off_surface(prior_std * draw.standard_normal(), draw)
        K_hat, B_hat = np.linalg.lstsq(rows[500:, 1:], rows[500:, 0], rcond=None)[0]
        errors = SystematicErrors(0.0)
        errors.judge(blocks[-10:], SIGMA**2, SIGMA**2, 0.0, prior_std,
                     estimator_at(float(K_hat), float(B_hat)), sum_of(blocks))
        errors.note_update(BOTH)
        z.append((K_hat - K) / wide(errors, EXACT).stiffness_std)
    assert 0.9 <= np.mean(np.abs(z) < 2.0)
    assert np.mean(np.square(z)) > 0.3  # nor much too wide


def test_a_lag_of_the_force_weighs_on_a_surface_that_was_found() -> None:
    lag, prior_std, seen = 1e-3, 2e-3, 0.15  # of the wall's B_e / K_e, large for a lag to show
    t = np.arange(0.0, 1000) * T
    d, v, a = (0.01 + 0.001 * np.sin(OMEGA * t), 0.001 * OMEGA * np.cos(OMEGA * t),
               -0.001 * OMEGA**2 * np.sin(OMEGA * t))
    late = K * (d - lag * v) + seen * K * (v - lag * a)
    phi = np.column_stack([d, v, np.ones_like(d)])
    K_hat, B_hat, offset = np.linalg.lstsq(phi, late, rcond=None)[0]
    moved = d + offset / K_hat  # to where this line meets 0
    blocks = blocks_of(late, moved, v)
    errors = SystematicErrors(lag)
    errors.judge(blocks[-10:], SIGMA**2, SIGMA**2, 0.0, prior_std,
                 estimator_at(float(K_hat), float(B_hat)), sum_of(blocks))
    errors.note_update(BOTH)
    assert K_hat - K > 0.04 * K  # and a surface 0.4 mm too deep
    got = wide(errors, EXACT._replace(stiffness=float(K_hat), damping=float(B_hat)))
    assert got.stiffness_std == pytest.approx(K_hat - K, rel=0.15)


def test_a_surface_that_is_known_weighs_nothing() -> None:
    _, blocks = off_surface(0.0, np.random.default_rng(7))
    stds = []
    for prior_std in (0.0, 2e-3):
        errors = SystematicErrors(0.0)
        errors.judge(blocks[-10:], SIGMA**2, SIGMA**2, 0.0, prior_std, estimator_at(),
                     sum_of(blocks))
        errors.note_update(BOTH)
        stds.append(wide(errors, EXACT).stiffness_std)
    assert stds[0] < 0.1 * stds[1] < 0.01 * K


def test_noise_in_the_rate_weighs_on_the_damping_as_least_squares_is_biased() -> None:
    _, d, v = motion(5000)
    noisy = v + 0.02 * np.random.default_rng(5).standard_normal(5000)  # 2e-5 m of position noise
    rows = rows_of(d, v)
    rows[:, 2] = noisy
    biased = np.linalg.lstsq(rows[:, 1:3], rows[:, 0], rcond=None)[0][1]
    errors = SystematicErrors(0.0)
    errors.judge_position(window_of(rows, 5000.0 * (0.02 / 2e-5) ** 2), 2e-5, estimator_at())
    errors.note_update(BOTH)
    got = wide(errors, EXACT._replace(damping=biased))
    assert got.damping_std == pytest.approx(B - biased, rel=0.1)


def test_deviation_of_what_is_frozen_stays() -> None:
    errors, (_, d, v) = SystematicErrors(0.0), motion()
    errors.judge_position(window_of(rows_of(d, v)), 1e-4, estimator_at())
    errors.note_update(BOTH)
    before = wide(errors, EXACT)
    still = rows_of(np.full(500, 0.001), np.zeros(500))
    errors.judge_position(window_of(still, 5e8), 1e-4, estimator_at())
    errors.note_update(Frozen(True, True))
    assert wide(errors, EXACT) == before


def test_nothing_is_claimed_of_what_never_learned() -> None:
    errors = SystematicErrors(0.0)
    errors.note_update(Frozen(False, True))
    got = wide(errors, EXACT._replace(stiffness_std=5.0))
    assert got.stiffness_std == 5.0 and isnan(got.damping_std)


@pytest.mark.parametrize('estimator', ['kalman', 'rls', 'indirect_adaptive'])
def test_timing_widens_the_damping_of_every_estimator(estimator: str) -> None:
    samples = contact_samples(1.0, force_noise=0.3)
    stds = [
        estimates_of(samples, pipeline_with(
            estimator=estimator, synchronisation__timing_std=timing_std))[-1].damping_std
        for timing_std in (0.0, 5e-3)
    ]
    assert stds[1] == pytest.approx(np.hypot(stds[0], K * 5e-3), rel=0.1)
