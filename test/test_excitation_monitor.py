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

"""The excitation monitor against the Cramer-Rao bound in matrices."""

from __future__ import annotations

from typing import Iterable

from contact_estimation.estimators.estimate import Frozen
from contact_estimation.estimators.excitation_monitor import (
    ExcitationMonitor,
    ExcitationParameters,
)
from core_steps import judged
import numpy as np
from numpy.typing import NDArray
import pytest

K, B, T, VARIANCE = 4800.0, 200.0, 0.002, 0.33


def sine_rows(count: int, amplitude: float = 0.002) -> NDArray[np.float64]:
    """Rows (y, delta, v, 1) of a sine contact."""
    t = T * np.arange(count)
    d, v = 0.01 + amplitude * np.sin(20.0 * t), 20.0 * amplitude * np.cos(20.0 * t)
    return np.column_stack([K * d + B * v, d, v, np.ones(count)])


def feed(
    monitor: ExcitationMonitor, rows: Iterable[list[float]], location_std: float | None = None
) -> Frozen:
    """Pass rows and give the last judgement."""
    frozen = Frozen(True, True)
    for row in rows:
        frozen = judged(monitor, row, VARIANCE, K, B, location_std)
    return frozen


def monitor_of(window_s: float = 1.0, limit: float = 0.2) -> ExcitationMonitor:
    """Make a monitor."""
    return ExcitationMonitor(ExcitationParameters(window_s, limit), T)


@pytest.mark.parametrize('fed', [500, 1500])
def test_predicted_std_is_the_bound_over_the_window(fed: int) -> None:
    rows, monitor = sine_rows(fed), monitor_of()
    rows[:, 2] *= np.linspace(0.5, 1.5, fed)  # so that the window matters
    feed(monitor, rows.tolist())
    phi = rows[-500:, 1:3]
    expected = np.sqrt(np.diag(VARIANCE * np.linalg.inv(phi.T @ phi)))
    np.testing.assert_allclose([monitor.stiffness_std, monitor.damping_std], expected, rtol=1e-9)


@pytest.mark.parametrize('location_std', [1e-5, 1e-4, 1e-2])
def test_location_enters_with_its_prior_as_information(location_std: float) -> None:
    rows, monitor = sine_rows(500), monitor_of(limit=1e6)
    feed(monitor, rows.tolist(), location_std)
    phi = rows[:, 1:] * [1.0, 1.0, -1.0]
    information = phi.T @ phi / VARIANCE + np.diag([0.0, 0.0, (K * location_std) ** -2])
    expected = np.sqrt(np.diag(np.linalg.inv(information)))[:2]
    np.testing.assert_allclose([monitor.stiffness_std, monitor.damping_std], expected, rtol=1e-6)


def test_nothing_is_held_with_the_sine() -> None:
    assert feed(monitor_of(), sine_rows(500).tolist()) == Frozen(False, False)


def test_damping_is_held_in_static_contact() -> None:
    assert feed(monitor_of(), [[48.0, 0.01, 0.0, 1.0]] * 500) == Frozen(False, True)


def test_everything_is_held_where_the_deflection_is_below_the_noise() -> None:
    assert feed(monitor_of(), [[4.8e-3, 1e-6, 0.0, 1.0]] * 500) == Frozen(True, True)


def test_everything_is_held_before_any_judgement() -> None:
    assert feed(monitor_of(), sine_rows(3).tolist()) == Frozen(True, True)


def test_unknown_location_hides_stiffness_in_static_contact() -> None:
    assert feed(monitor_of(), [[48.0, 0.01, 0.0, 1.0]] * 500, 1.0).stiffness


def test_a_large_limit_holds_nothing_that_can_be_told_at_all() -> None:
    monitor = monitor_of(limit=1e6)
    assert feed(monitor, sine_rows(100, 1e-6).tolist()) == Frozen(False, False)


def test_excitation_is_forgotten_after_the_window() -> None:
    monitor = monitor_of()
    feed(monitor, sine_rows(500).tolist())
    assert feed(monitor, [[48.0, 0.01, 0.0, 1.0]] * 500) == Frozen(False, True)


def test_reset_holds_everything_again() -> None:
    monitor = monitor_of()
    feed(monitor, sine_rows(500).tolist())
    monitor.reset()
    assert monitor.frozen == Frozen(True, True)


def test_another_limit_keeps_what_was_gathered() -> None:
    monitor = monitor_of()
    feed(monitor, sine_rows(495).tolist())
    monitor.configure(ExcitationParameters(1.0, 0.1))
    rows = sine_rows(500)
    feed(monitor, rows[495:].tolist())
    phi = rows[:, 1:3]
    expected = np.sqrt(np.diag(VARIANCE * np.linalg.inv(phi.T @ phi)))
    np.testing.assert_allclose([monitor.stiffness_std, monitor.damping_std], expected, rtol=1e-9)


def test_far_too_soft_a_guess_does_not_call_a_stiff_wall_unexcited() -> None:
    monitor, stiff = monitor_of(), 1e6
    for d in np.linspace(4.9e-5, 5.1e-5, 500).tolist():
        frozen = judged(monitor, (stiff * d, d, 0.0, 1.0), VARIANCE, 3000.0, 50.0, None)
    assert not frozen.stiffness
