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

"""The indicator of model fit: wrong models are reported and named, right ones are not."""

from __future__ import annotations

from dataclasses import replace
from math import isnan, sqrt

from contact_estimation.benchmarks.model_fit_study import (
    DisturbedWall,
    first_report,
    main,
    MISMATCHES,
)
from contact_estimation.benchmarks.study_worlds import make_world, SCENARIOS
from contact_estimation.estimation.model_fit import ModelFitMonitor
from contact_estimation.estimation.residual_smells import smell_of
from contact_estimation.estimation.residual_structure import fit, Window
from contact_estimation.estimators import ESTIMATORS
from contact_estimation.signals.contact_sample import ContactSample
from core_runs import contact_samples, estimates_of, pipeline_with
import numpy as np
import pytest

K, B, NOISE = 5000.0, 40.0, 0.3
T = np.arange(0.0, 1000.0) * 0.002
DEPTH = 5e-3 + 1e-3 * np.sin(2 * np.pi * 3.0 * T)
RATE = 2e-3 * np.pi * 3.0 * np.cos(2 * np.pi * 3.0 * T)


def window_with(extra: np.ndarray | float, location_std: float = 0.0) -> Window:
    """Return 2 s of unfiltered contact with a force beside spring and damper."""
    noise = NOISE * np.random.default_rng(1).standard_normal(len(T))
    y = K * DEPTH + B * RATE + extra + noise
    rows = np.column_stack([y, DEPTH, RATE, np.ones_like(T), np.zeros_like(T)])
    raw = np.column_stack([-y, DEPTH, RATE])
    gains = np.tile([1.0, 0.0], (len(T), 1))
    return Window(T, rows, rows[:, [1, 2]], raw, gains, location_std)


def ratio_of(window: Window) -> float:
    """Judge a window."""
    return fit(window, NOISE**2, 0.0, 0.002).ratio


def friction(samples: list[ContactSample], F_c: float) -> list[ContactSample]:
    """Add dry friction to the samples in contact."""
    return [s._replace(force=s.force - F_c * np.tanh(s.velocity / 4e-4) * (s.force < -3.0))
            for s in samples]


def test_the_ratio_is_one_for_a_right_model() -> None:
    assert ratio_of(window_with(0.0)) == pytest.approx(1.0, abs=0.05)


@pytest.mark.parametrize('level', [2.0, 5.0, 20.0])
def test_the_ratio_is_that_of_noise_and_structure(level: float) -> None:
    slow = sqrt(2.0) * level * NOISE * np.sin(2 * np.pi * 0.5 * T)
    columns = np.column_stack([DEPTH, RATE])
    left = slow - columns @ np.linalg.lstsq(columns, slow, rcond=None)[0]
    expected = sqrt(1.0 + float(np.mean(left**2)) / NOISE**2)
    assert ratio_of(window_with(slow)) == pytest.approx(expected, rel=0.1)


def test_an_offset_within_the_uncertainty_of_the_wall_is_no_mismatch() -> None:
    moved = K * 5e-4
    assert ratio_of(window_with(moved)) > 1.5
    assert ratio_of(window_with(moved, location_std=3e-4)) == pytest.approx(1.0, abs=0.05)


def test_a_lag_of_the_force_sensor_is_no_mismatch() -> None:
    acceleration = np.gradient(RATE, T)
    lag = 1.6e-3
    assert ratio_of(window_with(-B * lag * acceleration)) == pytest.approx(1.0, abs=0.05)
    assert ratio_of(window_with(2.0 * acceleration)) > 1.5


@pytest.mark.parametrize(('extra', 'words'), [
    (4.0 * np.sign(RATE), 'changes sign with velocity: friction?'),
    (K * 2e-3 * np.ones_like(T), 'is constant: wall -2 mm from environment.location?'),
    (5e6 * DEPTH**2, 'bends with depth'),
    (1e5 * (DEPTH - 5e-3) * RATE, 'grows with depth times velocity'),
    (3.0 * np.sin(2 * np.pi * 0.7 * T), 'wanders with time'),
    (3.0 * np.sin(2 * np.pi * 10.0 * T), 'depends on its own past'),
    (3.0 * np.random.default_rng(2).standard_normal(len(T)), 'is noise'),
])
def test_the_smell_names_what_the_residual_depends_on(extra: np.ndarray, words: str) -> None:
    window = window_with(extra)
    assert words in smell_of(window, fit(window, NOISE**2, 0.0, 0.002))


def test_the_ratio_is_unknown_until_there_was_contact() -> None:
    pipeline = pipeline_with()
    estimates = estimates_of(contact_samples(1.0, force_noise=0.3), pipeline)
    assert isnan(estimates[0].model_fit)
    assert estimates[-1].model_fit == pytest.approx(1.0, abs=0.1)


def test_friction_is_reported_and_stays_in_the_summary_until_a_reset() -> None:
    pipeline = pipeline_with()
    samples = friction(contact_samples(2.0, amplitude=0.002, force_noise=0.3), 5.0)
    estimates_of(samples, pipeline)
    monitor = pipeline.model_fit
    assert monitor.now.text.endswith('changes sign with velocity: friction? run diagnose')
    assert monitor.worst.ratio >= monitor.now.ratio > 4.0
    away = [ContactSample(samples[-1].stamp_ns + k * 2_000_000, -0.02, 0.0, 0.0)
            for k in range(1, 500)]
    estimates_of(away, pipeline)
    assert (monitor.count, monitor.worst.text != '') == (1, True)
    pipeline.reset()
    assert (monitor.count, monitor.worst.text) == (0, '')
    assert isnan(monitor.now.ratio)


def test_another_wall_after_free_flight_is_no_mismatch() -> None:
    pipeline = pipeline_with()
    first = contact_samples(1.0, K_e=1000.0, B_e=20.0, force_noise=0.3)
    begin = first[-1].stamp_ns
    away = [ContactSample(begin + k * 2_000_000, -0.02, 0.0, 0.0) for k in range(1, 400)]
    begin = away[-1].stamp_ns + 2_000_000
    second = [s._replace(stamp_ns=s.stamp_ns + begin)
              for s in contact_samples(1.0, K_e=20000.0, B_e=100.0, force_noise=0.3, seed=1)]
    estimates_of([*first, *away, *second], pipeline)
    assert pipeline.model_fit.count == 0


def test_a_noise_free_simulation_is_no_mismatch() -> None:
    pipeline = pipeline_with()
    estimates = estimates_of(contact_samples(2.0), pipeline)
    assert estimates[-1].model_fit == pytest.approx(1.0, abs=0.1)


def test_a_low_rate_needs_sixty_samples() -> None:
    assert ModelFitMonitor(1.0)._block * ModelFitMonitor(1.0)._blocks >= 60


@pytest.mark.slow
@pytest.mark.parametrize('estimator', ESTIMATORS)
def test_healthy_walls_with_real_sensors_are_not_reported(estimator: str) -> None:
    # hunt_crossley has no damping independent of depth, which these walls have.
    index = 0 if estimator == 'hunt_crossley' else 3
    world = make_world(SCENARIOS['excited'], index, 4, seed=5)
    delay, text = first_report(world, estimator)
    assert (delay, text) == (np.inf, '')


@pytest.mark.slow
@pytest.mark.parametrize('mismatch', MISMATCHES)
def test_a_mismatch_of_five_times_the_noise_is_reported_within_two_seconds(mismatch: str) -> None:
    disturb, word = MISMATCHES[mismatch]
    wall = DisturbedWall(disturb, 5.0)
    scenario = replace(SCENARIOS['excited'], contacts=1, pressing=wall)
    delay, text = first_report(make_world(scenario, 6, 12, seed=1), 'indirect_adaptive')
    assert wall.level == pytest.approx(5.0)
    assert delay < 2.0
    assert word in text


@pytest.mark.slow
def test_the_study_prints_both_figures(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(['--hours', '0.005', '--worlds', '1']) == 0
    printed = capsys.readouterr().out
    assert 'within 2 s' in printed and 'false alarms' in printed


@pytest.mark.parametrize(('arguments', 'message'), [
    (['--worlds', '0'], '--worlds must be >= 1, got 0'),
    (['--estimator', 'rsl'], "'rsl'"),
])
def test_a_wrong_option_is_refused(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 1
    assert message in capsys.readouterr().err
